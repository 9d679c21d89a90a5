#include "pinode/estimate/objective/annealing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

class AnnealingTest : public ::testing::Test {
 protected:
  AnnealingTest()
      : fit_(IdentificationRecord::Start::kRest),
        objective_(fit_.problem, *fit_.layout, MultipleShooting::Options()),
        context_{fit_.problem, options_, *fit_.layout, objective_, summary_},
        annealing_(context_) {
    state_.free = fit_.free;
    state_.sigmas = fit_.sigmas;
    state_.decays = fit_.decays;
  }

  testing::SmallFit fit_;
  IdentificationOptions options_;
  FitSummary summary_;
  Objective objective_;
  FitContext context_;
  Annealing annealing_;
  FitState state_;
};

TEST_F(AnnealingTest, NoiseComesDownToWhatHasNoMemory) {
  const double floor = 0.001;
  EXPECT_EQ(annealing_.Limit(0, 0, floor, 1.0, 0.2), 0.2) << "not begun";
  Annealing::LeftOver left;
  left.sigmas = {Vector::Constant(4, 0.5), Vector::Constant(4, 0.5)};
  // Differences of one: a mean square of a half without a memory.
  Matrix residuals(4, 31);
  for (int i = 0; i < 31; ++i) residuals.col(i).setConstant(3.0 + (i % 2));
  left.residuals = {residuals, residuals};
  annealing_.Begin(fit_.free, &left, &state_);
  ASSERT_TRUE(annealing_.HasBegun());
  const double target = 0.5 * std::sqrt(0.5);
  EXPECT_DOUBLE_EQ(annealing_.Limit(0, 0, floor, 1.0, 0.9), target);
  // Once it has been there it goes where the residuals want, up to the first
  // fit's level.
  EXPECT_EQ(annealing_.Limit(0, 0, floor, target, 0.4), 0.4);
  EXPECT_EQ(annealing_.Limit(0, 0, floor, 0.4, 0.9), 0.5);
  EXPECT_EQ(annealing_.Limit(0, 0, floor, 0.4, 0.0001), floor);
}

TEST_F(AnnealingTest, RaisesTheNoiseAndOpensTheOutputs) {
  ASSERT_TRUE(annealing_.SetFirstDecays(&state_.decays));
  annealing_.Begin(fit_.free, nullptr, &state_);
  for (int c = 0; c < 4; ++c) {
    const double spread = StandardDeviationOfPresent(
        fit_.problem.records[0].channels[static_cast<size_t>(c)].values);
    EXPECT_GE(state_.sigmas[0][c], 0.1 * spread * (1.0 - 1e-12));
  }
  using Kind = ParameterLayout::DecayGroup::Kind;
  for (int g = 0; g < fit_.layout->num_decay_groups(); ++g) {
    const bool output =
        fit_.layout->decay_groups()[static_cast<size_t>(g)].kind ==
        Kind::kOutput;
    EXPECT_DOUBLE_EQ(state_.decays[g], output ? 1e-5 : 0.1);
  }
}

}  // namespace
}  // namespace pinode
