#include "pinode/estimate/force_bands.h"

#include <gtest/gtest.h>

#include "pinode/estimate/testing.h"

namespace pinode {
namespace {

TEST(ForceBands, AreNoneWithoutForces) {
  const testing::SmallFit fit(IdentificationRecord::Start::kRest);
  EXPECT_EQ(BandDecays(fit.problem, *fit.layout, fit.decays, ForceBandTuning()),
            fit.decays);
  EXPECT_TRUE(EstimateForces(fit.problem, *fit.layout,
                             fit.layout->InitialValues(), Matrix(), 1.96)
                  .empty());
}

}  // namespace
}  // namespace pinode
