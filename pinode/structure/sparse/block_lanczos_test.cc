#include "pinode/structure/sparse/block_lanczos.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>

namespace pinode {
namespace {

// A dense matrix with given eigenvalues and its eigenvectors.
struct Known {
  explicit Known(const Vector& eigenvalues) : values(eigenvalues) {
    const Eigen::Index n = values.size();
    Matrix start(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      for (Eigen::Index i = 0; i < n; ++i) {
        start(i, j) = std::sin(static_cast<double>(1 + i * n + 3 * j * j));
      }
    }
    vectors = Eigen::HouseholderQR<Matrix>(start).householderQ() *
              Matrix::Identity(n, n);
  }

  Matrix Apply(const Matrix& y) const {
    return vectors * (values.asDiagonal() * (vectors.transpose() * y));
  }

  Vector values;
  Matrix vectors;
};

LargestEigenpairs Find(const Known& known, const Matrix& found,
                       const BlockLanczosOptions& options) {
  return BlockLanczos(
      known.values.size(), [&](const Matrix& y) { return known.Apply(y); },
      found, options);
}

TEST(BlockLanczos, FindsTheLargestWithRestarts) {
  Vector values(400);
  for (Eigen::Index i = 0; i < 400; ++i) {
    values[i] = 1.0 / (1.0 + static_cast<double>(i) / 50.0);
  }
  const Known known(values);
  BlockLanczosOptions options;
  options.count = 12;
  const LargestEigenpairs pairs = Find(known, Matrix(400, 0), options);
  ASSERT_EQ(pairs.values.size(), 12);
  // More than the room for one basis holds.
  EXPECT_GT(pairs.steps, 11);
  EXPECT_LT((pairs.values - values.head(12)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT(pairs.residuals.maxCoeff(), 1e-11);
  const Matrix gram = pairs.vectors.transpose() * pairs.vectors;
  EXPECT_LT((gram - Matrix::Identity(12, 12)).cwiseAbs().maxCoeff(), 1e-12);
  const Matrix residual =
      known.Apply(pairs.vectors) - pairs.vectors * pairs.values.asDiagonal();
  EXPECT_LT(residual.colwise().norm().maxCoeff(), 1e-10);
}

TEST(BlockLanczos, FindsEqualEigenvaluesAsManyAsColumnsOfABlock) {
  Vector values = Vector::LinSpaced(300, 0.5, 1e-3);
  values.head(4).setConstant(2.0);
  values.segment(4, 3).setConstant(1.0);
  BlockLanczosOptions options;
  options.count = 8;
  const LargestEigenpairs pairs = Find(Known(values), Matrix(300, 0), options);
  ASSERT_EQ(pairs.values.size(), 8);
  EXPECT_LT((pairs.values - values.head(8)).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(BlockLanczos, LeavesOutWhatIsFound) {
  const Vector values = Vector::LinSpaced(200, 2.0, 0.01);
  const Known known(values);
  BlockLanczosOptions options;
  options.count = 2;
  options.block = 3;
  Matrix found(200, 3);
  found << known.vectors.col(0), known.vectors.col(2), known.vectors.col(3);
  const LargestEigenpairs pairs = Find(known, found, options);
  EXPECT_NEAR(pairs.values[0], values[1], 1e-11);
  EXPECT_NEAR(pairs.values[1], values[4], 1e-11);
  EXPECT_LT((found.transpose() * pairs.vectors).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(BlockLanczos, EndsWhereTheOperatorIsZero) {
  Vector values = Vector::Zero(150);
  values.head(5) << 5.0, 4.0, 3.0, 2.0, 1.0;
  BlockLanczosOptions options;
  options.count = 9;
  const LargestEigenpairs pairs = Find(Known(values), Matrix(150, 0), options);
  ASSERT_GE(pairs.values.size(), 5);
  EXPECT_LT((pairs.values.head(5) - values.head(5)).cwiseAbs().maxCoeff(),
            1e-12);
}

}  // namespace
}  // namespace pinode
