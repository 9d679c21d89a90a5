#include "pinode/structure/sparse/block_lanczos.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

// Part of a column that is rounding after others were taken from it.
constexpr double kRoundingOfColumn = 1e-12;
// Stands for zero in quotients.
constexpr double kTiny = std::numeric_limits<double>::min();

class Iteration {
 public:
  Iteration(Eigen::Index n, const BlockOperator& apply, const Matrix& found,
            const BlockLanczosOptions& options)
      : n_(n),
        apply_(apply),
        found_(found),
        options_(options),
        generator_(options.seed),
        free_(n - found.cols()),
        // Room for some steps beyond what is kept at a restart.
        room_(std::min<Eigen::Index>(
            free_, std::max(3 * options.count, options.count + 20) +
                       2 * options.block)) {}

  LargestEigenpairs Run() {
    LargestEigenpairs pairs;
    basis_.resize(n_, room_);
    projected_ = Matrix::Zero(room_, room_);
    Matrix rest = RandomBlock();
    Vector size = rest.colwise().norm();
    Project(&rest);
    while (true) {
      const Eigen::Index width = Append(std::move(rest), size);
      if (width == 0) break;  // the operator leads nowhere else
      rest = apply_(basis_.middleCols(used_ - width, width));
      ++pairs.steps;
      NoteImage(width, &rest);
      size = rest.colwise().norm();
      FindRitzPairs(rest);
      if (IsConverged() || pairs.steps >= options_.max_steps) break;
      if (used_ + options_.block > room_ && room_ < free_) Restart();
    }
    const Eigen::Index count =
        std::min<Eigen::Index>(options_.count, values_.size());
    pairs.values = values_.head(count);
    pairs.residuals = residuals_.head(count);
    pairs.vectors = basis_.leftCols(used_) * rotation_.leftCols(count);
    return pairs;
  }

 private:
  Matrix RandomBlock() {
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    Matrix block(n_, std::min<Eigen::Index>(options_.block, free_));
    for (Eigen::Index j = 0; j < block.cols(); ++j) {
      for (Eigen::Index i = 0; i < n_; ++i) block(i, j) = uniform(generator_);
    }
    // The operator removes what does not matter, such as massless motions.
    return apply_(block);
  }

  // Takes the parts along `found` and the basis from a block once. Returns the
  // parts along the basis.
  Matrix ProjectOnce(Matrix* block) const {
    if (found_.cols() > 0) {
      const Matrix part = found_.transpose() * *block;
      block->noalias() -= found_ * part;
    }
    if (used_ == 0) return Matrix(0, block->cols());
    Matrix along = basis_.leftCols(used_).transpose() * *block;
    block->noalias() -= basis_.leftCols(used_) * along;
    return along;
  }

  // Takes these parts from a block beyond rounding. Twice is enough (W. Kahan,
  // in B. N. Parlett, The Symmetric Eigenvalue Problem, SIAM 1998,
  // section 6.9).
  Matrix Project(Matrix* block) const {
    const Matrix along = ProjectOnce(block);
    return along + ProjectOnce(block);
  }

  // Appends the directions of `columns`, which Project has passed, to the
  // basis. A column is rounding if too little is left of its `size`. Returns
  // their number.
  Eigen::Index Append(Matrix columns, const Vector& size) {
    Eigen::Index width = 0;
    for (Eigen::Index j = 0; j < columns.cols(); ++j) {
      for (int pass = 0; pass < 2; ++pass) {
        const Vector part =
            columns.leftCols(width).transpose() * columns.col(j);
        columns.col(j) -= columns.leftCols(width) * part;
      }
      const double rest = columns.col(j).norm();
      if (!(rest > kRoundingOfColumn * size[j]) || used_ + width == room_)
        continue;
      columns.col(width++) = columns.col(j) / rest;
    }
    columns.conservativeResize(Eigen::NoChange, width);
    if (width == 0) return 0;
    // A column that was short has kept rounding errors along the basis.
    ProjectOnce(&columns);
    for (Eigen::Index j = 0; j < width; ++j) {
      const Vector part = columns.leftCols(j).transpose() * columns.col(j);
      columns.col(j) -= columns.leftCols(j) * part;
      columns.col(j).normalize();
    }
    basis_.middleCols(used_, width) = columns;
    used_ += width;
    return width;
  }

  // Notes the image of the last `width` columns of the basis. Leaves in `image`
  // what is outside of the basis.
  void NoteImage(Eigen::Index width, Matrix* image) {
    const Matrix along = Project(image);
    const Eigen::Index first = used_ - width;
    projected_.block(0, first, used_, width) = along;
    projected_.block(first, 0, width, used_) = along.transpose();
  }

  // Finds the eigenpairs of the projected operator. `rest` is the image of the
  // last columns outside of the basis. The images of all others are inside.
  void FindRitzPairs(const Matrix& rest) {
    const Matrix projected = projected_.topLeftCorner(used_, used_);
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(
        Matrix(0.5 * (projected + projected.transpose())));
    rotation_ = solver.eigenvectors().rowwise().reverse();
    values_ = solver.eigenvalues().reverse();
    const Matrix metric = rest.transpose() * rest;
    const Matrix last = rotation_.bottomRows(rest.cols());
    residuals_.resize(used_);
    for (Eigen::Index i = 0; i < used_; ++i) {
      const double square = last.col(i).dot(metric * last.col(i));
      residuals_[i] = std::sqrt(std::max(square, 0.0)) /
                      std::max(std::abs(values_[i]), kTiny);
    }
  }

  bool IsConverged() const {
    return used_ >= options_.count &&
           residuals_.head(options_.count).maxCoeff() <= options_.tolerance;
  }

  // Keeps the best eigenpairs alone. What they leave is along the next block.
  void Restart() {
    const Eigen::Index kept = options_.count + options_.block;
    basis_.leftCols(kept) =
        (basis_.leftCols(used_) * rotation_.leftCols(kept)).eval();
    projected_.setZero();
    projected_.diagonal().head(kept) = values_.head(kept);
    used_ = kept;
  }

  const Eigen::Index n_;
  const BlockOperator& apply_;
  const Matrix& found_;
  const BlockLanczosOptions& options_;
  std::mt19937 generator_;
  const Eigen::Index free_;
  const Eigen::Index room_;
  Matrix basis_;
  Eigen::Index used_ = 0;
  Matrix projected_;
  Vector values_;
  Matrix rotation_;
  Vector residuals_;
};

}  // namespace

LargestEigenpairs BlockLanczos(Eigen::Index n, const BlockOperator& apply,
                               const Matrix& found,
                               const BlockLanczosOptions& options) {
  CHECK_GT(options.count, 0);
  CHECK_GT(options.block, 0);
  CHECK_EQ(found.rows(), n);
  if (found.cols() >= n) return {};
  return Iteration(n, apply, found, options).Run();
}

}  // namespace pinode
