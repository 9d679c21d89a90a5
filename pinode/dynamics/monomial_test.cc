#include "pinode/dynamics/monomial.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace pinode {
namespace {

// -3 x^2 |y| y, from its parts.
Monomial SomeMonomial() {
  Monomial result = Monomial::Feature(0);
  EXPECT_TRUE(result.Raise(2));
  Monomial y = Monomial::Feature(1);
  Monomial absolute = y;
  absolute.TakeAbsolute();
  EXPECT_TRUE(y.Multiply(absolute));
  EXPECT_TRUE(result.Multiply(y));
  EXPECT_TRUE(result.Multiply(Monomial::Number(3.0)));
  result.Negate();
  return result;
}

TEST(Monomial, HasTheValueAndSlopesWorkedOutByHand) {
  const Monomial example = SomeMonomial();
  for (const double x : {-1.3, 0.0, 0.7}) {
    for (const double y : {-2.1, 0.0, 0.4}) {
      const std::array<double, 2> q = {x, y};
      const double value = -3.0 * x * x * std::abs(y) * y;
      EXPECT_NEAR(example.Evaluate(q.data()), value, 1e-14);
      // Linearize adds to existing values.
      std::array<double, 2> gradient = {1.0, 2.0};
      EXPECT_NEAR(example.Linearize(q.data(), gradient.data()), value, 1e-14);
      EXPECT_NEAR(gradient[0], 1.0 - 6.0 * x * std::abs(y) * y, 1e-13);
      EXPECT_NEAR(gradient[1], 2.0 - 6.0 * x * x * std::abs(y), 1e-13);
    }
  }
}

TEST(Monomial, AbsoluteValuesOfProductsAndNumbers) {
  Monomial product = SomeMonomial();
  product.TakeAbsolute();
  const std::array<double, 2> q = {-0.5, -2.0};
  EXPECT_DOUBLE_EQ(product.Evaluate(q.data()), 3.0 * 0.25 * 4.0);
  EXPECT_FALSE(product.IsNumber());
  Monomial number = Monomial::Number(-2.0);
  number.TakeAbsolute();
  EXPECT_TRUE(number.IsNumber());
  EXPECT_EQ(number.coefficient(), 2.0);
}

TEST(Monomial, RefusesWhatIsNone) {
  EXPECT_FALSE(Monomial::Feature(0).Raise(0));
  EXPECT_FALSE(Monomial::Feature(0).Raise(-1));
  EXPECT_FALSE(Monomial::Feature(0).Raise(1000));
  Monomial many = Monomial::Number(1.0);
  bool fits = true;
  for (int i = 0; i <= Monomial::kMaxFactors; ++i) {
    EXPECT_TRUE(fits) << i;
    fits = many.Multiply(Monomial::Feature(i));
  }
  EXPECT_FALSE(fits);
}

}  // namespace
}  // namespace pinode
