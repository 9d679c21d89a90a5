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

// A segment's residuals are those that Create makes of the same samples.
TEST(SegmentCost, AddRecordCutsARecord) {
  IdentificationProblem problem = ChainProblem();
  const ParameterLayout layout(problem);
  Vector free = layout.Free(layout.InitialValues());
  SegmentCost::Options options;
  std::string error;
  Matrix starts;
  ceres::Problem ceres_problem;
  // 80 intervals: four segments of 18, and one of 8.
  ASSERT_TRUE(SegmentCost::AddRecord(problem, 0, 18, options, free.data(),
                                     &starts, &ceres_problem, &error))
      << error;
  ASSERT_EQ(starts.rows(), 4);
  ASSERT_EQ(starts.cols(), 5);
  EXPECT_EQ(ceres_problem.NumResidualBlocks(), 5);
  EXPECT_EQ(ceres_problem.NumParameterBlocks(), 6);
  // At rest; then x1, which a channel shows, and nothing else.
  EXPECT_TRUE(ceres_problem.IsParameterBlockConstant(starts.data()));
  EXPECT_FALSE(ceres_problem.IsParameterBlockConstant(starts.col(1).data()));
  EXPECT_EQ(starts.col(0), Vector(Vector::Zero(4)));
  EXPECT_EQ(starts.col(2), Vector(problem.records[0].channels[0].values[36] *
                                  Vector::Unit(4, 0)));

  std::vector<ceres::ResidualBlockId> blocks;
  ceres_problem.GetResidualBlocks(&blocks);
  for (int k = 0; k < 5; ++k) {
    const auto alone = SegmentCost::Create(
        problem, 0, 18 * k, std::min(80, 18 * (k + 1)), options, &error);
    ASSERT_NE(alone, nullptr) << error;
    std::vector<const double*> values = {starts.col(k).data()};
    if (k < 4) values.push_back(starts.col(k + 1).data());
    values.push_back(free.data());
    Vector expected(alone->num_residuals());
    ASSERT_TRUE(alone->Evaluate(values.data(), expected.data(), nullptr));
    double cost = 0.0;
    ASSERT_TRUE(ceres_problem.EvaluateResidualBlock(
        blocks[static_cast<size_t>(k)], false, &cost, nullptr, nullptr));
    EXPECT_NEAR(cost, 0.5 * expected.squaredNorm(), 1e-12 * cost) << k;
  }
}

TEST(SegmentCost, AddRecordTakesStartsThatAreKnownOrMeasured) {
  IdentificationProblem problem = ChainProblem();
  IdentificationRecord& record = problem.records[0];
  const Vector known = Eigen::Vector4d(0.1, 0.2, 0.3, 0.4);
  record.start = Start::kKnown;
  record.known_start = known;
  // A velocity of DOF 2, its sign turned, its sample 20 missing; a drift, which
  // is of no single DOF.
  record.channels[1].observation.quantity = Quantity::kVelocity;
  record.channels[1].observation.weights = -Vector::Unit(2, 1);
  record.channels[1].values.setConstant(0.5);
  record.channels[1].values[20] = std::nan("");
  record.channels.push_back(record.channels[0]);
  record.channels[2].observation.weights = Eigen::Vector2d(-1.0, 1.0);
  const ParameterLayout layout(problem);
  Vector free = layout.Free(layout.InitialValues());
  std::string error;
  Matrix starts;
  ceres::Problem at_known, at_measured;
  const SegmentCost::Options options;
  ASSERT_TRUE(SegmentCost::AddRecord(problem, 0, 20, options, free.data(),
                                     &starts, &at_known, &error))
      << error;
  const double x1 = record.channels[0].values[40];
  EXPECT_TRUE(at_known.IsParameterBlockConstant(starts.data()));
  EXPECT_EQ(starts.col(0), known);
  EXPECT_EQ(starts(3, 1), 0.0);
  EXPECT_EQ(starts.col(2), Vector(Eigen::Vector4d(x1, 0.0, 0.0, -0.5)));

  record.start = Start::kFree;
  Matrix free_starts;
  ASSERT_TRUE(SegmentCost::AddRecord(problem, 0, 20, options, free.data(),
                                     &free_starts, &at_measured, &error))
      << error;
  EXPECT_FALSE(at_measured.IsParameterBlockConstant(free_starts.data()));
  EXPECT_EQ(free_starts(3, 0), -0.5);
}

TEST(SegmentCost, AddRecordRefusesAndAddsNothing) {
  const IdentificationProblem problem = ChainProblem();
  const ParameterLayout layout(problem);
  Vector free = layout.Free(layout.InitialValues());
  ceres::Problem ceres_problem;
  Matrix starts;
  const auto refused = [&](int record, int length,
                           const SegmentCost::Options& options) {
    std::string error;
    EXPECT_FALSE(SegmentCost::AddRecord(problem, record, length, options,
                                        free.data(), &starts, &ceres_problem,
                                        &error));
    return error;
  };
  EXPECT_EQ(refused(1, 20, {}), "there is no record 1 among 1");
  EXPECT_EQ(refused(0, 0, {}),
            "record 'r': segments of 0 samples, expected at least 1");
  SegmentCost::Options options;
  options.sigmas = Vector::Ones(3);
  EXPECT_EQ(refused(0, 20, options),
            "record 'r': its sigmas must be 2 positive numbers, one per "
            "channel");
  EXPECT_EQ(ceres_problem.NumResidualBlocks(), 0);
}

}  // namespace
}  // namespace pinode
