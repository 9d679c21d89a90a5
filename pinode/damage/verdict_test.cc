#include "pinode/damage/verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
const std::vector<ChangeSubject> kSubjects = {
    {"k1", ChangeKind::kStiffness, "", "", 0.0},
    {"k2", ChangeKind::kStiffness, "", "", 0.0},
    {"c", ChangeKind::kDamping, "", "", 0.0}};

GroupChange Change(double change, double sigma, bool changed) {
  GroupChange group;
  group.change = change;
  group.sigma = sigma;
  group.lower95 = change - 1.959964 * sigma;
  group.upper95 = change + 1.959964 * sigma;
  group.probability = 0.5 * std::erfc((0.05 + change) / sigma / std::sqrt(2.0));
  group.changed = changed;
  return group;
}

Judgement Judge(const std::vector<GroupChange>& groups, bool between) {
  ChangeEstimate estimate;
  estimate.groups = groups;
  estimate.has_between_records = between;
  return JudgeChange(kSubjects, estimate, ChangeOptions());
}

TEST(JudgeChange, LossBeyondTheThresholdIsDamage) {
  const Judgement judgement =
      Judge({Change(-0.1, 0.01, true), Change(0.001, 0.01, false),
             Change(0.3, 0.05, true)},
            false);
  EXPECT_EQ(judgement.verdict, DamageVerdict::kDamage);
  EXPECT_THAT(judgement.reasons,
              ElementsAre(Reason::kBeyondThreshold, Reason::kNone,
                          Reason::kBeyondThreshold));
  EXPECT_THAT(judgement.sentence, HasSubstr("Damage: k1 (-10 %)"));
  EXPECT_THAT(judgement.sentence,
              HasSubstr("another change was found: c (+30 %)"));
}

// As between the two halves of one test on a real structure.
TEST(JudgeChange, ASmallSignificantChangeNeedsSeveralHealthyRecords) {
  const std::vector<GroupChange> groups = {Change(-0.03, 0.005, true),
                                           Change(0.0, 0.005, false),
                                           Change(0.0, 0.05, false)};
  const Judgement one = Judge(groups, false);
  EXPECT_EQ(one.verdict, DamageVerdict::kNoDamage);
  EXPECT_EQ(one.reasons[0], Reason::kFormal);
  EXPECT_THAT(one.sentence,
              HasSubstr("Detectable, but not beyond the threshold"));
  const Judgement several = Judge(groups, true);
  EXPECT_EQ(several.verdict, DamageVerdict::kDamage);
  EXPECT_EQ(several.reasons[0], Reason::kBetweenRecords);
  EXPECT_EQ(several.sentence,
            "Damage: k1 (-3 %) lost stiffness. This is below the threshold of "
            "5 %, but more than the baselines differ from each other.");
  // Springs that are in no group are not compared between healthy records.
  std::vector<ChangeSubject> subjects = kSubjects;
  subjects[0].place = "u1-u2";
  ChangeEstimate estimate;
  estimate.groups = groups;
  estimate.has_between_records = true;
  const Judgement spring =
      JudgeChange(subjects, estimate, ChangeOptions(), MissedMotion());
  EXPECT_EQ(spring.verdict, DamageVerdict::kNoDamage);
  EXPECT_EQ(spring.reasons[0], Reason::kFormal);
  EXPECT_THAT(spring.sentence, HasSubstr("fits of the baselines hold"));
}

TEST(JudgeChange, WhatCannotBeRuledOutIsSaid) {
  const Judgement judgement =
      Judge({Change(0.0, 0.01, false), Change(-0.01, 0.2, false),
             Change(0.0, 0.5, false)},
            false);
  EXPECT_EQ(judgement.verdict, DamageVerdict::kCannotTell);
  EXPECT_EQ(judgement.reasons[1], Reason::kUndetermined);
  EXPECT_THAT(judgement.sentence, HasSubstr("not ruled out in k2."));
}

