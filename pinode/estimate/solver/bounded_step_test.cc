#include "pinode/estimate/solver/bounded_step.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pinode/base/constants.h"
#include "tests/support/gaussian_testing.h"

namespace pinode {
namespace {

// At the minimum the slope is zero, or points out of the box (Karush, Kuhn and
// Tucker); H is positive definite, so there is no other such point.
TEST(BoundedStep, MeetsTheOptimalityConditions) {
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    testing::Gaussian random(seed);
    const int n = 1 + static_cast<int>(seed % 12);
    const Matrix root = random.Draw(n + 2, n);
    // Unknowns of very different sizes.
    Vector size(n);
    for (double& s : size) s = std::pow(10.0, 3.0 * random.Next());
    const Matrix hessian =
        size.asDiagonal() * root.transpose() * root * size.asDiagonal();
    const Vector gradient = 5.0 * size.cwiseProduct(random.Draw(n));
    Vector lower(n), upper(n);
    for (int j = 0; j < n; ++j) {
      // Some at a bound to begin with, some without one.
      lower[j] = j % 4 == 0 ? 0.0 : -std::abs(random.Next()) / size[j];
      upper[j] = j % 5 == 1 ? kInfinity : std::abs(random.Next()) / size[j];
    }
    Vector step;
    ASSERT_TRUE(BoundedStep(hessian, gradient, lower, upper, &step));
    const Vector slope = (gradient + hessian * step).cwiseQuotient(size);
    const double none = 1e-8 * gradient.cwiseQuotient(size).norm();
    for (int j = 0; j < n; ++j) {
      EXPECT_GE(step[j], lower[j]);
      EXPECT_LE(step[j], upper[j]);
      EXPECT_TRUE(step[j] == lower[j] || slope[j] < none) << j;
      EXPECT_TRUE(step[j] == upper[j] || slope[j] > -none) << j;
    }
  }
}

TEST(BoundedStep, LeavesWhatHasNoEffectAndBearsRounding) {
  // Two unknowns of which the sum alone matters, and one that does not.
  Matrix hessian = Matrix::Zero(3, 3);
  hessian.topLeftCorner(2, 2).setOnes();
  Vector gradient(3);
  gradient << -1.0, -1.0, 0.0;
  const Vector bound = Vector::Constant(3, 10.0);
  Vector step;
  ASSERT_TRUE(BoundedStep(hessian, gradient, -bound, bound, &step));
  EXPECT_NEAR(step[0] + step[1], 1.0, 1e-9);
  EXPECT_EQ(step[2], 0.0);
  gradient[0] = kNaN;
  EXPECT_FALSE(BoundedStep(hessian, gradient, -bound, bound, &step));
}

}  // namespace
}  // namespace pinode
