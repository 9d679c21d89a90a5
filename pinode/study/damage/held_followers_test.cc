#include "pinode/study/damage/held_followers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/study/damage/damage_analysis.h"
#include "pinode/study/identify/identify.h"
#include "tests/support/ambient_covariate_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kSeconds = 300.0;

// The outcome of the main job on `problem`.
Identification IdentifyOrFail(IdentificationProblem problem) {
  IdentificationOptions options;
  options.num_threads = 2;
  Identification fit = Identify(std::move(problem), options);
  EXPECT_TRUE(fit.summary.usable()) << fit.summary.message;
  return fit;
}

FitOfRecords RecordsOf(const Identification& fit) {
  return {"new", fit.problem, fit.summary, fit.model};
}

Baseline BaselineOf(const std::string& name, const Identification& fit) {
  Baseline baseline;
  std::string error;
  EXPECT_TRUE(BaselineFrom(name, fit.problem, fit.summary, fit.model, &baseline,
                           &error))
      << error;
  return baseline;
}

void Hold(double slope, IdentificationProblem* problem) {
  problem->dynamics = std::make_shared<const StructuralDynamics>(
      problem->dynamics->WithGroupParameters([slope](Parameter* parameter) {
        if (parameter->name != "all") return;
        parameter->value = slope;
        parameter->free = false;
      }));
}

// A chain that lost a tenth of its first storey, seen at one temperature.
class HeldFollowersTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    baseline_ = new Baseline(BaselineOf(
        "healthy",
        IdentifyOrFail(ProblemOfRecords(
            0.05, {RecordAt(0.0, 1, kSeconds), RecordAt(10.0, 2, kSeconds),
                   RecordAt(20.0, 3, kSeconds)}))));
  }
  static void TearDownTestSuite() { delete baseline_; }

  static IdentificationProblem NewProblem(double temperature, unsigned seed,
                                          double loss) {
    return ProblemOfRecords(0.0, {RecordAt(temperature, seed, kSeconds, loss)});
  }

  static DamageResult Analyse(const Identification& fit) {
    DamageResult result;
    std::string error;
    EXPECT_TRUE(AnalyseDamage(fit.problem, fit.summary, fit.model, {*baseline_},
                              {}, &result, &error))
        << error;
    return result;
  }

  static Baseline* baseline_;
};

Baseline* HeldFollowersTest::baseline_ = nullptr;

TEST_F(HeldFollowersTest, AreWhatRecordsOfOneTemperatureCannotTell) {
  EXPECT_THAT(baseline_->followers, ElementsAre("all"));
  ASSERT_EQ(baseline_->with_followers.values.size(), 5);
  const double slope = baseline_->with_followers.values[4];
  EXPECT_NEAR(slope, kSlope, 5e-4);
  IdentificationProblem problem = NewProblem(5.0, 7, 0.0);
  const std::map<std::string, double> held =
      FollowersToHold({*baseline_}, problem);
  ASSERT_EQ(held.size(), 1u);
  EXPECT_EQ(held.at("all"), slope);
  // Two baselines with different values are weighted by their variances.
  Baseline vague = *baseline_;
  vague.with_followers.values[4] = slope + 5.0;
  vague.with_followers.covariance.row(4) *= 2.0;
  vague.with_followers.covariance.col(4) *= 2.0;
  EXPECT_NEAR(FollowersToHold({*baseline_, vague}, problem).at("all"),
              slope + 1.0, 1e-9);
  // Followers that a baseline does not determine are not held.
  Baseline other = *baseline_;
  other.followers.clear();
  EXPECT_THAT(FollowersToHold({*baseline_, other}, problem), IsEmpty());
  // Nor what the engineer has a prior for.
  problem.dynamics = std::make_shared<const StructuralDynamics>(
      problem.dynamics->WithGroupParameters([](Parameter* parameter) {
        if (parameter->name == "all") parameter->prior_sigma = 0.001;
      }));
  EXPECT_THAT(FollowersToHold({*baseline_}, problem), IsEmpty());
}

TEST_F(HeldFollowersTest, LossIsFoundAtAnotherTemperature) {
  IdentificationProblem problem = NewProblem(-10.0, 8, 0.1);
  Hold(baseline_->with_followers.values[4], &problem);
  const DamageResult result = Analyse(IdentifyOrFail(std::move(problem)));
  ASSERT_EQ(result.estimate.groups.size(), 4u);
  const GroupChange& lost = result.estimate.groups[0];
  EXPECT_TRUE(lost.changed);
  EXPECT_NEAR(lost.change, -0.1, 3.0 * lost.sigma);
  EXPECT_LT(lost.sigma, 0.015);
  EXPECT_FALSE(result.estimate.groups[1].changed);
}

