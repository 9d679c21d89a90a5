#include "pinode/study/damage/change_candidates.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/structure/model/damping.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

// A fit of two storeys in which u1 swings as 0.01 sin and u2 as 0.03 sin.
class ChangeCandidates : public ::testing::Test {
 protected:
  void SetUp() override {
    Matrix stiffness(2, 2);
    stiffness << 300.0, -100.0, -100.0, 100.0;
    const Matrix mass = Vector{{2.0, 1.0}}.asDiagonal();
    auto dynamics = std::make_shared<StructuralDynamics>(
        MakeStructuralModel(mass, 0.01 * stiffness, stiffness),
        std::vector<InputSpec>{
            {InputSpec::Kind::kGroundAcceleration, 0, "ag"}});
    GroupTerm group;
    group.group.name = "k1";
    group.group.matrix = 200.0 * SpringMatrix(2, Feature::kGround, 0);
    std::string error;
    ASSERT_TRUE(dynamics->AddGroup(group, &error)) << error;
    IdentificationRecord record =
        testing::MakeExcitedRecord(*dynamics, 200, 0.01);
    record.channels = {
        testing::MakeChannel("a1", Quantity::kAbsoluteAcceleration, 2, 0),
        testing::MakeChannel("d2", Quantity::kDisplacement, 2, 1)};
    for (MeasuredChannel& channel : record.channels) {
      channel.values = Vector::Zero(200);
    }
    problem_.dynamics = dynamics;
    problem_.records = {record};
    ChooseStepsOrFail(&problem_);
    search_ = LookEverywhere(problem_);
    EXPECT_TRUE(search_.damping);
    search_.damping = false;
    EXPECT_TRUE(search_.stiffness);
    search_.stiffness = false;
    search_.springs = {{"gap", 0, 1}};
    constexpr int kSamples = 2000;
    constexpr double kFrequency = 5.0;
    RecordScore score;
    score.finite = true;
    score.states.resize(4, kSamples);
    for (int i = 0; i < kSamples; ++i) {
      // Whole periods.
      const double phase = 2.0 * kPi * 10.0 * i / kSamples;
      score.states.col(i) << 0.01 * std::sin(phase), 0.03 * std::sin(phase),
          0.01 * kFrequency * std::cos(phase),
          0.03 * kFrequency * std::cos(phase);
    }
    summary_.records = {score};
    model_.parameters = ParameterLayout(problem_).InitialValues();
    model_.sigmas = {Vector::Constant(2, 0.1)};
    model_.starts = {Vector::Zero(4)};
  }

  IdentificationProblem problem_;
  DamageSearch search_;
  IdentificationSummary summary_;
  IdentifiedModel model_;
};

TEST_F(ChangeCandidates, AreMeasuredByWhatIsThere) {
  const std::vector<ChangeCandidate> candidates =
      MakeChangeCandidates(problem_, search_, summary_, model_);
  ASSERT_EQ(candidates.size(), 2u + 4u);
  EXPECT_EQ(candidates[0].subject.name, "mass.u1");
  EXPECT_EQ(candidates[0].subject.kind, ChangeKind::kMass);
  EXPECT_DOUBLE_EQ(candidates[0].masses[0], 2.0);
  EXPECT_DOUBLE_EQ(candidates[0].masses[1], 0.0);
  EXPECT_DOUBLE_EQ(candidates[1].masses[1], 1.0);

  // d = 0.02 sin, w = 0.1 cos; the spring between the two is 100.
  const double force = 100.0 * 0.02 / std::sqrt(2.0);
  EXPECT_EQ(candidates[2].basis, "abs(d[u1,u2])");
  EXPECT_EQ(candidates[2].subject.dof, "u2-u1");
  EXPECT_NEAR(candidates[2].unit, 100.0, 1e-9);
  // mean sin^6 = 5/16
  EXPECT_EQ(candidates[3].basis, "d[u1,u2]^3");
  EXPECT_NEAR(candidates[3].unit,
              force / (std::pow(0.02, 3) * std::sqrt(5.0 / 16.0)), 1e-6);
  // mean cos^4 = 3/8
  EXPECT_EQ(candidates[5].basis, "abs(w[u1,u2])*w[u1,u2]");
  EXPECT_NEAR(candidates[5].unit,
              force / (std::pow(0.1, 2) * std::sqrt(3.0 / 8.0)), 1e-8);
}

