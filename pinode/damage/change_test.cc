#include "pinode/damage/change.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace pinode {
namespace {

using ::testing::HasSubstr;

// Five groups whose estimates are correlated like those of neighbouring
// storeys, each known to about a per cent.
class EstimateChangeTest : public ::testing::Test {
 protected:
  static constexpr int kGroups = 5;

  EstimateChangeTest() : covariance_(kGroups, kGroups) {
    for (int i = 0; i < kGroups; ++i) {
      for (int j = 0; j < kGroups; ++j) {
        covariance_(i, j) = 1e-4 * std::pow(-0.6, std::abs(i - j));
      }
    }
  }

  GroupState Draw(const Vector& truth) {
    std::normal_distribution<double> normal;
    Vector z(kGroups);
    for (double& entry : z) entry = normal(random_);
    return {truth + covariance_.llt().matrixL() * z, covariance_};
  }

  ChangeEstimate Estimate(const std::vector<GroupState>& healthy,
                          const GroupState& current) {
    ChangeOptions options;
    options.num_draws = 2000;
    ChangeEstimate estimate;
    std::string error;
    EXPECT_TRUE(EstimateChange(healthy, current, options, &estimate, &error))
        << error;
    return estimate;
  }

  static int CountChanged(const ChangeEstimate& estimate) {
    return static_cast<int>(
        std::count_if(estimate.groups.begin(), estimate.groups.end(),
                      [](const GroupChange& group) { return group.changed; }));
  }

  Matrix covariance_;
  std::mt19937_64 random_{7};
};

TEST_F(EstimateChangeTest, HoldsTheFamilyWiseRate) {
  constexpr int kTrials = 2000;
  const Vector truth = Vector::Constant(kGroups, 0.1);
  int alarms = 0;
  int covered = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const ChangeEstimate estimate = Estimate({Draw(truth)}, Draw(truth));
    alarms += CountChanged(estimate) > 0;
    covered +=
        estimate.groups[2].lower95 <= 0.0 && 0.0 <= estimate.groups[2].upper95;
  }
  // Three standard deviations of a binomial count.
  EXPECT_NEAR(alarms, 0.05 * kTrials,
              3.0 * std::sqrt(0.05 * 0.95 * kTrials) + 5.0);
  EXPECT_NEAR(covered, 0.95 * kTrials,
              3.0 * std::sqrt(0.05 * 0.95 * kTrials) + 5.0);
}

TEST_F(EstimateChangeTest, FindsTwoChangesAndNoOther) {
  constexpr int kTrials = 300;
  const Vector truth = Vector::Constant(kGroups, 0.25);
  Vector damaged = truth;
  damaged[1] = 1.25 * 0.9 - 1.0;
  damaged[4] = 1.25 * 0.85 - 1.0;
  int exact = 0;
  int covered = 0;
  double sum = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const ChangeEstimate estimate = Estimate({Draw(truth)}, Draw(damaged));
    const auto& groups = estimate.groups;
    exact +=
        CountChanged(estimate) == 2 && groups[1].changed && groups[4].changed;
    covered += groups[1].lower95 <= -0.1 && -0.1 <= groups[1].upper95;
    sum += groups[1].change;
    EXPECT_GT(groups[4].probability, 0.99);
    EXPECT_EQ(estimate.unexplained_degrees, kGroups - CountChanged(estimate));
  }
  EXPECT_GE(exact, 0.93 * kTrials);
  EXPECT_NEAR(covered, 0.95 * kTrials, 12.0);
  EXPECT_NEAR(sum / kTrials, -0.1, 0.002);
}

// A refit of one group is the generalised least-squares estimate.
TEST_F(EstimateChangeTest, RefitIsGeneralisedLeastSquares) {
  const GroupState healthy{Vector::Zero(kGroups), covariance_};
  GroupState current = healthy;
  current.values << 0.004, -0.003, -0.2, 0.006, 0.001;
  const ChangeEstimate estimate = Estimate({healthy}, current);
  ASSERT_EQ(CountChanged(estimate), 1);
  const Matrix information = (2.0 * covariance_).inverse();
  const double variance = 1.0 / information(2, 2);
  const double change = variance * information.row(2).dot(current.values);
  const GroupChange& group = estimate.groups[2];
  EXPECT_NEAR(group.change, change, 1e-12);
  EXPECT_NEAR(group.upper95 - group.change, 1.959964 * std::sqrt(variance),
              1e-8);
  EXPECT_FALSE(estimate.has_between_records);
  const Vector rest = current.values - change * Vector::Unit(kGroups, 2);
  EXPECT_NEAR(estimate.unexplained_chi2, rest.dot(information * rest), 1e-9);
}

