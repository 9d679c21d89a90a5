#include "pinode/estimate/shooting/gap_penalty.h"

#include <gtest/gtest.h>

#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

// The force is the cost's derivative by the segment's end.
TEST(GapPenalty, ForceIsTheSlopeOfTheCost) {
  GapPenalty penalty(2, 3);
  penalty.set_scales(Eigen::Vector2d(0.5, 4.0));
  Matrix ends = Matrix::Random(2, 3);
  const Matrix starts = Matrix::Random(2, 3);
  penalty.UpdateMultipliers(ends, starts);
  for (int gap = 0; gap < 2; ++gap) {
    const Vector force = penalty.Force(7.0, ends, starts, gap);
    for (int i = 0; i < 2; ++i) {
      const auto moved = [&](double h) {
        Matrix other = ends;
        other(i, gap) += h;
        return Vector::Constant(1, penalty.Cost(7.0, other, starts));
      };
      EXPECT_NEAR(testing::Differentiate(moved, 1e-2)[0], force[i], 1e-9);
    }
  }
}

TEST(GapPenalty, MultipliersGatherScaledGaps) {
  GapPenalty penalty(1, 2);
  penalty.set_scales(Vector::Constant(1, 2.0));
  const Matrix ends = Matrix::Constant(1, 2, 3.0);
  const Matrix starts = Matrix::Constant(1, 2, 1.0);
  EXPECT_DOUBLE_EQ(penalty.LargestGap(ends, starts), 1.0);
  EXPECT_DOUBLE_EQ(penalty.Cost(10.0, ends, starts), 5.0);
  penalty.UpdateMultipliers(ends, starts);
  EXPECT_DOUBLE_EQ(penalty.Cost(10.0, ends, starts), 20.0);
  // With twice the penalty and half the multiplier the force of a closed gap
  // is what it was.
  const double before = penalty.Force(10.0, starts, starts, 0)[0];
  penalty.RescaleMultipliers(0.5);
  EXPECT_DOUBLE_EQ(penalty.Force(20.0, starts, starts, 0)[0], before);
  penalty.ResetMultipliers(1);
  EXPECT_EQ(penalty.LargestGap(ends, starts), 0.0);
}

}  // namespace
}  // namespace pinode
