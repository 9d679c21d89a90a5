#include "pinode/estimate/segment_cost.h"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pinode/estimate/trajectory_cost.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

using Start = IdentificationRecord::Start;

std::unique_ptr<SegmentCost> MakeSegment(const testing::SmallFit& fit,
                                         int first, int last,
                                         DerivativeMethod derivatives) {
  SegmentCost::Options options;
  options.sigmas = fit.sigmas[0];
  options.gap_sigmas = fit.scales[0];
  options.derivatives = derivatives;
  std::string error;
  auto cost = SegmentCost::Create(fit.problem, 0, first, last, options, &error);
  EXPECT_NE(cost, nullptr) << error;
  return cost;
}

// Inside of the record with a gap, and at its end without one.
TEST(SegmentCost, HasTheDerivativesOfItsResiduals) {
  using RowMajor =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  constexpr double kRounding = 1e-9;
  const testing::SmallFit fit(Start::kFree);
  for (const int first : {3, 21}) {
    const int last = first == 3 ? 12 : 30;
    for (const DerivativeMethod derivatives :
         {DerivativeMethod::kTangents, DerivativeMethod::kJets}) {
      const auto cost = MakeSegment(fit, first, last, derivatives);
      const bool gap = first == 3;
      EXPECT_EQ(cost->HasGap(), gap);
      ASSERT_EQ(cost->parameter_block_sizes().size(), gap ? 3u : 2u);
      std::vector<Vector> values = {fit.states[0].col(first)};
      if (gap) values.push_back(fit.states[0].col(last));
      values.push_back(fit.free);
      std::vector<const double*> blocks;
      std::vector<RowMajor> jacobians;
      for (const Vector& block : values) {
        blocks.push_back(block.data());
        jacobians.emplace_back(cost->num_residuals(), block.size());
      }
      std::vector<double*> into;
      for (RowMajor& jacobian : jacobians) into.push_back(jacobian.data());
      Vector residuals(cost->num_residuals());
      ASSERT_TRUE(cost->Evaluate(blocks.data(), residuals.data(), into.data()));
      for (size_t b = 0; b < values.size(); ++b) {
        for (Eigen::Index j = 0; j < values[b].size(); ++j) {
          const auto moved = [&](double h) {
            Vector block = values[b];
            block[j] += h;
            std::vector<const double*> there = blocks;
            there[b] = block.data();
            Vector value(cost->num_residuals());
            EXPECT_TRUE(cost->Evaluate(there.data(), value.data(), nullptr));
            return value;
          };
          // Small steps: delays and hysteresis have kinks.
          const double step = 1e-4 * std::max(0.1, std::abs(values[b][j]));
          const Vector slope = testing::Differentiate(moved, step);
          // The last term is what differences of these residuals know.
          const Vector errors = (jacobians[b].col(j) - slope).cwiseAbs();
          EXPECT_LT((errors - 1e-6 * slope.cwiseAbs()).maxCoeff(), kRounding)
              << first << ", block " << b << ", column " << j;
        }
      }
    }
  }
}

TEST(SegmentCost, TangentsAndJetsAgree) {
  const testing::SmallFit fit(Start::kFree);
  Vector residuals[2];
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>
      jacobian[2];
  for (int m = 0; m < 2; ++m) {
    const auto cost = MakeSegment(
        fit, 3, 12,
        m == 0 ? DerivativeMethod::kTangents : DerivativeMethod::kJets);
    const Vector start = fit.states[0].col(3);
    const Vector next = fit.states[0].col(12);
    const double* blocks[] = {start.data(), next.data(), fit.free.data()};
    residuals[m].resize(cost->num_residuals());
    jacobian[m].resize(cost->num_residuals(), fit.free.size());
    double* jacobians[] = {nullptr, nullptr, jacobian[m].data()};
    ASSERT_TRUE(cost->Evaluate(blocks, residuals[m].data(), jacobians));
  }
  EXPECT_LT((residuals[0] - residuals[1]).norm(), 1e-11 * residuals[0].norm());
  EXPECT_LT((jacobian[0] - jacobian[1]).norm(), 1e-11 * jacobian[0].norm());
}

