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
using Target = MatrixGroup::Target;

const std::vector<std::string> kNames = {"k1", "k2", "c"};
const std::vector<Target> kTargets = {Target::kStiffness, Target::kStiffness,
                                      Target::kDamping};

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
  return JudgeChange(kNames, kTargets, estimate, ChangeOptions());
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
  EXPECT_THAT(judgement.sentence, HasSubstr("Also changed: c (+30 %)"));
}

// As between the two halves of one test on a real structure.
TEST(JudgeChange, ASmallSignificantChangeNeedsSeveralHealthyRecords) {
  const std::vector<GroupChange> groups = {Change(-0.03, 0.005, true),
                                           Change(0.0, 0.005, false),
                                           Change(0.0, 0.05, false)};
  const Judgement one = Judge(groups, false);
  EXPECT_EQ(one.verdict, DamageVerdict::kNoDamage);
  EXPECT_EQ(one.reasons[0], Reason::kFormal);
  EXPECT_THAT(one.sentence, HasSubstr("Formally significant"));
  const Judgement several = Judge(groups, true);
  EXPECT_EQ(several.verdict, DamageVerdict::kDamage);
  EXPECT_EQ(several.reasons[0], Reason::kBetweenRecords);
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
  EXPECT_THAT(judgement.sentence, HasSubstr("k1 (+20 %) has changed"));
  EXPECT_EQ(Judge({Change(0.0, 0.01, false), Change(0.0, 0.01, false),
                   Change(0.0, 0.5, false)},
                  false)
                .verdict,
            DamageVerdict::kNoDamage);
}

}  // namespace
}  // namespace pinode
