#include "pinode/structure/sparse/doubled_factor.h"

#include <vector>

#include "pinode/base/double_double.h"
#include "pinode/base/logging.h"

namespace pinode {
namespace {

class DoubledFactor : public SparseFactor {
 public:
  // Returns false if a pivot is not positive.
  bool Compute(const SparseMatrix& symmetric, const SparseMatrix& rest) {
    n_ = symmetric.rows();
    lower_.assign(static_cast<size_t>(n_ * n_), {});
    for (const SparseMatrix* part : {&symmetric, &rest}) {
      for (Eigen::Index j = 0; j < n_; ++j) {
        for (SparseMatrix::InnerIterator entry(*part, j); entry; ++entry) {
          if (entry.row() < j) continue;
          DoubleDouble& place = At(entry.row(), j);
          place = place + DoubleDouble{entry.value(), 0.0};
        }
      }
    }
    pivots_.resize(n_);
    for (Eigen::Index i = 0; i < n_; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        DoubleDouble sum = At(i, j);
        for (Eigen::Index k = 0; k < j; ++k) {
          sum = sum - At(i, k) * At(j, k);
        }
        if (j < i) {
          At(i, j) = sum / At(j, j);
          continue;
        }
        pivots_[i] = sum.Rounded();
        if (!(pivots_[i] > 0.0)) return false;
        At(i, i) = SquareRoot(sum);
      }
    }
    return true;
  }

  bool Factorise(SparseMatrix symmetric) override {
    return Compute(symmetric, SparseMatrix(symmetric.rows(), symmetric.cols()));
  }

  bool IsDoubled() const override { return true; }

  Eigen::Index WeakestDof() const override {
    Eigen::Index weakest = 0;
    pivots_.minCoeff(&weakest);
    return weakest;
  }

  Matrix Solve(const Matrix& right) const override {
    return EachColumn(right, [this](std::vector<DoubleDouble>* x) {
      SolveLowerColumn(x);
      SolveUpperColumn(x);
    });
  }

  Matrix SolveLower(const Matrix& right) const override {
    return EachColumn(
        right, [this](std::vector<DoubleDouble>* x) { SolveLowerColumn(x); });
  }

  Matrix SolveUpper(const Matrix& right) const override {
    return EachColumn(
        right, [this](std::vector<DoubleDouble>* x) { SolveUpperColumn(x); });
  }

 private:
  DoubleDouble& At(Eigen::Index i, Eigen::Index j) {
    return lower_[static_cast<size_t>(i * n_ + j)];
  }
  const DoubleDouble& At(Eigen::Index i, Eigen::Index j) const {
    return lower_[static_cast<size_t>(i * n_ + j)];
  }

  template <typename Function>
  Matrix EachColumn(const Matrix& right, const Function& solve) const {
    CHECK_EQ(right.rows(), n_);
    Matrix result(right.rows(), right.cols());
    std::vector<DoubleDouble> x(static_cast<size_t>(n_));
    for (Eigen::Index j = 0; j < right.cols(); ++j) {
      for (Eigen::Index i = 0; i < n_; ++i) {
        x[static_cast<size_t>(i)] = {right(i, j), 0.0};
      }
      solve(&x);
      for (Eigen::Index i = 0; i < n_; ++i) {
        result(i, j) = x[static_cast<size_t>(i)].Rounded();
      }
    }
    return result;
  }

  void SolveLowerColumn(std::vector<DoubleDouble>* x) const {
    for (Eigen::Index i = 0; i < n_; ++i) {
      DoubleDouble sum = (*x)[static_cast<size_t>(i)];
      for (Eigen::Index k = 0; k < i; ++k) {
        sum = sum - At(i, k) * (*x)[static_cast<size_t>(k)];
      }
      (*x)[static_cast<size_t>(i)] = sum / At(i, i);
    }
  }

  void SolveUpperColumn(std::vector<DoubleDouble>* x) const {
    for (Eigen::Index i = n_ - 1; i >= 0; --i) {
      const DoubleDouble value = (*x)[static_cast<size_t>(i)] / At(i, i);
      (*x)[static_cast<size_t>(i)] = value;
      for (Eigen::Index k = 0; k < i; ++k) {
        DoubleDouble& place = (*x)[static_cast<size_t>(k)];
        place = place - At(i, k) * value;
      }
    }
  }

  Eigen::Index n_ = 0;
  std::vector<DoubleDouble> lower_;  // row by row
};

}  // namespace

std::unique_ptr<SparseFactor> MakeDoubledFactor(const SparseMatrix& symmetric,
                                                const SparseMatrix& rest) {
  auto factor = std::make_unique<DoubledFactor>();
  if (!factor->Compute(symmetric, rest)) return nullptr;
  return factor;
}

}  // namespace pinode