TEST(JudgeChange, GainsAndDampingAreOtherChanges) {
  const Judgement judgement =
      Judge({Change(0.2, 0.01, true), Change(0.0, 0.01, false),
             Change(0.0, 0.5, false)},
            false);
  EXPECT_EQ(judgement.verdict, DamageVerdict::kOtherChange);
  EXPECT_STREQ(DamageVerdictName(judgement.verdict), "other_change");
  EXPECT_THAT(judgement.sentence,
              HasSubstr("another change was found: k1 (+20 %)."));
  EXPECT_EQ(Judge({Change(0.0, 0.01, false), Change(0.0, 0.01, false),
                   Change(0.0, 0.5, false)},
                  false)
                .verdict,
            DamageVerdict::kNoDamage);
}

// Stiffness, a mass and two nonlinear forces, one of them a small one.
class JudgeKinds : public ::testing::Test {
 protected:
  JudgeKinds()
      : subjects_({{"k1", ChangeKind::kStiffness, "", "", 0.0},
                   {"mass.u1", ChangeKind::kMass, "u1", "", 0.0},
                   {"nonlinear.k1", ChangeKind::kNonlinear, "k1", "", 0.2},
                   {"nonlinear.k2", ChangeKind::kNonlinear, "k2", "", 0.01}}) {
    estimate_.groups = {Change(0.0, 0.005, false), Change(0.0, 0.005, false),
                        Change(0.0, 0.005, false), Change(0.0, 0.005, false)};
  }
  Judgement Judge() {
    return JudgeChange(subjects_, estimate_, ChangeOptions());
  }

  std::vector<ChangeSubject> subjects_;
  ChangeEstimate estimate_;
};

TEST_F(JudgeKinds, ANonlinearForceCountsByItsShare) {
  estimate_.groups[0] = Change(-0.1, 0.005, true);
  estimate_.groups[2] = Change(0.5, 0.02, true);
  const Judgement large = Judge();
  EXPECT_EQ(large.verdict, DamageVerdict::kNonlinear);
  EXPECT_STREQ(DamageVerdictName(large.verdict), "nonlinear");
  EXPECT_THAT(large.sentence,
              HasSubstr("a nonlinear force at k1 (20 % of the restoring"));
  EXPECT_THAT(large.sentence, HasSubstr("Also, k1 (-10 %) lost stiffness"));
  // As sure to be there, but a hundredth of the force.
  estimate_.groups[0] = Change(0.0, 0.005, false);
  estimate_.groups[2] = Change(0.0, 0.02, false);
  estimate_.groups[3] = Change(0.5, 0.02, true);
  const Judgement small = Judge();
  EXPECT_EQ(small.verdict, DamageVerdict::kNoDamage);
  EXPECT_EQ(small.reasons[3], Reason::kFormal);
}

TEST_F(JudgeKinds, APlaceIsNamedOnce) {
  subjects_[3] = {"nonlinear.k1.b", ChangeKind::kNonlinear, "k1", "", 0.2};
  estimate_.groups[2] = Change(0.5, 0.02, true);
  estimate_.groups[3] = Change(-0.3, 0.02, true);
  EXPECT_EQ(Judge().sentence,
            "The structure has become nonlinear: a nonlinear force at k1 "
            "(20 % of the restoring force).");
}

TEST_F(JudgeKinds, TheLargestForceIsNamedFirstAndSmallOnesApart) {
  subjects_[3].force_share = 0.3;
  subjects_[2].force_share = 0.06;
  estimate_.groups[2] = Change(0.5, 0.005, true);
  estimate_.groups[3] = Change(0.5, 0.005, true);
  EXPECT_EQ(Judge().sentence,
            "The structure has become nonlinear: a nonlinear force at k2 "
            "(30 % of the restoring force). Smaller, and perhaps a side effect "
            "of the form assumed for the largest force: a nonlinear force at "
            "k1 (6 % of the restoring force).");
}

