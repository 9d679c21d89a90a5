#include "pinode/estimate/start/time_scale.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pinode/estimate/certainty/assessment.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Two storeys of 0.98 and 2.58 Hz under ground motion, their true record of 600
// samples with its times multiplied by `factor`.
IdentificationProblem ProblemWithTimes(double factor) {
  IdentificationProblem problem;
  problem.dynamics = testing::MakeGroupedChain(2, 100.0, 0.5);
  IdentificationRecord record =
      testing::MakeExcitedRecord(*problem.dynamics, 600, 0.02);
  record.name = "quake";
  record.start = IdentificationRecord::Start::kRest;
  record.substeps = 4;
  record.integrator = Integrator::kExact;
  for (int i = 0; i < 2; ++i) {
    record.channels.push_back(testing::MakeChannel(
        "a" + std::to_string(i + 1), Quantity::kAbsoluteAcceleration, 2, i));
  }
  Vector truth = problem.dynamics->Parameters();
  truth[0] = -0.1;
  testing::Simulate(*problem.dynamics, truth, Vector::Zero(4), 0.01, 1,
                    &record);
  const Excitation as_it_was = *record.excitation;
  record.excitation.emplace(0.0, 0.02 * factor, as_it_was.samples(),
                            as_it_was.interpolation());
  problem.records.push_back(std::move(record));
  return problem;
}

TEST(TimeScale, RefusesDaysReadAsSeconds) {
  const IdentificationProblem problem = ProblemWithTimes(1.0 / 86400.0);
  const auto refusal =
      AllOf(HasSubstr("record 'quake' lasts 0.00036 periods of the model's "
                      "fastest mode (2.575 Hz)"),
            HasSubstr("read in s (time_unit: s, ms or us), but are probably "
                      "in days"));
  std::string error;
  EXPECT_FALSE(IsTimeScalePossible(problem, &error));
  EXPECT_THAT(error, refusal);
  error.clear();
  ProblemAssessment assessment;
  EXPECT_FALSE(
      AssessProblem(problem, IdentificationOptions(), &assessment, &error));
  EXPECT_THAT(error, refusal);
  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(problem, IdentificationOptions(), nullptr, &summary,
                       &model);
  EXPECT_EQ(summary.termination, Termination::kFailure);
  EXPECT_THAT(summary.message, refusal);
}

TEST(TimeScale, NamesMillisecondsReadAsSeconds) {
  const IdentificationProblem problem = ProblemWithTimes(1000.0);
  std::string error;
  EXPECT_TRUE(IsTimeScalePossible(problem, &error)) << error;
  const auto remarks =
      ElementsAre(AllOf(HasSubstr("'quake': one sampling step is 20 periods"),
                        HasSubstr("Check whether they are in milliseconds.")));
  EXPECT_THAT(TimeScaleRemarks(problem), remarks);
  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(problem, IdentificationOptions(), nullptr, &summary,
                       &model);
  EXPECT_THAT(summary.remarks, ::testing::Contains(HasSubstr("milliseconds")));
}

// A tenth of a second of a blow, the true record, and a test by hand.
TEST(TimeScale, LeavesWhatCanBeMeant) {
  for (const double factor : {0.01, 1.0, 50.0}) {
    const IdentificationProblem problem = ProblemWithTimes(factor);
    std::string error;
    EXPECT_TRUE(IsTimeScalePossible(problem, &error)) << error;
    EXPECT_THAT(TimeScaleRemarks(problem), IsEmpty()) << factor;
  }
}

// Short against the slowest mode alone, and what says less of how fast it is.
TEST(TimeScale, RefusesOnlyWhatIsBeyondDoubt) {
  IdentificationProblem problem = ProblemWithTimes(0.005);
  std::string error;
  EXPECT_TRUE(IsTimeScalePossible(problem, &error)) << error;
  EXPECT_THAT(TimeScaleRemarks(problem),
              ElementsAre(HasSubstr("periods of the model's slowest elastic")));

  problem = ProblemWithTimes(1.0 / 86400.0);
  auto dynamics = std::make_shared<StructuralDynamics>(*problem.dynamics);
  ASSERT_TRUE(dynamics->AddLaw(
      testing::MakeElement("spring", "cubic", 2, Feature::kGround, 0, {1.0}),
      &error))
      << error;
  problem.dynamics = dynamics;
  EXPECT_TRUE(IsTimeScalePossible(problem, &error)) << error;
  EXPECT_THAT(TimeScaleRemarks(problem), ElementsAre(HasSubstr("days")));

  // It is not fitted.
  problem = ProblemWithTimes(1.0 / 86400.0);
  problem.records[0].role = IdentificationRecord::Role::kHoldout;
  EXPECT_TRUE(IsTimeScalePossible(problem, &error)) << error;
}

}  // namespace
}  // namespace pinode