using HeldFollowersFigures = HeldFollowersTest;

// Masses are looked for as well, and there are two baselines.
TEST_F(HeldFollowersFigures, BesideOtherKindsOfChange) {
  const double slope = baseline_->with_followers.values[4];
  IdentificationProblem problem = NewProblem(-10.0, 8, 0.1);
  Hold(slope, &problem);
  const Identification fit = IdentifyOrFail(std::move(problem));
  const Baseline other = BaselineOf(
      "other",
      IdentifyOrFail(ProblemOfRecords(
          0.0, {RecordAt(-5.0, 11, kSeconds), RecordAt(15.0, 12, kSeconds)})));
  DamageAnalysisOptions options;
  options.search.masses = {{"u1", {0}}, {"u2", {1}}};
  DamageResult result;
  std::string error;
  ASSERT_TRUE(AnalyseDamage(fit.problem, fit.summary, fit.model,
                            {*baseline_, other}, options, &result, &error))
      << error;
  EXPECT_TRUE(result.remarks.empty()) << result.remarks[0];
  EXPECT_FALSE(result.places.empty());
  EXPECT_TRUE(result.added.empty());
  EXPECT_TRUE(result.estimate.groups[0].changed);
  EXPECT_NEAR(result.estimate.groups[0].change, -0.1, 0.03);
  EXPECT_FALSE(result.estimate.groups[1].changed);

  Baseline from_zero = *baseline_;
  from_zero.following[0] = FollowingText("temperature", 0.0, {});
  EXPECT_FALSE(AnalyseDamage(fit.problem, fit.summary, fit.model, {from_zero},
                             options, &result, &error));
  EXPECT_THAT(error, HasSubstr("follows temperature from 0, expected"));
}

// Held elsewhere, groups are elsewhere, and their changes are where they were:
// to the first order it does not matter.
TEST_F(HeldFollowersFigures, ChangesDoNotDependOnWhereTheyAreHeld) {
  const double slope = baseline_->with_followers.values[4];
  constexpr double kAway = 4e-4;  // a tenth of the slope
  std::vector<DamageResult> results;
  for (const double away : {0.0, kAway}) {
    IdentificationProblem problem = NewProblem(-10.0, 9, 0.0);
    Hold(slope + away, &problem);
    results.push_back(Analyse(IdentifyOrFail(std::move(problem))));
  }
  for (size_t j = 0; j < 2; ++j) {
    // A difference of 30 degrees.
    EXPECT_NEAR(results[1].summary.parameters[j].value -
                    results[0].summary.parameters[j].value,
                30.0 * kAway, 0.05 * 30.0 * kAway);
    EXPECT_NEAR(results[1].estimate.groups[j].change,
                results[0].estimate.groups[j].change, 0.04 * 30.0 * kAway);
    EXPECT_NEAR(results[1].estimate.groups[j].sigma,
                results[0].estimate.groups[j].sigma,
                0.05 * results[0].estimate.groups[j].sigma);
  }
}

// The uncertainty of the slope does not enter changes at the temperatures of
// the baseline, though it enters the baseline's own values at the reference.
TEST_F(HeldFollowersFigures, UncertaintyGrowsAwayFromTheBaseline) {
  IdentificationProblem problem = NewProblem(10.0, 10, 0.0);
  Hold(baseline_->with_followers.values[4], &problem);
  const Identification fit = IdentifyOrFail(std::move(problem));
  HeldFollowers followers({*baseline_}, fit.problem);
  EXPECT_THAT(followers.names(), ElementsAre("all"));
  const std::vector<std::string> groups = {"k1", "k2", "cm", "ck"};
  std::string error;
  ASSERT_TRUE(followers.FindSlopes(RecordsOf(fit), groups, {}, 1, &error))
      << error;
  const GroupState near =
      followers.Compared(followers.StateOf(*baseline_), groups.size());
  // All the stiffness times (10 - 20) degrees.
  const Matrix& covariance = baseline_->with_followers.covariance;
  for (int j = 0; j < 2; ++j) {
    EXPECT_NEAR(
        near.covariance(j, j),
        covariance(j, j) - 20.0 * covariance(j, 4) + 100.0 * covariance(4, 4),
        0.02 * near.covariance(j, j));
    EXPECT_LT(near.covariance(j, j), 0.75 * covariance(j, j));
  }
}

}  // namespace
}  // namespace pinode