TEST_F(JudgeKinds, BesideANonlinearForceRivalsAreNotListed) {
  estimate_.groups[0] = Change(0.0, 0.005, false);
  estimate_.groups[2] = Change(0.5, 0.02, true);
  estimate_.rivals = {{2, 3, 1.0}, {2, 1, 2.0}};
  subjects_[1].kind = ChangeKind::kNonlinear;
  const Judgement judgement = Judge();
  EXPECT_EQ(judgement.verdict, DamageVerdict::kNonlinear);
  EXPECT_THAT(judgement.sentence, Not(HasSubstr("tell apart")));
  EXPECT_THAT(judgement.sentence, Not(HasSubstr("as likely")));
  EXPECT_THAT(judgement.sentence, Not(HasSubstr("explanation")));
}

TEST_F(JudgeKinds, NamesAFewOfMany) {
  subjects_.clear();
  estimate_.groups.clear();
  for (int j = 0; j < 7; ++j) {
    subjects_.push_back(
        {"k" + std::to_string(j), ChangeKind::kStiffness, "", "", 0.0});
    estimate_.groups.push_back(Change(-0.1 - 0.01 * j, 0.005, true));
  }
  EXPECT_EQ(Judge().sentence,
            "Damage: k6 (-16 %), k5 (-15 %), k4 (-14 %), k3 (-13 %) and 3 more "
            "lost stiffness.");
}

TEST_F(JudgeKinds, AddedMassIsNoDamage) {
  estimate_.groups[1] = Change(0.2, 0.01, true);
  const Judgement judgement = Judge();
  EXPECT_EQ(judgement.verdict, DamageVerdict::kOtherChange);
  EXPECT_THAT(judgement.sentence,
              HasSubstr("change was found: the mass at u1 (+20 %)."));
}

TEST_F(JudgeKinds, ARivalOfAnotherKindLeavesTheVerdictOpen) {
  estimate_.groups[0] = Change(-0.1, 0.005, true);
  estimate_.rivals = {{0, 1, 3.0}};
  const Judgement judgement = Judge();
  EXPECT_EQ(judgement.verdict, DamageVerdict::kCannotTell);
  EXPECT_EQ(judgement.reasons[0], Reason::kAmbiguous);
  EXPECT_THAT(judgement.sentence, HasSubstr("allow another cause: k1 (-10 %)"));
  EXPECT_THAT(judgement.sentence,
              HasSubstr("as likely: the mass at u1 instead of k1."));
  // With a rival of the same kind it is damage as well.
  subjects_[1] = {"k2", ChangeKind::kStiffness, "", "", 0.0};
  EXPECT_EQ(Judge().verdict, DamageVerdict::kDamage);
  EXPECT_THAT(Judge().sentence,
              HasSubstr("apart with these data: k2 instead of k1"));
}

TEST_F(JudgeKinds, ExplanationsThatWereFittedStandBesideEachOther) {
  subjects_[1] = {"k2", ChangeKind::kStiffness, "", "", 0.0};
  estimate_.groups[0] = Change(-0.3, 0.01, true);
  estimate_.groups[1] = Change(-0.1, 0.1, false);
  const auto explanation = [](int subject, double change, double probability) {
    ChangeExplanation result;
    result.changed = {subject};
    result.changes = {Change(change, 0.01, true)};
    result.probability = probability;
    return result;
  };
  estimate_.explanations = {explanation(0, -0.3, 0.6),
                            explanation(1, -0.25, 0.4)};
  estimate_.rivals = {{0, 1, 0.8}};
  const Judgement judgement = Judge();
  EXPECT_EQ(judgement.verdict, DamageVerdict::kDamage);
  EXPECT_EQ(judgement.sentence,
            "Damage: k1 (-30 %) or k2 (-25 %) lost stiffness. These records do "
            "not determine which. The probabilities are 60 % and 40 %.");
  // A gain of stiffness is no loss.
  estimate_.explanations[1].changes[0].change = 0.25;
  EXPECT_EQ(Judge().sentence,
            "Damage: k1 (-30 %) lost stiffness. Another explanation: k2 "
            "(+25 %) with a probability of 40 %.");
}

