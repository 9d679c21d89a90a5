#include "pinode/discover/active_set.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

#include "tests/support/discover_testing.h"

namespace pinode {
namespace {

double Objective(const Matrix& A, const Vector& b, const Vector& penalty,
                 const Vector& z) {
  return 0.5 * (b - A * z).squaredNorm() + penalty.dot(z.cwiseAbs());
}

// Every face: each entry at zero, positive or negative.
double LeastOverAllFaces(const Matrix& A, const Vector& b,
                         const Vector& penalty, const std::vector<int>& signs) {
  const int count = static_cast<int>(A.cols());
  int faces = 1;
  for (int j = 0; j < count; ++j) faces *= 3;
  double least = std::numeric_limits<double>::infinity();
  for (int face = 0; face < faces; ++face) {
    std::vector<int> active;
    Vector side = Vector::Zero(count);
    for (int j = 0, code = face; j < count; ++j, code /= 3) {
      side[j] = code % 3 - 1;
      if (side[j] != 0.0) active.push_back(j);
    }
    Vector z = Vector::Zero(count);
    if (!active.empty()) {
      const Matrix columns = A(Eigen::all, active);
      const Vector right =
          columns.transpose() * b - Vector(penalty.cwiseProduct(side)(active));
      const Matrix gram = columns.transpose() * columns;
      z(active) = Vector(gram.ldlt().solve(right));
    }
    bool inside = true;
    for (int j = 0; j < count; ++j) {
      // Entries without penalty may have either sign on any of their faces.
      if (penalty[j] > 0.0 && z[j] * side[j] < 0.0) inside = false;
      if (signs[static_cast<size_t>(j)] * z[j] < 0.0) inside = false;
    }
    if (inside) least = std::min(least, Objective(A, b, penalty, z));
  }
  return least;
}

TEST(ActiveSet, IsTheBestOfAllFaces) {
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    testing::Gaussian random(seed);
    Matrix A = random.Draw(8, 5);
    A.col(1) += 3.0 * A.col(0);
    A.col(2) *= 1e4;
    const Vector b = random.Draw(8, 1);
    Vector penalty = Vector::Constant(5, 0.5);
    penalty[2] = 5e3;
    penalty[3] = seed % 2 == 0 ? 0.0 : 1.5;
    const std::vector<int> signs = {0, seed % 3 == 0 ? 1 : 0, 0, -1, 0};
    const double least = LeastOverAllFaces(A, b, penalty, signs);
    // From nothing, and from a start that is far from right.
    const Vector far = (Vector(5) << 1.0, 2.0, 0.0, -3.0, -1.0).finished();
    for (const Vector& start : {Vector(Vector::Zero(5)), far}) {
      const ActiveSetSolution solution =
          SolveActiveSet(A, b, penalty, signs, start);
      EXPECT_TRUE(solution.converged) << seed;
      EXPECT_NEAR(Objective(A, b, penalty, solution.z), least, 1e-12 * least)
          << seed;
      for (int j = 0; j < 5; ++j) {
        EXPECT_GE(signs[static_cast<size_t>(j)] * solution.z[j], 0.0);
        const bool active =
            std::find(solution.active.begin(), solution.active.end(), j) !=
            solution.active.end();
        if (!active) {
          EXPECT_EQ(solution.z[j], 0.0);
        }
      }
    }
  }
}

TEST(ActiveSet, TheRightFaceTakesOneSystem) {
  testing::Gaussian random(5);
  const Matrix A = random.Draw(30, 10);
  const Vector b = random.Draw(30, 1);
  const Vector penalty = Vector::Constant(10, 2.0);
  const std::vector<int> signs(10, 0);
  const ActiveSetSolution first =
      SolveActiveSet(A, b, penalty, signs, Vector::Zero(10));
  ASSERT_GT(first.active.size(), 1u);
  const ActiveSetSolution again =
      SolveActiveSet(A, b, penalty, signs, 0.7 * first.z);
  EXPECT_EQ(again.num_faces, 1);
  EXPECT_EQ(again.active, first.active);
  EXPECT_LT((again.z - first.z).norm(), 1e-14 * first.z.norm());
}

// Columns twice, opposite, as sums of others, more columns than rows, and zero.
TEST(ActiveSet, DependentColumns) {
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    testing::Gaussian random(seed);
    Matrix A(4, 9);
    A.leftCols(4) = random.Draw(4, 4);
    A.col(4) = A.col(0);
    A.col(5) = -2.0 * A.col(1);
    A.col(6) = A.col(2) + A.col(3);
    A.col(7).setZero();
    A.col(8) = A.col(0);
    const Vector b = random.Draw(4, 1);
    const Vector penalty = Vector::Constant(9, 0.1);
    const Vector start = random.Draw(9, 1);
    const ActiveSetSolution solution =
        SolveActiveSet(A, b, penalty, std::vector<int>(9, 0), start);
    EXPECT_TRUE(solution.converged);
    EXPECT_LE(solution.active.size(), 4u);
    const Vector pull =
        (A.transpose() * (b - A * solution.z)).cwiseAbs() - penalty;
    EXPECT_LT(pull.maxCoeff(), 1e-11);
    // The stronger of two parallel columns takes all: it is the cheaper.
    EXPECT_EQ(solution.z[1], 0.0);
    EXPECT_EQ(solution.z[7], 0.0);
    // Without any penalty: an exact fit.
    const ActiveSetSolution exact = SolveActiveSet(
        A, b, Vector::Zero(9), std::vector<int>(9, 0), Vector::Zero(9));
    EXPECT_TRUE(exact.converged);
    EXPECT_LT((b - A * exact.z).norm(), 1e-11 * b.norm());
  }
}

TEST(ActiveSet, NothingToExplain) {
  const ActiveSetSolution solution =
      SolveActiveSet(Matrix::Ones(3, 2), Vector::Zero(3), Vector::Zero(2),
                     {0, 1}, Vector::Zero(2));
  EXPECT_TRUE(solution.converged);
  EXPECT_EQ(solution.z, Vector::Zero(2));
}

}  // namespace
}  // namespace pinode
