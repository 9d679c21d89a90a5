#include "pinode/estimate/solver/square_root.h"

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

// The negative direction goes, the others stay: (1, 1) / sqrt(2) of eigenvalue
// 3, and a third parameter in other units.
TEST(SquareRoot, OfTheNearestMatrixWithoutNegativeEigenvalues) {
  Matrix indefinite = Matrix::Identity(3, 3);
  indefinite(0, 1) = indefinite(1, 0) = 2.0;
  indefinite(2, 2) = 1e12;
  Matrix root;
  ASSERT_TRUE(NearestSquareRoot(indefinite, &root));
  EXPECT_TRUE(root.isUpperTriangular());
  const Matrix product = root.transpose() * root;
  EXPECT_NEAR(product(2, 2), 1e12, 1.0);
  EXPECT_LT((product.topLeftCorner(2, 2) - Matrix::Constant(2, 2, 1.5)).norm(),
            1e-12);
  // A diagonal that rounding has turned over.
  const Matrix turned = Eigen::Vector2d(4.0, -0.5).asDiagonal();
  ASSERT_TRUE(NearestSquareRoot(turned, &root));
  EXPECT_NEAR(root(0, 0), 2.0, 1e-12);
  EXPECT_LT(std::abs(root(1, 1)), 1e-6);
  EXPECT_FALSE(NearestSquareRoot(-Matrix::Identity(2, 2), &root));
  EXPECT_FALSE(NearestSquareRoot(
      Matrix::Constant(2, 2, std::numeric_limits<double>::infinity()), &root));
}

}  // namespace
}  // namespace pinode