// Healthy records that differ among themselves by 3 %: a change of 5 % is then
// nothing special; taken alone each record would call it one.
TEST_F(EstimateChangeTest, DifferencesBetweenRecordsCount) {
  std::normal_distribution<double> normal(0.0, 0.03);
  constexpr int kTrials = 200;
  int alone = 0;
  int together = 0;
  double between = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<GroupState> healthy;
    for (int i = 0; i < 8; ++i) {
      Vector truth(kGroups);
      for (double& value : truth) value = normal(random_);
      healthy.push_back(Draw(truth));
    }
    Vector truth(kGroups);
    for (double& value : truth) value = normal(random_);
    const GroupState current = Draw(truth);
    alone += CountChanged(Estimate({healthy[0]}, current)) > 0;
    const ChangeEstimate estimate = Estimate(healthy, current);
    EXPECT_TRUE(estimate.has_between_records);
    together += CountChanged(estimate) > 0;
    between += estimate.between_records.mean();
  }
  EXPECT_GT(alone, 0.8 * kTrials);
  EXPECT_LT(together, 0.12 * kTrials);
  EXPECT_NEAR(between / kTrials, 0.03, 0.006);
}

// Two groups of which each record tells one combination well, and another one
// than the other record does: both values of 0.37 meet these combinations,
// where all four estimates are within 0.02 of zero.
TEST(EstimateChangePool, TheMeanIsAmongWhatItIsOf) {
  const auto state = [](double value, double along) {
    const Vector unknown = 0.1 * Vector{{1.0, along}};
    return GroupState{Vector{{0.0, value}}, unknown * unknown.transpose() +
                                                1e-6 * Matrix::Identity(2, 2)};
  };
  const std::vector<GroupState> healthy = {state(-0.02, 1.0), state(0.02, 0.9)};
  const GroupState current = {Vector::Zero(2), 1e-6 * Matrix::Identity(2, 2)};
  ChangeOptions options;
  options.num_draws = 1000;
  ChangeEstimate estimate;
  std::string error;
  ASSERT_TRUE(EstimateChange(healthy, current, options, &estimate, &error))
      << error;
  for (const GroupChange& group : estimate.groups) {
    EXPECT_LT(std::abs(group.change), 0.02);
  }
  // Both groups changed together, which no single change explains.
  EXPECT_LT(estimate.unexplained_chi2, 1.0);
}

TEST_F(EstimateChangeTest, RefusesWhatDoesNotFit) {
  const GroupState healthy{Vector::Zero(kGroups), covariance_};
  ChangeEstimate estimate;
  std::string error;
  EXPECT_FALSE(EstimateChange({}, healthy, ChangeOptions(), &estimate, &error));
  EXPECT_EQ(error, "there is no baseline state");
  EXPECT_FALSE(
      EstimateChange({healthy, {Vector::Zero(2), Matrix::Identity(2, 2)}},
                     healthy, ChangeOptions(), &estimate, &error));
  EXPECT_THAT(error, HasSubstr("baseline state 2 has 2 groups"));
  GroupState singular = healthy;
  singular.covariance(0, 0) = 0.0;
  EXPECT_FALSE(
      EstimateChange({healthy}, singular, ChangeOptions(), &estimate, &error));
  EXPECT_THAT(error, HasSubstr("the current state does not determine"));
  GroupState gone = healthy;
  gone.values[3] = -1.0;
  EXPECT_FALSE(
      EstimateChange({gone}, healthy, ChangeOptions(), &estimate, &error));
  EXPECT_THAT(error, HasSubstr("group 4 is not positive"));
  ChangeOptions options;
  options.threshold = 1.5;
  EXPECT_FALSE(EstimateChange({healthy}, healthy, options, &estimate, &error));
  EXPECT_THAT(error, HasSubstr("threshold"));
}

