#include "pinode/estimate/fit/modal_outcome.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// A chain of three with a free factor of its damping, and one record.
IdentificationProblem ChainWithDampingGroup() {
  const std::shared_ptr<StructuralDynamics> dynamics =
      testing::MakeGroupedChain(3, 100.0, 0.5);
  GroupTerm damping;
  damping.group.name = "c";
  damping.group.target = MatrixGroup::Target::kDamping;
  damping.group.matrix = dynamics->model().damping;
  damping.alpha.free = true;
  std::string error;
  EXPECT_TRUE(dynamics->AddGroup(damping, &error)) << error;
  IdentificationProblem problem;
  problem.dynamics = dynamics;
  IdentificationRecord record =
      testing::MakeExcitedRecord(*dynamics, 400, 0.05);
  problem.records.push_back(std::move(record));
  return problem;
}

TEST(ModalOutcome, NamesWhatTheMatricesLetGrow) {
  const IdentificationProblem problem = ChainWithDampingGroup();
  Vector parameters = problem.dynamics->Parameters();
  FitSummary summary;
  ReportGrowingMotion(problem, parameters, &summary);
  EXPECT_EQ(summary.growing_motion, "");
  // The factor is 1 + c: all modes are negatively damped.
  parameters[parameters.size() - 1] = -2.0;
  ReportGrowingMotion(problem, parameters, &summary);
  EXPECT_THAT(summary.growing_motion,
              HasSubstr("Hz has negative damping in the identified matrices"));
  EXPECT_THAT(summary.growing_motion_advice, HasSubstr("'lower' bound"));
}

TEST(ModalOutcome, KnowsNegativeStiffness) {
  const IdentificationProblem problem = ChainWithDampingGroup();
  Vector parameters = problem.dynamics->Parameters();
  FitSummary summary;
  parameters[0] = -1.5;
  ReportGrowingMotion(problem, parameters, &summary);
  EXPECT_THAT(summary.growing_motion, HasSubstr("has negative stiffness"));
}

}  // namespace
}  // namespace pinode