// A chain from rest whose two stiffnesses are unknown.
IdentificationProblem ChainProblem() {
  auto dynamics = testing::MakeGroupedChain(2, 30.0, 0.3);
  IdentificationRecord record = testing::MakeExcitedRecord(*dynamics, 81, 0.05);
  record.name = "r";
  record.channels = {
      testing::MakeChannel("x1", Quantity::kDisplacement, 2, 0),
      testing::MakeChannel("a2", Quantity::kAbsoluteAcceleration, 2, 1)};
  testing::Simulate(*dynamics, Eigen::Vector2d(0.1, -0.05), Vector::Zero(4),
                    0.02, 3, &record);
  IdentificationProblem problem;
  problem.records.push_back(record);
  problem.dynamics = dynamics;
  return problem;
}

// Its record in four segments, a dozen lines.
void SolvePlainProblem(const IdentificationProblem& problem, double gap_sigma,
                       const ceres::Solver::Options& options, Matrix* starts,
                       Vector* free, ceres::Solver::Summary* summary) {
  constexpr int kLength = 20;
  SegmentCost::Options segment;
  segment.gap_sigmas = Vector::Constant(4, gap_sigma);
  ceres::Problem ceres_problem;
  std::string error;
  for (int k = 0; k < starts->cols(); ++k) {
    auto cost = SegmentCost::Create(problem, 0, k * kLength, (k + 1) * kLength,
                                    segment, &error);
    ASSERT_NE(cost, nullptr) << error;
    std::vector<double*> blocks = {starts->col(k).data()};
    if (cost->HasGap()) blocks.push_back(starts->col(k + 1).data());
    blocks.push_back(free->data());
    ceres_problem.AddResidualBlock(cost.release(), nullptr, blocks);
  }
  ceres_problem.SetParameterBlockConstant(starts->col(0).data());
  ceres::Solve(options, &ceres_problem, summary);
}

// Starts and parameters side by side, the gaps held ever more firmly: in the
// minimum the parameters are those of the condensed problem, whose record runs
// in one piece.
TEST(SegmentCost, ThePlainProblemHasTheMinimumOfTheCondensedOne) {
  const IdentificationProblem problem = ChainProblem();
  const ParameterLayout layout(problem);
  ceres::Solver::Options options;
  options.function_tolerance = 1e-16;
  options.parameter_tolerance = 1e-14;
  options.max_num_iterations = 200;
  ceres::Solver::Summary summary;
  Vector plain = layout.Free(layout.InitialValues());
  Matrix starts = Matrix::Zero(4, 4);
  for (const double gap_sigma : {1e-1, 1e-3, 1e-5, 1e-6}) {
    SolvePlainProblem(problem, gap_sigma, options, &starts, &plain, &summary);
    EXPECT_TRUE(summary.IsSolutionUsable()) << summary.FullReport();
  }
  const double plain_cost = summary.final_cost;

  std::string error;
  auto cost =
      TrajectoryCost::Create(problem, TrajectoryCost::Options(), &error);
  ASSERT_NE(cost, nullptr) << error;
  Vector condensed = cost->InitialValues();
  ceres::Problem condensed_problem;
  condensed_problem.AddResidualBlock(cost.release(), nullptr, condensed.data());
  ceres::Solve(options, &condensed_problem, &summary);
  EXPECT_TRUE(summary.IsSolutionUsable()) << summary.FullReport();

  EXPECT_NEAR(plain_cost, summary.final_cost, 1e-6 * plain_cost);
  EXPECT_LT((plain - condensed).norm(), 1e-6);
  EXPECT_LT((condensed - Eigen::Vector2d(0.1, -0.05)).norm(), 0.05);
}

}  // namespace
}  // namespace pinode
