// The priors of unknown forces in the cost: what multiplies what.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/statistics.h"
#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/objective/objective.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/estimate/shooting/residual_statistics.h"
#include "pinode/problem/parameter_layout.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

constexpr int kKnots = 12;

// One mass under a spline, its displacement measured, one free stiffness
// before the knots; the cost is quadratic in the knots.
IdentificationProblem ForceProblem(bool free) {
  auto dynamics = std::make_shared<StructuralDynamics>(
      testing::MakeChain(1, 10.0, 0.5), std::vector<InputSpec>{});
  std::string error;
  GroupTerm group;
  group.group.name = "k";
  group.group.matrix = Matrix::Ones(1, 1);
  EXPECT_TRUE(dynamics->AddGroup(group, &error)) << error;
  UnknownForceTerm term;
  term.name = "f";
  term.history =
      std::make_shared<SplineForce>(SplineForce::Options{3, 0, 0.1, kKnots, 2});
  term.outputs = Vector::Ones(1);
  term.parameters.name = "f";
  term.parameters.named = false;
  for (int k = 0; k < kKnots; ++k) {
    Parameter parameter;
    parameter.name = "f[" + std::to_string(k) + "]";
    parameter.free = free;
    term.parameters.parameters.push_back(parameter);
  }
  term.prior = SmoothnessPrior(kKnots, 5, 0.3);
  term.prior.precisions[1] = 4.0;
  EXPECT_TRUE(dynamics->AddUnknownForce(term, &error)) << error;

  IdentificationProblem problem;
  problem.dynamics = dynamics;
  IdentificationRecord record;
  record.name = "r";
  record.substeps = 1;
  record.start = IdentificationRecord::Start::kRest;
  record.excitation.emplace(0.0, 0.05, Matrix(0, 24), Interpolation::kLinear);
  MeasuredChannel channel;
  channel.observation = {"x", Quantity::kDisplacement, Vector::Ones(1)};
  channel.values.resize(24);
  for (int i = 0; i < 24; ++i) channel.values[i] = 0.01 * std::sin(0.5 * i);
  record.channels.push_back(channel);
  problem.records.push_back(record);
  return problem;
}

TEST(UnknownForcePrior, HasItsGroupsAndRows) {
  const ParameterLayout layout(ForceProblem(true));
  ASSERT_EQ(layout.num_decay_groups(), 3);
  EXPECT_LT(layout.decay_groups()[0].given, 0.0);
  EXPECT_EQ(layout.decay_groups()[1].given, 4.0);
  EXPECT_FALSE(layout.HasNetworkDecay());
  ASSERT_EQ(layout.decay_rows().size(), static_cast<size_t>(kKnots));
  // The stiffness is the first free parameter.
  EXPECT_EQ(layout.decay_rows()[0].first, 1);
  EXPECT_EQ(layout.decay_rows()[6].first, 6);
  EXPECT_EQ(layout.decay_rows()[6].group, 1);

  const ParameterLayout fixed(ForceProblem(false));
  EXPECT_EQ(fixed.num_decay_groups(), 0);
  EXPECT_TRUE(fixed.decay_rows().empty());
}

TEST(UnknownForcePrior, CostGradientAndHessianBelongTogether) {
  const IdentificationProblem problem = ForceProblem(true);
  const ParameterLayout layout(problem);
  Objective objective(problem, layout, MultipleShooting::Options());
  MultipleShooting& shooting = objective.shooting();
  SetSegments(0, {Matrix::Zero(2, 24)}, &shooting);
  shooting.SetSigmas({Vector::Constant(1, 0.02)});
  const Vector decays = Vector::LinSpaced(3, 2.0, 30.0);
  objective.priors().SetDecays(decays);
  Vector free = Vector::LinSpaced(1 + kKnots, -0.2, 0.3);
  CondensedSystem system;
  ASSERT_TRUE(objective.Linearize(free, &system));

  Vector step = Vector::Zero(1 + kKnots);
  for (int k = 1; k <= kKnots; ++k) step[k] = 0.1 * std::cos(1.7 * k);
  double moved = 0.0;
  ASSERT_TRUE(objective.Evaluate(free + step, &moved));
  const double expected = system.cost + system.gradient.dot(step) +
                          0.5 * step.dot(system.hessian * step);
  EXPECT_NEAR(moved, expected, 1e-11 * moved);

  // Their share in the cost, from the definition.
  double share = 0.0;
  const auto p = [&free](int k) {
    return k < 0 || k >= kKnots ? 0.0 : free[1 + k];
  };
  for (int k = 0; k < kKnots; ++k) {
    const double bend = p(k - 1) - 2.09 * p(k) + p(k + 1);
    share += 0.5 * decays[k / 5] * bend * bend;
  }
  objective.priors().SetDecays(Vector::Zero(3));
  double without = 0.0;
  ASSERT_TRUE(objective.Evaluate(free, &without));
  EXPECT_GT(share, 0.1);
  EXPECT_NEAR(system.cost - without, share, 1e-10 * system.cost);
}

