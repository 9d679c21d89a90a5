#include "pinode/base/stable_norm.h"

#include <cmath>
#include <limits>

#include "gtest/gtest.h"

namespace pinode {
namespace {

Vector Two(double first, double second) {
  Vector vector(2);
  vector << first, second;
  return vector;
}

TEST(StableNormTest, HoldsInAnyUnit) {
  for (const double unit : {1.0, 0x1p-1000, 0x1p1000}) {
    EXPECT_DOUBLE_EQ(StableNorm(unit * Two(3.0, -4.0)), 5.0 * unit);
    const Vector one = StableUnit(unit * Two(3.0, -4.0));
    EXPECT_DOUBLE_EQ(one[0], 0.6);
    EXPECT_DOUBLE_EQ(one[1], -0.8);
  }
}

TEST(StableNormTest, ShapesOfAnyLengthHaveUnitLength) {
  for (const int size : {1, 2, 3, 5, 31, 72, 4097}) {
    const Vector shape = Vector::LinSpaced(size, 1e-200, 3e-200);
    EXPECT_NEAR(StableUnit(shape).norm(), 1.0, 1e-14) << size;
  }
}

TEST(StableNormTest, NothingStaysNothing) {
  EXPECT_EQ(StableNorm(Vector()), 0.0);
  EXPECT_EQ(StableNorm(Vector::Zero(3)), 0.0);
  EXPECT_EQ(StableUnit(Vector::Zero(3)), Vector::Zero(3));
}

TEST(StableNormTest, WhatIsNotFiniteShows) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(StableNorm(Two(1.0, infinity)), infinity);
  EXPECT_TRUE(std::isnan(StableNorm(Two(1.0, std::nan("")))));
}

}  // namespace
}  // namespace pinode
