#include "pinode/estimate/multistart.h"

#include <gtest/gtest.h>

#include "pinode/estimate/testing.h"

namespace pinode {
namespace {

TEST(Multistart, DrawsWithinBoundsAndPriors) {
  const testing::SmallFit fit(IdentificationRecord::Start::kRest);
  const Vector initial = fit.layout->InitialValues();
  const Vector one = DrawStart(fit.problem, *fit.layout, MultistartTuning(), 1);
  EXPECT_EQ(one, DrawStart(fit.problem, *fit.layout, MultistartTuning(), 1));
  const Vector two = DrawStart(fit.problem, *fit.layout, MultistartTuning(), 2);
  int drawn = 0;
  for (int i = 0; i < fit.layout->num_parameters(); ++i) {
    const Parameter& parameter = fit.layout->parameter(i);
    if (fit.layout->FreeIndex(i) < 0) {
      EXPECT_EQ(one[i], initial[i]) << parameter.name;
      continue;
    }
    EXPECT_GE(one[i], parameter.lower);
    EXPECT_LE(one[i], parameter.upper);
    drawn += one[i] != two[i] ? 1 : 0;
    if (parameter.HasPrior()) {
      EXPECT_NEAR(one[i], parameter.prior_mean, 2.0 * parameter.prior_sigma);
    }
  }
  EXPECT_GT(drawn, 5);
}

}  // namespace
}  // namespace pinode
