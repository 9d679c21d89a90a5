#include "pinode/study/explanations/block_estimates.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "pinode/problem/parameter_layout.h"
#include "pinode/study/identify/identify.h"
#include "pinode/study/terms/term_worth.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

// Two records of three floors, each of a structure of its own.
IdentificationProblem TwoRecords(const Vector& first, const Vector& second) {
  IdentificationProblem problem = MeasuredChain(3, *ChainAt(first), 7);
  IdentificationProblem other = MeasuredChain(3, *ChainAt(second), 8);
  other.records[0].name = "later";
  problem.records.push_back(other.records[0]);
  return problem;
}

BlockEstimates BlocksOf(const Identification& found) {
  BlockEstimates estimates;
  EXPECT_TRUE(
      EstimateBlocks(found.problem, found.summary, found.model, 1, &estimates));
  return estimates;
}

TEST(BlockEstimates, TogetherAreTheFit) {
  const Vector truth{{0.1, -0.2, 0.0}};
  const Identification found = Identify(MeasuredChain(3, *ChainAt(truth), 7),
                                        IdentificationOptions(), {}, nullptr);
  const BlockEstimates estimates = BlocksOf(found);
  ASSERT_THAT(estimates.blocks, SizeIs(4));
  double level = 0.0;
  Eigen::Index end = 0;
  for (const BlockEstimate& estimate : estimates.blocks) {
    EXPECT_EQ(estimate.block.begin, end);
    end = estimate.block.end;
    level += estimate.block.level * estimate.block.level *
             static_cast<double>(end - estimate.block.begin);
    for (Eigen::Index j = 0; j < 3; ++j) {
      EXPECT_GT(estimate.deviations[j], estimates.deviations[j]);
      EXPECT_LT(std::abs(estimate.shifts[j]), 4.0 * estimate.deviations[j]);
    }
  }
  const Eigen::Index n = found.problem.records[0].num_samples();
  EXPECT_EQ(end, n);
  EXPECT_NEAR(level / static_cast<double>(n), 1.0, 1e-9);
  // Information adds up; what a block tells apart the others do too.
  for (Eigen::Index j = 0; j < 3; ++j) {
    double information = 0.0;
    for (const BlockEstimate& estimate : estimates.blocks) {
      information += std::pow(estimate.deviations[j], -2);
    }
    EXPECT_LT(information, 1.001 * std::pow(estimates.deviations[j], -2));
    EXPECT_GT(information, 0.1 * std::pow(estimates.deviations[j], -2));
  }
  EXPECT_THAT(CheckBlocks(estimates, found.summary, found.problem), IsEmpty());
}

TEST(BlockEstimates, ContradictAFitToTwoStructures) {
  const Vector first{{0.1, -0.2, 0.0}};
  const Vector second{{0.1, 0.0, 0.0}};
  const Identification found =
      Identify(TwoRecords(first, second), IdentificationOptions(), {}, nullptr);
  const BlockEstimates estimates = BlocksOf(found);
  ASSERT_THAT(estimates.blocks, SizeIs(4));
  const std::vector<Finding> findings =
      CheckBlocks(estimates, found.summary, found.problem);
  ASSERT_THAT(findings, SizeIs(1));
  EXPECT_EQ(findings[0].check, "block_contradicts");
  EXPECT_EQ(findings[0].grade, Grade::kWithCare);
  EXPECT_NE(found.summary.verdict.grade(), Grade::kGood);

  std::vector<ExplainedValue> intervals;
  for (const ParameterEstimate& own : found.summary.parameters) {
    const double half = own.half_width95;
    intervals.push_back(
        {own.name, own.value, own.value - half, own.value + half});
  }
  WidenByBlocks(estimates, found.summary, found.problem, &intervals);
  const ParameterLayout layout(found.problem);
  for (size_t i = 0; i < intervals.size(); ++i) {
    const auto j =
        static_cast<Eigen::Index>(layout.FreeIndex(intervals[i].name));
    ASSERT_GE(j, 0);
    if (j != 1) continue;
    // One step from between the two structures, at about -0.1, goes at least a
    // part of the way to each.
    EXPECT_LT(intervals[i].lower95, -0.17);
    EXPECT_GT(intervals[i].upper95, -0.06);
  }
}

// All blocks lie on one side of the fit, so that none widens the other side.
// Their scatter does: three deviations of the mean of four, by Student's t, and
// nothing where the blocks agree.
TEST(BlockEstimates, ScatterOfBlocksWidensBothSides) {
  const Vector truth{{0.1, -0.2, 0.0}};
  const Identification found =
      Identify(TwoRecords(truth, truth), IdentificationOptions(), {}, nullptr);
  BlockEstimates estimates = BlocksOf(found);
  ASSERT_THAT(estimates.blocks, SizeIs(4));
  const Eigen::Index j = ParameterLayout(found.problem).FreeIndex("k2");
  ASSERT_GE(j, 0);
  const double value = FindEstimate(found.summary, "k2")->value;
  const auto widened = [&](const Vector& shifts) {
    for (size_t b = 0; b < 4; ++b) {
      estimates.blocks[b].shifts[j] = shifts[static_cast<Eigen::Index>(b)];
      estimates.blocks[b].deviations[j] = 0.001;
    }
    std::vector<ExplainedValue> intervals = {{"k2", value, value, value}};
    WidenByBlocks(estimates, found.summary, found.problem, &intervals);
    return intervals[0];
  };
  const ExplainedValue scattered = widened(Vector{{0.1, 0.2, 0.3, 0.4}});
  const double mean_deviation = std::sqrt(0.05 / 3.0 / 4.0);
  EXPECT_NEAR(value - scattered.lower95, 3.18 * mean_deviation, 0.01);
  EXPECT_GT(scattered.upper95 - value, 0.39);
  const ExplainedValue alike = widened(Vector{{5e-4, -5e-4, 5e-4, -5e-4}});
  EXPECT_DOUBLE_EQ(alike.lower95, value);
  EXPECT_DOUBLE_EQ(alike.upper95, value);
}

TEST(BlockEstimates, ShortRecordsHaveNone) {
  IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector{{0.1, -0.2, 0.0}}), 7);
  FitSummary fit;
  fit.records.resize(1);
  fit.records[0].prediction = Matrix::Ones(3, 300);
  EXPECT_THAT(CutIntoBlocks(problem, fit), IsEmpty());
}

}  // namespace
}  // namespace pinode
