#include "pinode/estimate/shooting/block_tridiagonal.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <vector>

#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

Matrix RandomMatrix(int rows, int cols, testing::Gaussian* random) {
  const Vector values = random->Draw(rows * cols);
  return Eigen::Map<const Matrix>(values.data(), rows, cols);
}

// J'J of a random J with the pattern of segments: positive definite.
Matrix RandomDense(int blocks, int m, testing::Gaussian* random) {
  Matrix dense = Matrix::Identity(blocks * m, blocks * m);
  for (int k = 0; k + 1 < blocks; ++k) {
    const Matrix rows = RandomMatrix(m + 2, 2 * m, random);
    dense.block(k * m, k * m, 2 * m, 2 * m) += rows.transpose() * rows;
  }
  return dense;
}

BlockTridiagonal FromDense(const Matrix& dense, int blocks, int m) {
  BlockTridiagonal system(blocks, m);
  for (int k = 0; k < blocks; ++k) {
    system.diagonal(k) = dense.block(k * m, k * m, m, m);
    if (k + 1 < blocks) {
      system.coupling(k) = dense.block(k * m, (k + 1) * m, m, m);
    }
  }
  return system;
}

TEST(BlockTridiagonal, EqualsDenseSolve) {
  testing::Gaussian random(3);
  // Small blocks are worked on column by column, large ones by Eigen.
  for (int m : {1, 3, 4, 16, 20}) {
    for (int blocks = 1; blocks <= 6; ++blocks) {
      const Matrix dense = RandomDense(blocks, m, &random);
      BlockTridiagonal system = FromDense(dense, blocks, m);
      const Matrix right = RandomMatrix(blocks * m, 3, &random);
      for (double damping : {0.0, 0.7}) {
        Matrix damped = dense;
        damped.diagonal() *= 1.0 + damping;
        ASSERT_TRUE(system.Factor(damping));
        const Matrix expected = damped.ldlt().solve(right);
        Matrix solution = right.transpose();
        system.Solve(&solution);
        EXPECT_LT((solution.transpose() - expected).norm(),
                  1e-11 * expected.norm())
            << blocks << " blocks of " << m << ", damping " << damping;
        Matrix half = right.transpose();
        system.SolveLower(&half);
        const Matrix form = right.transpose() * expected;
        EXPECT_LT((half * half.transpose() - form).norm(), 1e-11 * form.norm());
        system.SolveUpper(&half);
        EXPECT_LT((half.transpose() - expected).norm(),
                  1e-11 * expected.norm());
      }
    }
  }
}

TEST(BlockTridiagonal, RefusesWhatIsNotPositiveDefinite) {
  testing::Gaussian random(4);
  const int m = 2;
  for (int blocks : {1, 2, 5}) {
    for (int k = 0; k < blocks; ++k) {
      Matrix dense = RandomDense(blocks, m, &random);
      dense(k * m, k * m) = -0.1;
      BlockTridiagonal system = FromDense(dense, blocks, m);
      EXPECT_FALSE(system.Factor(0.0)) << "block " << k << " of " << blocks;
    }
  }
  // Each diagonal block is definite, the whole is not.
  BlockTridiagonal system(2, 1);
  system.diagonal(0)(0, 0) = system.diagonal(1)(0, 0) = 1.0;
  system.coupling(0)(0, 0) = 1.1;
  EXPECT_FALSE(system.Factor(0.0));
  EXPECT_TRUE(system.Factor(0.2));
  system.diagonal(0)(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(system.Factor(0.0));
  system.SetZero();
  EXPECT_EQ(system.diagonal(0)(0, 0), 0.0);
  EXPECT_EQ(system.coupling(0)(0, 0), 0.0);
}

// h_{k+1} = F h_k + w, y_k = H h_k + v: the least-squares trajectory from the
// block system is that of the Kalman filter and the Rauch-Tung-Striebel
// recursion in the covariance form of the textbooks.
TEST(BlockTridiagonal, IsTheRauchTungStriebelSmoother) {
  testing::Gaussian random(5);
  const int m = 2;
  const int steps = 25;
  Matrix F(2, 2);
  F << 0.95, 0.2, -0.3, 0.9;
  const Matrix H = (Matrix(1, 2) << 1.0, 0.3).finished();
  const Matrix Q = (Matrix(2, 2) << 0.04, 0.01, 0.01, 0.09).finished();
  const Matrix R = Matrix::Constant(1, 1, 0.25);
  const Matrix P0 = 2.0 * Matrix::Identity(2, 2);
  const Vector y = random.Draw(steps);

  std::vector<Vector> predicted, filtered;
  std::vector<Matrix> predicted_P, filtered_P;
  Vector h = Vector::Zero(m);
  Matrix P = P0;
  for (int k = 0; k < steps; ++k) {
    if (k > 0) {
      h = F * h;
      P = F * P * F.transpose() + Q;
    }
    predicted.push_back(h);
    predicted_P.push_back(P);
    const Matrix gain =
        P * H.transpose() * (H * P * H.transpose() + R).inverse();
    h += gain * (y.segment(k, 1) - H * h);
    P = P - gain * H * P;
    filtered.push_back(h);
    filtered_P.push_back(P);
  }
  std::vector<Vector> smoothed = filtered;
  for (int k = steps - 2; k >= 0; --k) {
    const size_t i = static_cast<size_t>(k);
    const Matrix gain =
        filtered_P[i] * F.transpose() * predicted_P[i + 1].inverse();
    smoothed[i] += gain * (smoothed[i + 1] - predicted[i + 1]);
  }

  BlockTridiagonal system(steps, m);
  Matrix right = Matrix::Zero(1, steps * m);
  const Matrix precision = Q.inverse();
  for (int k = 0; k < steps; ++k) {
    system.diagonal(k) += H.transpose() * R.inverse() * H;
    right.middleCols(k * m, m) +=
        (H.transpose() * R.inverse() * y.segment(k, 1)).transpose();
    if (k == 0) system.diagonal(0) += P0.inverse();
    if (k + 1 < steps) {
      system.diagonal(k) += F.transpose() * precision * F;
      system.diagonal(k + 1) += precision;
      system.coupling(k) = -F.transpose() * precision;
    }
  }
  ASSERT_TRUE(system.Factor(0.0));
  system.Solve(&right);
  for (int k = 0; k < steps; ++k) {
    EXPECT_LT((right.middleCols(k * m, m).transpose() -
               smoothed[static_cast<size_t>(k)])
                  .norm(),
              1e-11)
        << k;
  }
}

}  // namespace
}  // namespace pinode
