#include "pinode/estimate/condensed_cost.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pinode/estimate/testing.h"

namespace pinode {
namespace {

using RowMajorMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

TEST(CondensedCost, KeepsCostGradientAndHessian) {
  for (int segment_samples : {0, 7}) {
    const testing::SmallFit fit(IdentificationRecord::Start::kFree);
    auto shooting = fit.Shoot(segment_samples, MultipleShooting::Options());
    CondensedSystem system;
    ASSERT_TRUE(shooting->Linearize(fit.free, &system));

    const int n = static_cast<int>(fit.free.size());
    CondensedCost cost(shooting.get(), n);
    ASSERT_EQ(cost.num_residuals(), n + 1);
    Vector residual(n + 1);
    RowMajorMatrix jacobian(n + 1, n);
    const double* parameters[] = {fit.free.data()};
    double* jacobians[] = {jacobian.data()};
    ASSERT_TRUE(cost.Evaluate(parameters, residual.data(), jacobians));
    EXPECT_NEAR(0.5 * residual.squaredNorm(), system.cost, 1e-12 * system.cost);
    EXPECT_LT((jacobian.transpose() * residual - system.gradient).norm(),
              1e-10 * system.gradient.norm());
    EXPECT_LT((jacobian.transpose() * jacobian - system.hessian).norm(),
              1e-11 * system.hessian.norm());

    Vector alone(n + 1);
    ASSERT_TRUE(cost.Evaluate(parameters, alone.data(), nullptr));
    EXPECT_NEAR(0.5 * alone.squaredNorm(), system.cost, 1e-12 * system.cost);
    EXPECT_EQ(cost.failed_evaluations(), 0);
    EXPECT_GT(cost.jacobian_seconds(), 0.0);

    // Parameters that are not finite are a failed evaluation, not a crash.
    const Vector nan =
        Vector::Constant(n, std::numeric_limits<double>::quiet_NaN());
    const double* bad[] = {nan.data()};
    EXPECT_FALSE(cost.Evaluate(bad, residual.data(), jacobians));
    EXPECT_EQ(cost.failed_evaluations(), 1);
  }
}

TEST(SquareRoot, ReproducesAWellConditionedMatrix) {
  const Matrix half = Matrix::Random(6, 4);
  const Matrix hessian = half.transpose() * half;
  Matrix root;
  ASSERT_TRUE(SquareRoot(hessian, &root));
  EXPECT_TRUE(root.isUpperTriangular());
  EXPECT_LT((root.transpose() * root - hessian).norm(), 1e-13 * hessian.norm());
}

// Rank one in entries of very different units, and a parameter without effect.
TEST(SquareRoot, StandsSingularMatrices) {
  const Vector row = (Vector(4) << 1e6, -2.0, 0.0, 1e-5).finished();
  const Matrix hessian = row * row.transpose();
  Matrix root;
  ASSERT_TRUE(SquareRoot(hessian, &root));
  const Matrix product = root.transpose() * root;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      const double size = std::abs(row[i] * row[j]);
      EXPECT_NEAR(product(i, j), hessian(i, j), 1e-12 * size + 1e-12);
    }
  }
  // Rounding may leave an eigenvalue slightly negative.
  Matrix indefinite = Matrix::Ones(2, 2);
  indefinite(0, 1) = indefinite(1, 0) = 1.0 + 1e-13;
  EXPECT_TRUE(SquareRoot(indefinite, &root));
  indefinite(0, 1) = indefinite(1, 0) = 2.0;
  EXPECT_FALSE(SquareRoot(indefinite, &root));
  ASSERT_TRUE(SquareRoot(Matrix::Zero(3, 3), &root));
  EXPECT_LT(root.norm(), 1e-6);
  EXPECT_FALSE(SquareRoot(
      Matrix::Constant(2, 2, std::numeric_limits<double>::infinity()), &root));
}

}  // namespace
}  // namespace pinode
