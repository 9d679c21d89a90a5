#include "pinode/discover/ensemble.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/discover_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

Ensemble Trained(const RegressionProblem& problem, const SparseLearner& learner,
                 const EnsembleOptions& options) {
  Ensemble ensemble;
  std::string error;
  EXPECT_TRUE(RunEnsemble(problem, learner, options, &ensemble, &error))
      << error;
  return ensemble;
}

SparseLearner Stlsq() {
  StlsqOptions options;
  options.threshold = 0.02;
  return StlsqLearner(options);
}

// Keeps whatever it is offered.
Vector LeastSquares(const LeastSquaresSystem& system,
                    const CoefficientMap& map) {
  std::vector<int> offered;
  for (int i = 0; i < system.num_free(); ++i) {
    if (system.A.col(i).norm() > 0.0) offered.push_back(i);
  }
  return FitSupport(system, map, offered);
}

void ExpectTrueTerms(const RegressionProblem& problem,
                     const SparseLearner& learner) {
  EnsembleOptions options;
  options.num_bags = 50;
  const Ensemble ensemble = Trained(problem, learner, options);
  EXPECT_EQ(ensemble.support, testing::DuffingSupport());
  for (int j : testing::DuffingSupport()) {
    EXPECT_GT(ensemble.inclusion_probability[j], 0.9) << j;
    EXPECT_LT(ensemble.lower[j], ensemble.median[j]);
    EXPECT_LT(ensemble.median[j], ensemble.upper[j]);
    EXPECT_EQ(ensemble.num_offered[static_cast<size_t>(j)], 50);
  }
  EXPECT_LT(ensemble.lower[0], -4.0);
  EXPECT_GT(ensemble.upper[0], -4.0);
  // The last fit is that to all samples.
  CoefficientMap map;
  std::string error;
  ASSERT_TRUE(problem.IsValid(&error, &map)) << error;
  EXPECT_EQ(ensemble.coefficients,
            FitSupport(Condense(problem, map), map, testing::DuffingSupport()));
}

TEST(Ensemble, TrueTermsAreFoundAgain) {
  ExpectTrueTerms(testing::Duffing(400, 0.02, 1), Stlsq());
  const RegressionProblem problem = testing::Duffing(400, 0.05, 1);
  ExpectTrueTerms(problem, LassoLearner({}, {}));
  // Three hundredths of the RMS of what is regressed.
  const double rms = problem.outputs[0].y.norm() / std::sqrt(400.0);
  ExpectTrueTerms(problem, LassoLearnerWithin(0.03 * rms, {}, {}));
}

// Samples that bags draw twice are no further evidence. If that is ignored,
// more than one in twenty of these is included.
TEST(Ensemble, FalseTermsAreRare) {
  double sum = 0.0;
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    testing::Gaussian random(seed);
    const Matrix theta = random.Draw(400, 12);
    const Vector y = theta.col(3) + 0.5 * random.Draw(400, 1);
    const Ensemble ensemble =
        Trained(testing::Problem(theta, y), LassoLearner({}, {}), {});
    EXPECT_EQ(ensemble.inclusion_probability[3], 1.0);
    sum += (ensemble.inclusion_probability.sum() - 1.0) / 11.0;
  }
  EXPECT_LT(sum / 3.0, 0.02);
}

// Noise moves the fit of each candidate by as much as blocks differ.
TEST(Ensemble, SpreadFollowsTheNoise) {
  testing::Gaussian random(2);
  const Matrix theta = random.Draw(1000, 3);
  const Vector noise = random.Draw(1000, 1);
  EnsembleOptions options;
  options.num_bags = 400;
  options.num_blocks = 50;
  for (double size : {0.1, 0.4}) {
    const Ensemble ensemble =
        Trained(testing::Problem(theta, theta.col(0) + size * noise),
                LeastSquares, options);
    EXPECT_EQ(ensemble.inclusion_probability, Vector::Ones(3));
    // 1.96 standard errors to each side, of size / sqrt(samples).
    const double expected = 2.0 * 1.96 * size / std::sqrt(1000.0);
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(ensemble.upper[j] - ensemble.lower[j], expected,
                  0.3 * expected);
    }
  }
}