// Two groups that the data hardly tell apart: either explains the change.
TEST(EstimateChangeRivals, NamesWhatExplainsTheChangeAsWell) {
  Matrix information(3, 3);
  information << 1e4, 0.98e4, 0.0, 0.98e4, 1e4, 0.0, 0.0, 0.0, 1e4;
  const Matrix covariance = information.inverse();
  const GroupState healthy = {Vector::Zero(3), 1e-6 * covariance};
  Vector truth(3);
  truth << -0.06, 0.0, 0.0;
  const GroupState current = {truth, covariance};
  ChangeOptions options;
  ChangeEstimate estimate;
  std::string error;
  ASSERT_TRUE(EstimateChange({healthy}, current, options, &estimate, &error))
      << error;
  EXPECT_TRUE(estimate.groups[0].changed);
  ASSERT_EQ(estimate.rivals.size(), 1u);
  EXPECT_EQ(estimate.rivals[0].found, 0);
  EXPECT_EQ(estimate.rivals[0].other, 1);
  // z^2 (1 - 0.98^2), z = 6 standard deviations.
  EXPECT_NEAR(estimate.rivals[0].loss, 36.0 * (1.0 - 0.98 * 0.98), 1e-3);

  options.rival_loss = 1.0;
  ASSERT_TRUE(EstimateChange({healthy}, current, options, &estimate, &error));
  EXPECT_TRUE(estimate.rivals.empty());
}

// Mass, stiffness and damping of a free decay, as logarithms: it knows
// stiffness over mass to 0.001 and damping over mass to 0.05. Stiffness and
// damping have changed by -0.18 and -0.25. The mass alone leaves 0.07 of the
// damping.
TEST(FindChangeInstead, AllowsForWhatMayChangeAlong) {
  Matrix information = 0.25 * Matrix::Identity(3, 3);
  const Vector k{{-1.0, 1.0, 0.0}}, c{{-1.0, 0.0, 1.0}};
  information += 1e6 * k * k.transpose() + 400.0 * c * c.transpose();
  const Matrix covariance = information.inverse();
  const GroupState healthy = {Vector::Zero(3), covariance};
  const GroupState current = {Vector{{0.0, -0.18, -0.25}}, covariance};
  ChangeOptions options;
  options.absolute = {true, true, true};
  ChangeInstead instead;
  std::string error;
  ASSERT_TRUE(FindChangeInstead({healthy}, current, options, {0}, 0, 1, {2},
                                &instead, &error))
      << error;
  EXPECT_NEAR(instead.change.change, -0.18, 0.002);
  EXPECT_NEAR(instead.change.sigma, std::sqrt(2.0) * 0.001, 1e-4);
  EXPECT_GT(instead.change.probability, 0.999);
  EXPECT_LT(std::abs(instead.loss), 1.0);
  // With damping as it was, stiffness does not explain its decrease.
  ASSERT_TRUE(FindChangeInstead({healthy}, current, options, {0}, 0, 1, {},
                                &instead, &error));
  EXPECT_GT(instead.loss, 6.0);
  // A group that was found beside the mass stays.
  ASSERT_TRUE(FindChangeInstead({healthy}, current, options, {0, 1}, 0, 1, {2},
                                &instead, &error));
  EXPECT_NEAR(instead.change.change, -0.18, 0.002);
  EXPECT_FALSE(FindChangeInstead({}, current, options, {0}, 0, 1, {2}, &instead,
                                 &error));
}

TEST(NearlyGone, AsksAllStates) {
  GroupState one, other;
  one.values = Vector::Zero(4);
  other.values = Vector::Zero(4);
  one.values[1] = -0.95;
  other.values[2] = -3.0;
  other.values[3] = -0.85;
  EXPECT_EQ(NearlyGone({one, other}),
            std::vector<bool>({false, true, true, false}));
}

// An entry that was zero has no baseline value to be a fraction of.
TEST(EstimateChangeAbsolute, ChangesAsTheyAre) {
  const Matrix covariance = 1e-4 * Matrix::Identity(2, 2);
  const GroupState healthy = {Vector::Constant(2, 1.0), covariance};
  const GroupState current = {Vector::Constant(2, 1.5), covariance};
  ChangeOptions options;
  options.absolute = {false, true};
  ChangeEstimate estimate;
  std::string error;
  ASSERT_TRUE(EstimateChange({healthy}, current, options, &estimate, &error))
      << error;
  EXPECT_NEAR(estimate.groups[0].change, 0.25, 1e-12);
  EXPECT_NEAR(estimate.groups[1].change, 0.5, 1e-12);

  // A healthy -1 would be no stiffness at all.
  const GroupState nothing = {Vector::Constant(2, -1.0), covariance};
  EXPECT_FALSE(EstimateChange({nothing}, current, options, &estimate, &error));
  options.absolute = {true, true};
  EXPECT_TRUE(EstimateChange({nothing}, current, options, &estimate, &error));
  options.absolute = {true};
  EXPECT_FALSE(EstimateChange({nothing}, current, options, &estimate, &error));
  EXPECT_THAT(error, HasSubstr("absolute has 1 entries, expected 2 or none"));
}

}  // namespace
}  // namespace pinode
