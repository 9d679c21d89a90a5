#include "pinode/estimate/trajectory_cost.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

// A problem of a user's own: the trajectory, and a residual that says that both
// stiffnesses are the same.
struct SameStiffness {
  template <typename T>
  bool operator()(const T* free, T* residual) const {
    residual[0] = 1e4 * (free[0] - free[1]);
    return true;
  }
};

TEST(TrajectoryCost, StandsBesideAUsersResiduals) {
  auto dynamics = testing::MakeGroupedChain(2, 30.0, 0.3);
  IdentificationRecord record =
      testing::MakeExcitedRecord(*dynamics, 120, 0.05);
  record.name = "r";
  record.channels = {testing::MakeChannel("x2", Quantity::kDisplacement, 2, 1)};
  testing::Simulate(*dynamics, Eigen::Vector2d(0.1, 0.1), Vector::Zero(4), 0.02,
                    3, &record);
  IdentificationProblem problem;
  problem.records.push_back(record);
  problem.dynamics = dynamics;
  for (const int segment_samples : {0, 30}) {
    TrajectoryCost::Options options;
    options.segment_samples = segment_samples;
    std::string error;
    auto cost = TrajectoryCost::Create(problem, options, &error);
    ASSERT_NE(cost, nullptr) << error;
    EXPECT_EQ(cost->layout().num_free(), 2);
    Vector free = cost->InitialValues();
    ceres::Problem ceres_problem;
    ceres_problem.AddResidualBlock(cost.release(), nullptr, free.data());
    ceres_problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<SameStiffness, 1, 2>(new SameStiffness),
        nullptr, free.data());
    ceres::Solver::Options solver_options;
    ceres::Solver::Summary summary;
    ceres::Solve(solver_options, &ceres_problem, &summary);
    EXPECT_TRUE(summary.IsSolutionUsable()) << summary.FullReport();
    EXPECT_NEAR(free[0], free[1], 1e-5);
    EXPECT_NEAR(free[0], 0.1, 0.02);
  }
}

TEST(MakePriorCost, TakesWeightDecays) {
  const testing::SmallFit fit(IdentificationRecord::Start::kFree);
  ASSERT_GT(fit.layout->num_decay_groups(), 0);
  const auto cost_with = [&](const Vector& decays) {
    const auto prior = MakePriorCost(*fit.layout, decays);
    Vector residuals(prior->num_residuals());
    const double* block = fit.free.data();
    EXPECT_TRUE(prior->Evaluate(&block, residuals.data(), nullptr));
    return 0.5 * residuals.squaredNorm();
  };
  double decayed = 0.0;
  for (const ParameterLayout::DecayRow& row : fit.layout->decay_rows()) {
    decayed += 0.5 * 0.3 * std::pow(row.Value(fit.free), 2);
  }
  EXPECT_GT(decayed, 0.0);
  const Vector decays = Vector::Constant(fit.layout->num_decay_groups(), 0.3);
  EXPECT_NEAR(cost_with(decays) - cost_with(Vector()), decayed,
              1e-12 * cost_with(decays));
}

}  // namespace
}  // namespace pinode