TEST_F(JudgeKinds, ASmallNonlinearForceMakesNoStructureNonlinear) {
  estimate_.has_between_records = true;
  subjects_.push_back(
      {"k3.friction", ChangeKind::kNonlinear, "k3", "u2-u3", 0.004});
  estimate_.groups.push_back(Change(0.3, 0.01, true));
  const Judgement judgement = Judge();
  EXPECT_EQ(judgement.verdict, DamageVerdict::kOtherChange);
  EXPECT_THAT(judgement.sentence,
              HasSubstr("another change was found: a nonlinear force at k3 "
                        "(0.4 % of the restoring force)."));
}

// Unexplained motion of the new records of 7 %, instead of 1 %.
TEST(JudgeMissed, WhatStandsInForSomethingElseIsNoDamage) {
  ChangeEstimate estimate;
  estimate.groups = {Change(-0.1, 0.01, true), Change(0.0, 0.01, false),
                     Change(0.0, 0.05, false)};
  const MissedMotion missed = {0.01, 0.08, 0.07};
  Judgement judgement =
      JudgeChange(kSubjects, estimate, ChangeOptions(), missed);
  EXPECT_EQ(judgement.verdict, DamageVerdict::kCannotTell);
  EXPECT_EQ(judgement.reasons[0], Reason::kUnexplained);
  EXPECT_THAT(
      judgement.sentence,
      HasSubstr("Of the motion of the new records 7 % is unexplained and too "
                "large to be noise; of the baselines' 1 %."));
  EXPECT_THAT(judgement.sentence,
              HasSubstr("A side effect, perhaps: k1 (-10 %)."));
  // Rivals of a side effect are not reported.
  estimate.rivals = {{0, 1, 3.0}};
  EXPECT_EQ(JudgeChange(kSubjects, estimate, ChangeOptions(), missed).sentence,
            judgement.sentence);
  estimate.rivals.clear();
  // Nor is all well where nothing was found.
  estimate.groups[0] = Change(0.0, 0.01, false);
  judgement = JudgeChange(kSubjects, estimate, ChangeOptions(), missed);
  EXPECT_EQ(judgement.verdict, DamageVerdict::kCannotTell);
  // Healthy records are as bad, or it is too little to matter.
  for (const MissedMotion& less :
       {MissedMotion{0.03, 0.08, 0.07}, MissedMotion{0.001, 0.02, 0.018}}) {
    EXPECT_EQ(JudgeChange(kSubjects, estimate, ChangeOptions(), less).verdict,
              DamageVerdict::kNoDamage);
  }
}

TEST(JudgeMissed, ANonlinearForceLeavesWhatItsFormDoes) {
  const std::vector<ChangeSubject> subjects = {
      {"k1", ChangeKind::kStiffness, "", "", 0.0},
      {"k1.opening", ChangeKind::kNonlinear, "k1", "u1", 0.05}};
  ChangeEstimate estimate;
  estimate.groups = {Change(-0.1, 0.01, true), Change(0.6, 0.01, true)};
  estimate.has_between_records = true;
  const auto verdict = [&](double groups, double last) {
    return JudgeChange(subjects, estimate, ChangeOptions(),
                       {0.002, groups, last})
        .verdict;
  };
  EXPECT_EQ(verdict(0.17, 0.08), DamageVerdict::kNonlinear);
  EXPECT_EQ(verdict(0.1, 0.08), DamageVerdict::kCannotTell)
      << "it explains little";
  EXPECT_EQ(verdict(0.4, 0.15), DamageVerdict::kCannotTell)
      << "it is small beside what is left";
}

