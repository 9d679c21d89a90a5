#include "pinode/estimate/certainty/force_bands.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "pinode/base/constants.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

constexpr int kSplineKnots = 12;

// One mass under a spline with a precision for each knot, 0.1 apart, sampled
// every 0.05.
IdentificationProblem SplineProblem() {
  auto dynamics = std::make_shared<StructuralDynamics>(
      testing::MakeChain(1, 10.0, 0.5), std::vector<InputSpec>{});
  std::string error;
  UnknownForceTerm term;
  term.name = "f";
  term.history = std::make_shared<SplineForce>(
      SplineForce::Options{3, 0, 0.1, kSplineKnots, 2});
  term.outputs = Vector::Ones(1);
  term.parameters.name = "f";
  term.parameters.named = false;
  for (int k = 0; k < kSplineKnots; ++k) {
    Parameter parameter;
    parameter.name = "f[" + std::to_string(k) + "]";
    term.parameters.parameters.push_back(parameter);
  }
  term.prior = SmoothnessPrior(kSplineKnots, 1, 0.3);
  EXPECT_TRUE(dynamics->AddUnknownForce(term, &error)) << error;
  IdentificationProblem problem;
  problem.dynamics = dynamics;
  IdentificationRecord record;
  record.excitation.emplace(0.0, 0.05, Matrix(0, 20), Interpolation::kLinear);
  record.substeps = 1;
  record.channels = {testing::MakeChannel("x", Quantity::kDisplacement, 1, 0)};
  problem.records.push_back(record);
  return problem;
}

TEST(ForceBands, VariancesArePooledWithTheNeighbours) {
  const IdentificationProblem problem = SplineProblem();
  const ParameterLayout layout(problem);
  ASSERT_EQ(layout.num_decay_groups(), kSplineKnots);
  Vector decays = Vector::Constant(kSplineKnots, 1e8);
  decays[5] = 0.5;  // where the force strikes
  const Vector pooled = BandDecays(problem, layout, decays, ForceBandTuning());
  // Two samples are one knot to either side: the mean of three variances.
  for (const int k : {4, 5, 6}) EXPECT_NEAR(pooled[k], 1.5, 1e-7) << k;
  EXPECT_NEAR(pooled[3], 1e8, 1.0);
  EXPECT_NEAR(pooled[7], 1e8, 1.0);
}

TEST(ForceBands, AreTheSquareRootOfTheForcesVariance) {
  const IdentificationProblem problem = SplineProblem();
  const ParameterLayout layout(problem);
  const Vector parameters = Vector::LinSpaced(kSplineKnots, 0.0, 1.0);
  const Matrix covariance = Matrix::Identity(kSplineKnots, kSplineKnots) * 0.04;
  auto forces = EstimateForces(problem, layout, parameters, covariance, 2.0);
  ASSERT_EQ(forces.size(), 1u);
  const ForceEstimate& force = forces[0];
  EXPECT_EQ(force.name, "f");
  EXPECT_EQ(force.record, 0);
  ASSERT_EQ(force.times.size(), 20);
  const auto& history = *problem.dynamics->unknown_forces()[0].history;
  for (int i = 0; i < force.times.size(); ++i) {
    const ForceHistory::Local local =
        history.Evaluate(force.times[i], parameters.data());
    const double size =
        Eigen::Map<const Vector>(local.derivatives, local.count).norm();
    EXPECT_DOUBLE_EQ(force.value[i], local.value);
    EXPECT_NEAR(force.sigma[i], 0.2 * size, 1e-14);
    EXPECT_DOUBLE_EQ(force.upper95[i], force.value[i] + 2.0 * force.sigma[i]);
  }
  forces = EstimateForces(problem, layout, parameters, Matrix(), 2.0);
  EXPECT_EQ(forces[0].sigma[3], kInfinity) << "no covariance";
}

TEST(ForceBands, AreNoneWithoutForces) {
  const testing::SmallFit fit(IdentificationRecord::Start::kRest);
  EXPECT_EQ(BandDecays(fit.problem, *fit.layout, fit.decays, ForceBandTuning()),
            fit.decays);
  EXPECT_TRUE(EstimateForces(fit.problem, *fit.layout,
                             fit.layout->InitialValues(), Matrix(), 1.96)
                  .empty());
}

}  // namespace
}  // namespace pinode
