#include "pinode/structure/sparse/sparse_factor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "pinode/structure/sparse/doubled_factor.h"

namespace pinode {
namespace {

// Laplace's matrix of a plate of side x side points, with `diagonal` at each.
SparseMatrix Plate(int side, double diagonal) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const int row = i * side + j;
      entries.emplace_back(row, row, diagonal);
      if (i + 1 < side) {
        entries.emplace_back(row, row + side, -1.0);
        entries.emplace_back(row + side, row, -1.0);
      }
      if (j + 1 < side) {
        entries.emplace_back(row, row + 1, -1.0);
        entries.emplace_back(row + 1, row, -1.0);
      }
    }
  }
  SparseMatrix matrix(side * side, side * side);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Matrix Forces(Eigen::Index n) {
  Matrix forces(n, 3);
  for (Eigen::Index j = 0; j < 3; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) {
      forces(i, j) = std::sin(0.7 * static_cast<double>(i * (j + 1)));
    }
  }
  return forces;
}

// The ways to factors; `large` is beyond the size at which they part.
class DefiniteFactor : public testing::TestWithParam<int> {};

TEST_P(DefiniteFactor, SolvesAndSplits) {
  const SparseMatrix matrix = Plate(GetParam(), 4.0);
  const Matrix forces = Forces(matrix.rows());
  const std::unique_ptr<SparseFactor> factor =
      MakeDefiniteFactor(matrix.rows());
  ASSERT_TRUE(factor->Factorise(matrix));
  EXPECT_GT(factor->pivots().minCoeff(), 0.0);
  const Matrix x = factor->Solve(forces);
  EXPECT_LT((matrix * x - forces).cwiseAbs().maxCoeff(), 1e-11);
  // F^-T F^-1 is the inverse.
  const Matrix split = factor->SolveUpper(factor->SolveLower(forces));
  EXPECT_LT((split - x).norm(), 1e-12 * x.norm());
  // One column alone is the same as among others.
  const Matrix alone = factor->SolveLower(forces.col(1));
  EXPECT_LT((alone - factor->SolveLower(forces).col(1)).norm(), 1e-12);
}

TEST_P(DefiniteFactor, HasThePivotsOfTheOtherWay) {
  const SparseMatrix matrix = Plate(GetParam(), 4.0);
  const std::unique_ptr<SparseFactor> factor =
      MakeDefiniteFactor(matrix.rows());
  const std::unique_ptr<SparseFactor> simplicial = MakeSimplicialFactor();
  ASSERT_TRUE(factor->Factorise(matrix));
  ASSERT_TRUE(simplicial->Factorise(matrix));
  // The orders of elimination may differ, the determinant does not.
  EXPECT_NEAR(factor->pivots().array().log().sum(),
              simplicial->pivots().array().log().sum(), 1e-8);
}

TEST_P(DefiniteFactor, NamesARowOfANegativePart) {
  SparseMatrix matrix = Plate(GetParam(), 4.0);
  const Eigen::Index negative = matrix.rows() / 3;
  matrix.coeffRef(negative, negative) = -1.0;
  const std::unique_ptr<SparseFactor> factor =
      MakeDefiniteFactor(matrix.rows());
  const bool done = factor->Factorise(matrix);
  EXPECT_TRUE(!done || factor->pivots().minCoeff() < 0.0);
  EXPECT_GE(factor->WeakestDof(), 0);
  EXPECT_LT(factor->WeakestDof(), matrix.rows());
}

INSTANTIATE_TEST_SUITE_P(Sizes, DefiniteFactor, testing::Values(12, 60),
                         [](const testing::TestParamInfo<int>& size) {
                           return size.param < 45 ? "small" : "large";
                         });

TEST(SimplicialFactor, CountsNegativeEigenvalues) {
  // Eigenvalues 4 - 2 cos a - 2 cos b of a plate of 3 x 3: 1.17 to 6.83, and
  // three of them below 3.9.
  const std::unique_ptr<SparseFactor> factor = MakeSimplicialFactor();
  ASSERT_TRUE(factor->Factorise(Plate(3, 4.0 - 3.9)));
  EXPECT_EQ((factor->pivots().array() < 0.0).count(), 3);
}

TEST(DoubledFactor, SolvesAndSplits) {
  const SparseMatrix matrix = Plate(9, 4.0);
  const SparseMatrix none(matrix.rows(), matrix.cols());
  const Matrix forces = Forces(matrix.rows());
  const std::unique_ptr<SparseFactor> factor = MakeDoubledFactor(matrix, none);
  ASSERT_NE(factor, nullptr);
  const Matrix x = factor->Solve(forces);
  EXPECT_LT((matrix * x - forces).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((factor->SolveUpper(factor->SolveLower(forces)) - x).norm(),
            1e-14 * x.norm());
}

// A matrix of ones is singular but for an addition that no entry can hold.
TEST(DoubledFactor, KeepsTheRestOfTheEntries) {
  SparseMatrix ones = Matrix::Ones(2, 2).sparseView();
  SparseMatrix rest(2, 2);
  EXPECT_EQ(MakeDoubledFactor(ones, rest), nullptr);
  rest.coeffRef(1, 1) = std::ldexp(1.0, -60);
  const std::unique_ptr<SparseFactor> factor = MakeDoubledFactor(ones, rest);
  ASSERT_NE(factor, nullptr);
  EXPECT_EQ(factor->pivots()[1], std::ldexp(1.0, -60));
  EXPECT_EQ(factor->WeakestDof(), 1);
}

}  // namespace
}  // namespace pinode
