#include "pinode/estimate/shooting/block_tridiagonal.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

// Blocks of so many columns are worked on column by column: for products and
// triangular solves Eigen packs its operands, which takes longer than the
// work.
constexpr Eigen::Index kFewColumns = 16;

// *result -= left * right, with a small square matrix on the right.
template <typename Left, typename Right, typename Result>
void SubtractProduct(const Left& left, const Right& right, Result* result) {
  if (right.rows() > kFewColumns) {
    result->noalias() -= left * right;
    return;
  }
  for (Eigen::Index j = 0; j < right.cols(); ++j) {
    for (Eigen::Index i = 0; i < right.rows(); ++i) {
      result->col(j) -= right(i, j) * left.col(i);
    }
  }
}

}  // namespace

BlockTridiagonal::BlockTridiagonal(int num_blocks, int block_size)
    : block_size_(block_size) {
  CHECK_GE(num_blocks, 1);
  CHECK_GE(block_size, 1);
  const Matrix zero = Matrix::Zero(block_size, block_size);
  diagonal_.assign(static_cast<size_t>(num_blocks), zero);
  lower_ = diagonal_;
  coupling_.assign(static_cast<size_t>(num_blocks - 1), zero);
  below_ = coupling_;
}

void BlockTridiagonal::SetZero() {
  for (Matrix& block : diagonal_) block.setZero();
  for (Matrix& block : coupling_) block.setZero();
}

bool BlockTridiagonal::Factor(double damping) {
  for (size_t k = 0; k < diagonal_.size(); ++k) {
    Matrix block = diagonal_[k];
    block.diagonal() *= 1.0 + damping;
    if (k > 0) block.noalias() -= below_[k - 1] * below_[k - 1].transpose();
    const Eigen::LLT<Matrix> factor(block);
    if (factor.info() != Eigen::Success) return false;
    lower_[k] = factor.matrixL();
    if (!lower_[k].allFinite()) return false;
    if (k + 1 < diagonal_.size()) {
      // M_k = B_k' L_k^-T, that is, L_k M_k' = B_k.
      Matrix transposed = coupling_[k];
      lower_[k].triangularView<Eigen::Lower>().solveInPlace(transposed);
      below_[k] = transposed.transpose();
    }
  }
  return true;
}

void BlockTridiagonal::SolveLower(Matrix* right) const {
  const Eigen::Index m = block_size_;
  CHECK_EQ(right->cols(), m * num_blocks());
  for (int k = 0; k < num_blocks(); ++k) {
    auto block = right->middleCols(k * m, m);
    if (k > 0) {
      SubtractProduct(right->middleCols((k - 1) * m, m),
                      below_[static_cast<size_t>(k - 1)].transpose(), &block);
    }
    const Matrix& lower = lower_[static_cast<size_t>(k)];
    if (m > kFewColumns) {
      lower.transpose()
          .triangularView<Eigen::Upper>()
          .solveInPlace<Eigen::OnTheRight>(block);
      continue;
    }
    for (Eigen::Index j = 0; j < m; ++j) {
      for (Eigen::Index i = 0; i < j; ++i) {
        block.col(j) -= lower(j, i) * block.col(i);
      }
      block.col(j) /= lower(j, j);
    }
  }
}

void BlockTridiagonal::SolveUpper(Matrix* right) const {
  const Eigen::Index m = block_size_;
  CHECK_EQ(right->cols(), m * num_blocks());
  for (int k = num_blocks() - 1; k >= 0; --k) {
    auto block = right->middleCols(k * m, m);
    if (k + 1 < num_blocks()) {
      SubtractProduct(right->middleCols((k + 1) * m, m),
                      below_[static_cast<size_t>(k)], &block);
    }
    const Matrix& lower = lower_[static_cast<size_t>(k)];
    if (m > kFewColumns) {
      lower.triangularView<Eigen::Lower>().solveInPlace<Eigen::OnTheRight>(
          block);
      continue;
    }
    for (Eigen::Index j = m - 1; j >= 0; --j) {
      for (Eigen::Index i = j + 1; i < m; ++i) {
        block.col(j) -= lower(i, j) * block.col(i);
      }
      block.col(j) /= lower(j, j);
    }
  }
}

void BlockTridiagonal::Solve(Matrix* right) const {
  SolveLower(right);
  SolveUpper(right);
}

}  // namespace pinode