TEST(JudgeChange, CannotTellWhatAnotherExplanationReaches) {
  ChangeEstimate estimate;
  estimate.groups = {Change(-0.24, 0.01, true), Change(0.0, 0.01, false),
                     Change(0.0, 0.01, false)};
  MissedMotion missed;
  missed.within_doubt = {true, false, false};
  const Judgement judgement =
      JudgeChange(kSubjects, estimate, ChangeOptions(), missed);
  EXPECT_EQ(judgement.verdict, DamageVerdict::kCannotTell);
  EXPECT_EQ(judgement.reasons[0], Reason::kOtherExplanation);
  EXPECT_THAT(judgement.sentence, HasSubstr(kSubjects[0].name + " (-24 %)"));

  // Beside a loss that is open, a gain is no all-clear.
  estimate.groups[1] = Change(1.4, 0.01, true);
  const Judgement beside =
      JudgeChange(kSubjects, estimate, ChangeOptions(), missed);
  EXPECT_EQ(beside.verdict, DamageVerdict::kCannotTell);
  EXPECT_THAT(beside.sentence, HasSubstr("Besides, another change was found: " +
                                         kSubjects[1].name));
  estimate.groups[1] = Change(0.0, 0.01, false);

  missed.within_doubt = {false, true, true};
  EXPECT_EQ(JudgeChange(kSubjects, estimate, ChangeOptions(), missed).verdict,
            DamageVerdict::kDamage);
  // Several baselines show themselves how much records differ.
  missed.within_doubt = {true, false, false};
  estimate.has_between_records = true;
  EXPECT_EQ(JudgeChange(kSubjects, estimate, ChangeOptions(), missed).verdict,
            DamageVerdict::kDamage);
  // They do not decide between mirrored solutions.
  missed.other_solution = true;
  EXPECT_EQ(JudgeChange(kSubjects, estimate, ChangeOptions(), missed).verdict,
            DamageVerdict::kCannotTell);
  missed.other_solution = false;
  // They do not show that a mass was added.
  missed.mass_instead = {true, false, false};
  EXPECT_EQ(JudgeChange(kSubjects, estimate, ChangeOptions(), missed).verdict,
            DamageVerdict::kCannotTell);
}

// A shear model of a measured frame had other stiffnesses at each level of
// motion, whatever the number of baselines at one level.
TEST(JudgeChange, CannotTellBetweenLevelsOfMotion) {
  ChangeEstimate estimate;
  estimate.groups = {Change(-0.24, 0.01, true), Change(0.1, 0.01, true),
                     Change(0.0, 0.01, false)};
  estimate.has_between_records = true;
  MissedMotion missed;
  EXPECT_EQ(JudgeChange(kSubjects, estimate, ChangeOptions(), missed).verdict,
            DamageVerdict::kDamage);
  missed.other_level = true;
  const Judgement judgement =
      JudgeChange(kSubjects, estimate, ChangeOptions(), missed);
  EXPECT_EQ(judgement.verdict, DamageVerdict::kCannotTell);
  EXPECT_EQ(judgement.reasons[0], Reason::kOtherLevel);
  EXPECT_EQ(judgement.reasons[1], Reason::kOtherLevel);
  EXPECT_EQ(judgement.reasons[2], Reason::kNone);
  EXPECT_THAT(judgement.sentence,
              HasSubstr("Add a baseline at the level of the new records"));
}