TEST_F(ChangeCandidates, ChangeTheDampingAsAWholeAndByModes) {
  search_ = DamageSearch();
  search_.damping = true;
  const std::vector<ChangeCandidate> candidates =
      MakeChangeCandidates(problem_, search_, summary_, model_);
  ASSERT_EQ(candidates.size(), 3u);
  const StructuralModel& model = problem_.dynamics->model();
  EXPECT_EQ(candidates[0].subject.name, "damping.all");
  EXPECT_EQ(candidates[0].matrix, model.damping);
  // Two modes with proportional damping have all of it.
  EXPECT_NEAR(
      (candidates[1].matrix + candidates[2].matrix - model.damping).norm(), 0.0,
      1e-9 * model.damping.norm());
  IdentificationProblem extended;
  std::string error;
  ASSERT_TRUE(AddCandidates(problem_, candidates, &extended, &error)) << error;
  EXPECT_EQ(extended.dynamics->groups()[1].group.target,
            MatrixGroup::Target::kDamping);
  // Damping that is free already shows its change itself.
  EXPECT_FALSE(HasFixedDamping(*extended.dynamics));
}

TEST_F(ChangeCandidates, ChangeTheStiffnessThatIsNoGroup) {
  search_ = DamageSearch();
  search_.stiffness = true;
  const std::vector<ChangeCandidate> candidates =
      MakeChangeCandidates(problem_, search_, summary_, model_);
  ASSERT_EQ(candidates.size(), 1u);
  const StructuralModel& model = problem_.dynamics->model();
  EXPECT_EQ(candidates[0].subject.kind, ChangeKind::kStiffness);
  EXPECT_EQ(candidates[0].subject.place,
            model.dof_names[0] + "-" + model.dof_names[1]);
  EXPECT_EQ(candidates[0].matrix, 100.0 * SpringMatrix(2, 0, 1));
  IdentificationProblem extended;
  std::string error;
  ASSERT_TRUE(AddCandidates(problem_, candidates, &extended, &error)) << error;
  EXPECT_EQ(extended.dynamics->groups()[1].group.target,
            MatrixGroup::Target::kStiffness);
  // With the spring as a group there is nothing left.
  problem_ = extended;
  model_.parameters = ParameterLayout(problem_).InitialValues();
  EXPECT_TRUE(
      MakeChangeCandidates(problem_, search_, summary_, model_).empty());
}

TEST_F(ChangeCandidates, BecomeUnknownsOfTheProblem) {
  std::vector<ChangeCandidate> candidates =
      MakeChangeCandidates(problem_, search_, summary_, model_);
  candidates.erase(candidates.begin() + 3, candidates.end());
  IdentificationProblem extended;
  std::string error;
  ASSERT_TRUE(AddCandidates(problem_, candidates, &extended, &error)) << error;
  const ParameterLayout layout(extended);
  EXPECT_EQ(layout.num_free(), 1 + 3);
  for (const ChangeCandidate& candidate : candidates) {
    int count = 0;
    for (const int index : layout.free()) {
      if (layout.parameter(index).name != candidate.subject.name) continue;
      ++count;
      EXPECT_EQ(layout.parameter(index).value, 0.0);
      EXPECT_DOUBLE_EQ(layout.parameter(index).prior_sigma, candidate.unit);
    }
    EXPECT_EQ(count, 1) << candidate.subject.name;
  }
  // Without them it is the case that it was.
  IdentificationProblem same;
  ASSERT_TRUE(AddCandidates(problem_, {}, &same, &error)) << error;
  EXPECT_EQ(ParameterLayout(same).num_free(), 1);
}

