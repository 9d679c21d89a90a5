#include "pinode/structure/model/symmetric.h"

#include <limits>

#include "gtest/gtest.h"

namespace pinode {
namespace {

TEST(LargestAsymmetry, IsZeroForSymmetricMatrices) {
  Matrix matrix(2, 2);
  matrix << 1.0, 0.1, 0.1, 2.0;
  EXPECT_EQ(LargestAsymmetry(matrix).relative, 0.0);
  EXPECT_EQ(LargestAsymmetry(Matrix::Zero(3, 3)).relative, 0.0);
}

TEST(LargestAsymmetry, FindsTheWorstPairRelativeToItsOwnDofs) {
  // Translations of 1e9, rotations of 1: the relative error among the rotations
  // is larger, although it is the smaller number.
  Matrix matrix = Matrix::Zero(4, 4);
  matrix.diagonal() << 1e9, 1e9, 1.0, 4.0;
  matrix(0, 1) = -5e8;
  matrix(1, 0) = -5e8 + 100.0;
  matrix(2, 3) = 0.5;
  matrix(3, 2) = 0.6;
  const Asymmetry worst = LargestAsymmetry(matrix);
  EXPECT_EQ(worst.row, 3);
  EXPECT_EQ(worst.column, 2);
  EXPECT_NEAR(worst.relative, 0.1 / 2.0, 1e-12);
}

TEST(LargestAsymmetry, SurvivesExtremeEntries) {
  constexpr double kLargest = std::numeric_limits<double>::max();
  Matrix matrix = Matrix::Constant(2, 2, kLargest);
  matrix(1, 0) = -kLargest;
  EXPECT_DOUBLE_EQ(LargestAsymmetry(matrix).relative, 2.0);
}

TEST(SymmetricPart, IsTheNearestSymmetricMatrix) {
  const Matrix matrix = Matrix::Random(5, 5);
  const Matrix part = SymmetricPart(matrix);
  EXPECT_EQ(LargestAsymmetry(part).relative, 0.0);
  // The removed part is skew, so orthogonal to every symmetric matrix.
  const Matrix rest = matrix - part;
  EXPECT_LT((rest + rest.transpose()).norm(), 1e-15);
  EXPECT_NEAR((rest.array() * part.array()).sum(), 0.0, 1e-15);
}

TEST(SymmetricDeathTest, RefusesRectangularMatrices) {
  EXPECT_DEATH(SymmetricPart(Matrix::Zero(2, 3)), "square");
  EXPECT_DEATH(LargestAsymmetry(Matrix::Zero(2, 3)), "square");
}

}  // namespace
}  // namespace pinode