TEST(JudgeChange, TheLevelOfMotionMayHideALoss) {
  ChangeEstimate estimate;
  estimate.groups = {Change(0.0, 0.01, false), Change(0.0, 0.01, false),
                     Change(0.0, 0.01, false)};
  MissedMotion other, unknown, hidden;
  other.other_level = true;
  unknown.unknown_level = true;
  hidden.level_hides_loss = true;
  const auto judge = [&](const MissedMotion& missed) {
    return JudgeChange(kSubjects, estimate, ChangeOptions(), missed);
  };
  EXPECT_EQ(judge({}).verdict, DamageVerdict::kNoDamage);
  for (const MissedMotion& missed : {other, hidden}) {
    EXPECT_EQ(judge(missed).verdict, DamageVerdict::kCannotTell);
    EXPECT_EQ(judge(missed).sentence,
              "These data cannot tell whether any group lost stiffness. The "
              "new records are at another level of motion, which may hide a "
              "loss. Add a baseline at the level of the new records.");
  }
  EXPECT_EQ(judge(unknown).sentence,
            "These data cannot tell whether any group lost stiffness. The "
            "model leaves motion unexplained, and the levels of motion cannot "
            "be compared: no sensor is common. The level may hide a loss. Add "
            "a baseline with a sensor of the new records.");
  // A gain that stands does not close the question.
  estimate.groups[1] = Change(0.2, 0.01, true);
  EXPECT_EQ(judge({}).verdict, DamageVerdict::kOtherChange);
  EXPECT_EQ(judge(hidden).verdict, DamageVerdict::kCannotTell);
  EXPECT_THAT(judge(unknown).sentence,
              HasSubstr("This may be all that changed: k2 (+20 %)."));
  // A loss that stands is one.
  estimate.groups[0] = Change(-0.2, 0.01, true);
  EXPECT_EQ(judge(hidden).verdict, DamageVerdict::kDamage);
  EXPECT_EQ(judge(unknown).verdict, DamageVerdict::kCannotTell);
}

TEST(JudgeChange, CannotTellWhatIsSmallerThanWhatTheModelMisses) {
  ChangeEstimate estimate;
  estimate.groups = {Change(-0.24, 0.01, true), Change(0.0, 0.01, false),
                     Change(0.0, 0.01, false)};
  MissedMotion missed;
  missed.healthy = 0.3;
  missed.last = 0.35;
  Judgement judgement =
      JudgeChange(kSubjects, estimate, ChangeOptions(), missed);
  EXPECT_EQ(judgement.verdict, DamageVerdict::kCannotTell);
  EXPECT_EQ(judgement.reasons[0], Reason::kModelError);
  EXPECT_THAT(judgement.sentence,
              HasSubstr("Add a baseline at the level of the new record"));

  // Several baselines show how much that moves; a larger change is none of it.
  estimate.has_between_records = true;
  EXPECT_EQ(JudgeChange(kSubjects, estimate, ChangeOptions(), missed).verdict,
            DamageVerdict::kDamage);
  estimate.has_between_records = false;
  estimate.groups[0] = Change(-0.5, 0.01, true);
  EXPECT_EQ(JudgeChange(kSubjects, estimate, ChangeOptions(), missed).verdict,
            DamageVerdict::kDamage);
  // A model that misses next to nothing shows small changes.
  missed.healthy = missed.last = 0.05;
  estimate.groups[0] = Change(-0.12, 0.01, true);
  EXPECT_EQ(JudgeChange(kSubjects, estimate, ChangeOptions(), missed).verdict,
            DamageVerdict::kDamage);
}

// A mass that was found may stand for a loss. A damper beside it does not close
// the question.
TEST(JudgeChange, CannotTellALossWhereAMassAndADamperWereFound) {
  const std::vector<ChangeSubject> subjects = {
      {"k", ChangeKind::kStiffness, "", "", 0.0},
      {"c", ChangeKind::kDamping, "", "", 0.0},
      {"w", ChangeKind::kMass, "", "", 0.0}};
  ChangeEstimate estimate;
  estimate.groups = {Change(-0.17, 0.01, false), Change(-0.25, 0.01, true),
                     Change(0.2, 0.01, true)};
  estimate.rivals = {{2, 0, 0.5}};
  MissedMotion missed;
  missed.loss_instead = {true, false, false};
  const Judgement judgement =
      JudgeChange(subjects, estimate, ChangeOptions(), missed);
  EXPECT_EQ(judgement.verdict, DamageVerdict::kCannotTell);
  EXPECT_THAT(judgement.sentence, HasSubstr("k (-17 %)"));
  EXPECT_THAT(judgement.sentence, HasSubstr("c (-25 %)"));
}

}  // namespace
}  // namespace pinode