TEST_F(ChangeCandidates, RefuseWhatIsNotThere) {
  std::vector<ChangeCandidate> candidates =
      MakeChangeCandidates(problem_, search_, summary_, model_);
  IdentificationProblem extended;
  std::string error;
  EXPECT_FALSE(AddCandidates(problem_, {candidates[0], candidates[0]},
                             &extended, &error));
  EXPECT_THAT(error, ::testing::HasSubstr("'mass.u1'"));
  candidates[0].masses = Vector::Ones(3);
  EXPECT_FALSE(AddCandidates(problem_, {candidates[0]}, &extended, &error));
  candidates[2].to = 7;
  EXPECT_FALSE(AddCandidates(problem_, {candidates[2]}, &extended, &error));
  candidates[3].basis = "d[u1,u3]^3";
  EXPECT_FALSE(AddCandidates(problem_, {candidates[3]}, &extended, &error));
  candidates[4].subject.dof = "u9";
  EXPECT_FALSE(AddCandidates(problem_, {candidates[4]}, &extended, &error));
  EXPECT_THAT(error, ::testing::HasSubstr("'u9'"));
}

// Explanations with log odds, what they leave, kinds and places.
Explanation MakeExplanation(double log_odds, double leaves,
                            const std::string& kind, const std::string& place) {
  Explanation explanation;
  explanation.log_odds = log_odds;
  explanation.leaves = leaves;
  explanation.kind = kind;
  explanation.place = place;
  return explanation;
}

TEST_F(ChangeCandidates, FollowExplanationsOfTheNewRecords) {
  search_.damping = true;
  const std::vector<ChangeCandidate> candidates =
      MakeChangeCandidates(problem_, search_, summary_, model_);
  const auto names = [&](const std::vector<Explanation>& explanations) {
    std::vector<std::string> found;
    for (const ChangeCandidate& candidate :
         ExplainedCandidates(explanations, candidates)) {
      found.push_back(candidate.subject.name);
    }
    return found;
  };
  using ::testing::ElementsAre;
  using ::testing::IsEmpty;
  EXPECT_THAT(names({MakeExplanation(90.0, 0.001, "mass", "u2")}),
              ElementsAre("mass.u2"));
  EXPECT_THAT(names({MakeExplanation(90.0, 0.001, "mass+damping", "u1+")}),
              ElementsAre("mass.u1", "damping.all"));
  // All masses by one factor are no candidate; with all stiffness free, damping
  // of another size is the same.
  EXPECT_THAT(names({MakeExplanation(90.0, 0.001, "mass", ""),
                     MakeExplanation(89.0, 0.001, "damping", "")}),
              ElementsAre("damping.all"));
  EXPECT_THAT(names({MakeExplanation(90.0, 0.001, "sensor_gain", "a1"),
                     MakeExplanation(80.0, 0.001, "damping", "")}),
              IsEmpty());
  // A sensor is likelier than what stands behind it.
  EXPECT_THAT(names({MakeExplanation(90.0, 0.001, "sensor_gain", "a1"),
                     MakeExplanation(89.0, 0.001, "mass", "u1")}),
              IsEmpty());
  EXPECT_THAT(
      names({MakeExplanation(90.0, 0.001, "sensor_gain+mass", "a1+u1")}),
      IsEmpty());
  EXPECT_THAT(names({MakeExplanation(90.0, 0.1, "mass", "u1")}), IsEmpty());
  EXPECT_THAT(names({MakeExplanation(2.0, 0.001, "mass", "u1")}), IsEmpty());
  EXPECT_THAT(names({MakeExplanation(90.0, 0.001, "mass", "u7")}), IsEmpty());
  EXPECT_THAT(names({}), IsEmpty());
}

TEST_F(ChangeCandidates, ShareTheRestoringForce) {
  std::vector<ChangeCandidate> candidates =
      MakeChangeCandidates(problem_, search_, summary_, model_);
  candidates = {candidates[2]};
  IdentificationProblem extended;
  std::string error;
  ASSERT_TRUE(AddCandidates(problem_, candidates, &extended, &error)) << error;
  const ParameterLayout layout(extended);
  IdentifiedModel model = model_;
  model.parameters = layout.InitialValues();
  for (const int index : layout.free()) {
    if (layout.parameter(index).name == candidates[0].subject.name) {
      model.parameters[index] = -50.0;
    }
  }
  SetForceShares(extended, summary_, model, &candidates);
  // 100 d - 50 |d|: half of the samples have 50 d, the others 150 d.
  EXPECT_NEAR(candidates[0].subject.force_share,
              50.0 / std::sqrt(0.5 * (50.0 * 50.0 + 150.0 * 150.0)), 1e-9);
}

}  // namespace
}  // namespace pinode
