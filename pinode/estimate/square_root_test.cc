#include "pinode/estimate/square_root.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace pinode {
namespace {

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
