#include "pinode/estimate/objective/evidence.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

// Against the formulas with an inverse that is written out.
TEST(Evidence, CountsWhatTheDataDetermine) {
  const testing::SmallFit fit(IdentificationRecord::Start::kRest);
  const ParameterLayout& layout = *fit.layout;
  const auto objective = fit.Shoot(0, MultipleShooting::Options());
  CondensedSystem system;
  ASSERT_TRUE(objective->Linearize(fit.free, &system));
  Evidence evidence;
  ASSERT_TRUE(
      MeasureEvidence(layout, system.hessian, fit.decays, fit.free, &evidence));
  const Matrix inverse = system.hessian.inverse();
  double effective = layout.num_free();
  Vector squares = Vector::Zero(layout.num_decay_groups());
  Vector determined = squares;
  for (int j = 0; j < layout.num_free(); ++j) {
    const int index = layout.free()[static_cast<size_t>(j)];
    const Parameter& parameter = layout.parameter(index);
    if (parameter.HasPrior()) {
      effective -=
          inverse(j, j) / (parameter.prior_sigma * parameter.prior_sigma);
    }
    const int group = layout.DecayGroupOf(index);
    if (group < 0) continue;
    effective -= fit.decays[group] * inverse(j, j);
    determined[group] += 1.0 - fit.decays[group] * inverse(j, j);
    squares[group] += fit.free[j] * fit.free[j];
  }
  EXPECT_GT(effective, 1.0);
  EXPECT_LT(effective, layout.num_free());
  EXPECT_NEAR(evidence.effective, effective, 1e-6);
  EXPECT_LT((evidence.determined - determined).norm(), 1e-6);
  EXPECT_LT((evidence.squares - squares).norm(), 1e-12);
}

TEST(Evidence, MovesDecaysByMacKaysRuleWithinLimits) {
  const testing::SmallFit fit(IdentificationRecord::Start::kRest);
  const ParameterLayout& layout = *fit.layout;
  const int groups = layout.num_decay_groups();
  ASSERT_GT(groups, 2);
  const EvidenceTuning tuning;
  Evidence evidence;
  evidence.determined = Vector::Constant(groups, 2.0);
  evidence.squares = Vector::Constant(groups, 0.5);
  evidence.squares[1] = 1e-9;  // idle: no more than a hundredfold at once
  Vector decays = FirstDecays(layout, tuning, nullptr);
  EXPECT_EQ(decays, Vector::Constant(groups, tuning.first_decay));
  UpdateDecays(layout, tuning, evidence, &decays);
  EXPECT_DOUBLE_EQ(decays[0], 4.0);
  EXPECT_DOUBLE_EQ(decays[1], 100.0 * tuning.first_decay);
  for (int i = 0; i < 9; ++i) {
    UpdateDecays(layout, tuning, evidence, &decays);
  }
  EXPECT_EQ(decays[1], tuning.most_decay);
  // Decays of an earlier fit are taken over.
  IdentifiedModel initial;
  initial.decays = decays;
  EXPECT_EQ(FirstDecays(layout, tuning, &initial), decays);
}

}  // namespace
}  // namespace pinode
