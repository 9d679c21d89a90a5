#include "pinode/estimate/certainty/assessment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

// A two-DOF chain with two stiffness groups under a ground motion.
IdentificationProblem MakeProblem() {
  auto dynamics = testing::MakeGroupedChain(2, 30.0, 0.3);
  IdentificationProblem problem;
  IdentificationRecord record =
      testing::MakeExcitedRecord(*dynamics, 200, 0.05);
  record.channels = {
      testing::MakeChannel("a1", Quantity::kAbsoluteAcceleration, 2, 0)};
  testing::Simulate(*dynamics, Vector::Zero(2), Vector::Zero(4), 0.0, 1,
                    &record);
  record.start = IdentificationRecord::Start::kRest;
  problem.records.push_back(record);
  problem.dynamics = dynamics;
  return problem;
}

ProblemAssessment Assess(const IdentificationProblem& problem) {
  ProblemAssessment assessment;
  std::string error;
  EXPECT_TRUE(
      AssessProblem(problem, IdentificationOptions(), &assessment, &error))
      << error;
  return assessment;
}

TEST(AssessProblem, NoiseCountsInProportion) {
  IdentificationProblem problem = MakeProblem();
  problem.records[0].channels[0].sigma = 0.01;
  const ProblemAssessment quiet = Assess(problem);
  ASSERT_EQ(quiet.expected.size(), 2u);
  EXPECT_EQ(quiet.num_residuals, 200);
  EXPECT_EQ(quiet.num_starts, 0);
  problem.records[0].channels[0].sigma = 0.03;
  const ProblemAssessment noisy = Assess(problem);
  for (int i = 0; i < 2; ++i) {
    const size_t k = static_cast<size_t>(i);
    EXPECT_NEAR(noisy.expected[k].sigma, 3.0 * quiet.expected[k].sigma,
                1e-6 * noisy.expected[k].sigma);
  }
}

TEST(AssessProblem, NoiseOfTheExcitationCounts) {
  IdentificationProblem problem = MakeProblem();
  problem.records[0].channels[0].sigma = 0.01;
  const ProblemAssessment exact = Assess(problem);
  problem.records[0].input_sigma = Vector::Constant(1, 1e-6);
  const ProblemAssessment nearly = Assess(problem);
  problem.records[0].input_sigma = Vector::Constant(1, 0.2);
  const ProblemAssessment noisy = Assess(problem);
  for (size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(nearly.expected[k].sigma, exact.expected[k].sigma,
                1e-4 * exact.expected[k].sigma);
    EXPECT_GT(noisy.expected[k].sigma, 2.0 * exact.expected[k].sigma);
  }
}

TEST(AssessProblem, NamesWhatTheDataCannotTell) {
  IdentificationProblem problem = MakeProblem();
  auto dynamics = testing::MakeGroupedChain(2, 30.0, 0.3);
  GroupTerm twin = dynamics->groups()[0];
  twin.group.name = twin.alpha.name = "twin";
  std::string error;
  ASSERT_TRUE(dynamics->AddGroup(twin, &error)) << error;
  problem.dynamics = dynamics;
  const ProblemAssessment assessment = Assess(problem);
  ASSERT_EQ(assessment.undetermined.size(), 1u);
  EXPECT_NE(assessment.undetermined[0].find("twin"), std::string::npos);
  ASSERT_EQ(assessment.expected.size(), 3u);
  EXPECT_TRUE(std::isinf(assessment.expected[0].sigma));
  EXPECT_TRUE(std::isfinite(assessment.expected[1].sigma));
  EXPECT_TRUE(std::isinf(assessment.expected[2].sigma));
}

}  // namespace
}  // namespace pinode