// A force that follows part of the noise leaves residuals that are not white,
// which says nothing against the noise; noise with a memory does.
TEST(UnknownForcePrior, AutocorrelationIsAMatterOfTheNoise) {
  constexpr int kLength = 600;
  constexpr int kMany = 200;
  constexpr double kSigma = 0.02;
  for (const double memory : {0.0, 0.9}) {
    IdentificationProblem problem;
    auto dynamics = std::make_shared<StructuralDynamics>(
        testing::MakeChain(1, 10.0, 0.5), std::vector<InputSpec>{});
    UnknownForceTerm term;
    term.name = "f";
    term.history = std::make_shared<SplineForce>(
        SplineForce::Options{3, 0, 0.15, kMany, 1});
    term.outputs = Vector::Ones(1);
    term.parameters.name = "f";
    term.parameters.named = false;
    for (int k = 0; k < kMany; ++k) {
      Parameter parameter;
      parameter.name = "f[" + std::to_string(k) + "]";
      term.parameters.parameters.push_back(parameter);
    }
    term.prior = SmoothnessPrior(kMany, kMany, 0.3);
    std::string error;
    ASSERT_TRUE(dynamics->AddUnknownForce(term, &error)) << error;
    problem.dynamics = dynamics;
    IdentificationRecord record;
    record.name = "r";
    record.substeps = 1;
    record.start = IdentificationRecord::Start::kRest;
    record.excitation.emplace(0.0, 0.05, Matrix(0, kLength),
                              Interpolation::kLinear);
    MeasuredChannel channel;
    channel.observation = {"a", Quantity::kAbsoluteAcceleration,
                           Vector::Ones(1)};
    channel.values.resize(kLength);
    testing::Gaussian random(5);
    double noise = 0.0;
    for (double& value : channel.values) {
      noise = memory * noise + std::sqrt(1.0 - memory * memory) * random.Next();
      value = kSigma * noise;
    }
    record.channels.push_back(channel);
    problem.records.push_back(record);

    const ParameterLayout layout(problem);
    Objective objective(problem, layout, MultipleShooting::Options());
    MultipleShooting& shooting = objective.shooting();
    SetSegments(0, {Matrix::Zero(2, kLength)}, &shooting);
    const std::vector<Vector> sigmas = {Vector::Constant(1, kSigma)};
    shooting.SetSigmas(sigmas);
    objective.priors().SetDecays(Vector::Constant(1, 500.0));
    // Linear: one step leads to the minimum.
    CondensedSystem system;
    ASSERT_TRUE(objective.Linearize(Vector::Zero(kMany), &system));
    const Vector free = -system.hessian.ldlt().solve(system.gradient);
    std::vector<Matrix> residuals;
    ASSERT_TRUE(WeightedResiduals(free, false, &shooting, &residuals, nullptr));
    EXPECT_GT(LjungBoxExcess(residuals[0].row(0), 20), 3.5);

    CovarianceEstimate plain, automatic;
    ASSERT_TRUE(EstimateCovariance(problem, layout,
                                   IdentificationOptions::Covariance::kPlain,
                                   free, sigmas, &objective, &plain));
    ASSERT_TRUE(EstimateCovariance(problem, layout,
                                   IdentificationOptions::Covariance::kAuto,
                                   free, sigmas, &objective, &automatic));
    if (memory == 0.0) {
      EXPECT_EQ(automatic.method, "plain");
    } else {
      EXPECT_EQ(automatic.method, "inflated");
      EXPECT_GT(automatic.covariance.trace(), 2.0 * plain.covariance.trace());
    }
  }
}

}  // namespace
}  // namespace pinode