TEST(Ensemble, LibraryBagging) {
  const RegressionProblem problem = testing::Duffing(400, 0.01, 3);
  EnsembleOptions options;
  options.num_bags = 200;
  options.library_fraction = 0.8;
  // Each learner sees the columns that its bag was offered.
  const SparseLearner counting = [](const LeastSquaresSystem& system,
                                    const CoefficientMap& map) {
    EXPECT_EQ((system.A.colwise().norm().array() > 0.0).count(), 16);
    return LeastSquares(system, map);
  };
  const Ensemble all = Trained(problem, counting, options);
  int offered = 0;
  for (int j = 0; j < 20; ++j) {
    const int count = all.num_offered[static_cast<size_t>(j)];
    EXPECT_NEAR(count, 160, 30);
    offered += count;
    // All bags that were offered it include it.
    EXPECT_EQ(all.inclusion_probability[j], 1.0);
  }
  EXPECT_EQ(offered, 200 * 16);
  // A term that is missing makes others stand in for it: they are found less
  // often than the true ones.
  const Ensemble ensemble = Trained(problem, Stlsq(), options);
  double least_true = 1.0;
  double most_false = 0.0;
  for (int j = 0; j < 20; ++j) {
    const bool is_true = j == 0 || j == 1 || j == 5;
    const double probability = ensemble.inclusion_probability[j];
    if (is_true) least_true = std::min(least_true, probability);
    if (!is_true) most_false = std::max(most_false, probability);
  }
  EXPECT_GT(least_true, 0.95);
  EXPECT_LT(most_false, 0.6);
  EXPECT_EQ(ensemble.support, testing::DuffingSupport());
}

TEST(Ensemble, ThreadsAndSeeds) {
  const RegressionProblem problem = testing::Duffing(300, 0.05, 4);
  EnsembleOptions options;
  options.num_bags = 20;
  options.library_fraction = 0.9;
  const Ensemble one = Trained(problem, Stlsq(), options);
  options.num_threads = 2;
  const Ensemble two = Trained(problem, Stlsq(), options);
  EXPECT_EQ(one.inclusion_probability, two.inclusion_probability);
  EXPECT_EQ(one.median, two.median);
  EXPECT_EQ(one.num_offered, two.num_offered);
  options.seed = 2;
  EXPECT_NE(Trained(problem, Stlsq(), options).median, one.median);
}

TEST(Ensemble, ConstraintsHold) {
  RegressionProblem problem = testing::Duffing(300, 0.01, 5);
  problem.constraints = {CoefficientConstraint::Given("v", -0.3),
                         CoefficientConstraint::Equal({"x", "x^3"}, {-2, -3}),
                         CoefficientConstraint::Positive("x^2")};
  EnsembleOptions options;
  options.num_bags = 40;
  options.library_fraction = 0.9;
  const Ensemble ensemble = Trained(problem, LeastSquares, options);
  EXPECT_EQ(ensemble.inclusion_probability[1], 1.0);
  EXPECT_EQ(ensemble.median[1], -0.3);
  EXPECT_EQ(ensemble.num_offered[0], ensemble.num_offered[5]);
  EXPECT_NEAR(ensemble.median[0] / 2.0, ensemble.median[5] / 3.0, 1e-12);
  EXPECT_LE(ensemble.lower[0], ensemble.upper[0]);
  EXPECT_GE(ensemble.lower[2], 0.0);
  for (int j : ensemble.support) EXPECT_NE(j, 1);
}

TEST(Ensemble, RefusesBadOptions) {
  const RegressionProblem problem = testing::Duffing(50, 0.01, 1);
  Ensemble ensemble;
  std::string error;
  EnsembleOptions options;
  options.num_bags = 0;
  EXPECT_FALSE(RunEnsemble(problem, Stlsq(), options, &ensemble, &error));
  EXPECT_THAT(error, HasSubstr("num_bags 0"));
  options = {};
  options.library_fraction = 0.0;
  EXPECT_FALSE(RunEnsemble(problem, Stlsq(), options, &ensemble, &error));
  EXPECT_THAT(error, HasSubstr("library_fraction 0"));
  options = {};
  options.inclusion_threshold = 1.5;
  EXPECT_FALSE(RunEnsemble(problem, Stlsq(), options, &ensemble, &error));
  EXPECT_THAT(error, HasSubstr("inclusion_threshold 1.5"));
  EXPECT_TRUE(ensemble.support.empty());
}

}  // namespace
}  // namespace pinode
