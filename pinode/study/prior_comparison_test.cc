#include "pinode/study/prior_comparison.h"

#include <cmath>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/estimate/parameter_layout.h"
#include "pinode/estimate/testing.h"

namespace pinode {
namespace {

TEST(PriorComparisonTest, RunsThePriorModelAndPairsModes) {
  const testing::SmallFit fit(IdentificationRecord::Start::kRest);
  IdentificationSummary summary;
  summary.records.resize(1);
  IdentifiedModel model;
  model.parameters = fit.layout->InitialValues();
  const PriorComparison same = CompareWithPrior(fit.problem, summary, model);
  // Of what was scored.
  ASSERT_EQ(same.predictions.size(), 2u);
  EXPECT_EQ(same.predictions[0].rows(), 4);
  EXPECT_EQ(same.predictions[0].cols(), 31);
  EXPECT_EQ(same.predictions[1].size(), 0);
  ASSERT_EQ(same.modes.size(), 2u);
  EXPECT_EQ(same.why_no_modes, "");
  for (const ModePair& mode : same.modes) {
    EXPECT_NEAR(mode.mac, 1.0, 1e-12);
    EXPECT_NEAR(mode.updated_frequency, mode.initial_frequency, 1e-12);
  }
  model.parameters[0] += 0.2;
  const PriorComparison stiffer = CompareWithPrior(fit.problem, summary, model);
  EXPECT_EQ(stiffer.predictions[0], same.predictions[0]);
  EXPECT_GT(stiffer.modes[0].updated_frequency,
            stiffer.modes[0].initial_frequency);
}

TEST(PriorComparisonTest, LeavesOutWhatIsNotThere) {
  testing::SmallFit fit(IdentificationRecord::Start::kRest);
  // No model; and noise levels of another problem.
  IdentifiedModel model;
  model.sigmas = {Vector::Ones(7)};
  IdentificationSummary summary;
  summary.records.resize(2);
  PriorComparison comparison = CompareWithPrior(fit.problem, summary, model);
  EXPECT_EQ(comparison.predictions[1].cols(), 24);
  EXPECT_TRUE(comparison.modes.empty());
  fit.problem.records[0].substeps = 0;
  comparison = CompareWithPrior(fit.problem, summary, model);
  EXPECT_TRUE(comparison.predictions.empty());
  EXPECT_THAT(comparison.why_no_modes, ::testing::HasSubstr("PrepareProblem"));
}

}  // namespace
}  // namespace pinode
