#include "pinode/estimate/start/stage_schedule.h"

#include <gtest/gtest.h>

#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

IdentificationProblem ThreeDofs(int samples) {
  IdentificationProblem problem;
  auto dynamics = testing::MakeGroupedChain(3, 50.0, 0.5);
  problem.records.push_back(
      testing::MakeExcitedRecord(*dynamics, samples, 0.02));
  problem.dynamics = dynamics;
  return problem;
}

// omega_1^2 = 4 k/m sin^2(pi/14): a quarter of 2 pi / 3.147 s is 25 samples.
TEST(StageSchedule, FirstSegmentsLastAQuarterPeriod) {
  IdentificationProblem problem = ThreeDofs(600);
  EXPECT_EQ(FirstSegmentSamples(problem, StageTuning()), 25);
  // A record too short for four of them.
  EXPECT_EQ(FirstSegmentSamples(ThreeDofs(60), StageTuning()), 15);
}

TEST(StageSchedule, GrowsFourfoldToTheWholeRecord) {
  const IdentificationProblem problem = ThreeDofs(600);
  IdentificationOptions options;
  EXPECT_EQ(StageLengths(problem, options, false),
            (std::vector<Eigen::Index>{25, 100, 0}));
  EXPECT_EQ(StageLengths(problem, options, true),
            (std::vector<Eigen::Index>{10, 40, 160, 0}));
  options.segment_samples = 7;
  EXPECT_EQ(StageLengths(problem, options, true),
            (std::vector<Eigen::Index>{7, 28, 112, 0}));
  options.shooting = IdentificationOptions::Shooting::kSingle;
  EXPECT_EQ(StageLengths(problem, options, false),
            std::vector<Eigen::Index>{0});
}

// Without inputs a record of more samples than an int can count takes no
// memory.
TEST(StageSchedule, GrowsToRecordsOfAnyLength) {
  IdentificationProblem problem = ThreeDofs(600);
  problem.records[0].excitation.emplace(0.0, 0.02, Matrix(0, 5000000000),
                                        Interpolation::kLinear);
  IdentificationOptions options;
  options.segment_samples = 300000000;
  EXPECT_EQ(StageLengths(problem, options, false),
            (std::vector<Eigen::Index>{300000000, 1200000000, 0}));
}

}  // namespace
}  // namespace pinode
