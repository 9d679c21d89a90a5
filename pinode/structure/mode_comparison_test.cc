#include "pinode/structure/mode_comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pinode/base/constants.h"

namespace pinode {
namespace {

StructuralModel TwoMasses(double first, double second) {
  const Matrix stiffness =
      first * SpringMatrix(2, -1, 0) + second * SpringMatrix(2, -1, 1);
  return MakeStructuralModel(Matrix::Identity(2, 2), Matrix::Zero(2, 2),
                             stiffness);
}

TEST(ModeComparison, FollowsModesThatChangePlaces) {
  // Two separate masses: the softer one is stiffened beyond the other.
  std::vector<ModePair> pairs;
  std::string error;
  ASSERT_TRUE(
      CompareModes(TwoMasses(1.0, 4.0), TwoMasses(9.0, 4.0), &pairs, &error))
      << error;
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_NEAR(pairs[0].initial_frequency, 1.0 / kTwoPi, 1e-12);
  EXPECT_NEAR(pairs[0].updated_frequency, 3.0 / kTwoPi, 1e-12);
  EXPECT_NEAR(pairs[1].updated_frequency, 2.0 / kTwoPi, 1e-12);
  EXPECT_NEAR(pairs[0].mac, 1.0, 1e-12);
  EXPECT_EQ(pairs[0].updated_mode, 1);
  EXPECT_EQ(pairs[1].updated_mode, 0);
}

}  // namespace
}  // namespace pinode
