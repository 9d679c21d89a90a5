#include "pinode/base/double_double.h"

#include <cmath>

#include "gtest/gtest.h"

namespace pinode {
namespace {

// Largest relative error of one operation.
constexpr double kRounding = 1e-30;

void ExpectSmall(const DoubleDouble& rest, double size) {
  EXPECT_LE(std::abs(rest.Rounded()), kRounding * size);
}

TEST(DoubleDoubleTest, SumsAndProductsOfDoublesAreExact) {
  // 1 + 2^-80 and (1 + 2^-40)^2 = 1 + 2^-39 + 2^-80.
  const DoubleDouble sum = ExactSum(1.0, std::ldexp(1.0, -80));
  EXPECT_EQ(sum.high, 1.0);
  EXPECT_EQ(sum.low, std::ldexp(1.0, -80));
  const double a = 1.0 + std::ldexp(1.0, -40);
  const DoubleDouble square = ExactProduct(a, a);
  EXPECT_EQ(square.high, 1.0 + std::ldexp(1.0, -39));
  EXPECT_EQ(square.low, std::ldexp(1.0, -80));
}

TEST(DoubleDoubleTest, QuotientsAndRootsInvertProducts) {
  for (const double number : {1.0 / 3.0, 7.0, 1e-12, 3.3e14}) {
    // A number whose low part is not zero.
    const DoubleDouble a =
        ExactProduct(number, 1.7) + DoubleDouble{number * 1e-20, 0.0};
    const DoubleDouble third = a / DoubleDouble{3.0, 0.0};
    ExpectSmall(third * 3.0 - a, number);
    ExpectSmall(third + third + third - a, number);
    const DoubleDouble root = SquareRoot(a);
    ExpectSmall(root * root - a, number);
  }
}

// (1e14 + 1) (1e14 - 1) = 1e28 - 1, of which a double keeps nothing of the 1.
TEST(DoubleDoubleTest, KeepsWhatCancels) {
  const DoubleDouble big = ExactProduct(1e7, 1e7);
  const DoubleDouble one = {1.0, 0.0};
  const DoubleDouble rest = (big + one) * (big - one) - big * big;
  EXPECT_EQ(rest.Rounded(), -1.0);
}

}  // namespace
}  // namespace pinode
