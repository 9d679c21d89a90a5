#include "pinode/structure/sparse/supernodal_factor.h"

#include <cholmod.h>

#include <new>
#include <vector>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

// The lower triangle of a matrix in CHOLMOD's form.
class LowerTriangle {
 public:
  explicit LowerTriangle(const SparseMatrix& symmetric) {
    const Eigen::Index n = symmetric.cols();
    const auto at_most = static_cast<size_t>((symmetric.nonZeros() + n) / 2);
    begins_.reserve(static_cast<size_t>(n) + 1);
    rows_.reserve(at_most);
    values_.reserve(at_most);
    for (Eigen::Index j = 0; j < n; ++j) {
      begins_.push_back(static_cast<SuiteSparse_long>(rows_.size()));
      for (SparseMatrix::InnerIterator entry(symmetric, j); entry; ++entry) {
        if (entry.row() < j) continue;
        rows_.push_back(static_cast<SuiteSparse_long>(entry.row()));
        values_.push_back(entry.value());
      }
    }
    begins_.push_back(static_cast<SuiteSparse_long>(rows_.size()));
    view_.nrow = static_cast<size_t>(n);
    view_.ncol = static_cast<size_t>(n);
    view_.nzmax = rows_.size();
    view_.p = begins_.data();
    view_.i = rows_.data();
    view_.x = values_.data();
    view_.stype = -1;  // only the lower triangle is there
    view_.itype = CHOLMOD_LONG;
    view_.xtype = CHOLMOD_REAL;
    view_.dtype = CHOLMOD_DOUBLE;
    view_.sorted = 1;
    view_.packed = 1;
  }
  LowerTriangle(const LowerTriangle&) = delete;
  LowerTriangle& operator=(const LowerTriangle&) = delete;

  cholmod_sparse* view() { return &view_; }

 private:
  std::vector<SuiteSparse_long> begins_;
  std::vector<SuiteSparse_long> rows_;
  std::vector<double> values_;
  cholmod_sparse view_ = {};
};

class SupernodalFactor : public SparseFactor {
 public:
  SupernodalFactor() {
    cholmod_l_start(&common_);
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.print = 0;
    common_.quick_return_if_not_posdef = 1;
    // Nested dissection halves the factors of a solid.
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_METIS;
  }
  ~SupernodalFactor() override {
    cholmod_l_free_factor(&factor_, &common_);
    cholmod_l_free_dense(&solution_, &common_);
    cholmod_l_free_dense(&work_y_, &common_);
    cholmod_l_free_dense(&work_e_, &common_);
    cholmod_l_finish(&common_);
  }

  bool Factorise(SparseMatrix symmetric) override {
    CHECK_EQ(symmetric.rows(), symmetric.cols());
    CHECK(factor_ == nullptr) << "one object, one factorisation";
    LowerTriangle lower(symmetric);
    symmetric = SparseMatrix();
    factor_ = cholmod_l_analyze(lower.view(), &common_);
    if (factor_ == nullptr && common_.status != CHOLMOD_OUT_OF_MEMORY) {
      // METIS refuses some matrices, diagonal ones for example.
      common_.method[0].ordering = CHOLMOD_AMD;
      factor_ = cholmod_l_analyze(lower.view(), &common_);
    }
    if (factor_ == nullptr) throw std::bad_alloc();
    operations_ = common_.fl;
    if (cholmod_l_factorize(lower.view(), factor_, &common_) == 0) {
      throw std::bad_alloc();
    }
    weakest_ = static_cast<Eigen::Index>(factor_->minor);
    if (factor_->minor < factor_->n) return false;
    SetPivots();
    pivots_.minCoeff(&weakest_);
    return true;
  }

  Eigen::Index WeakestDof() const override { return DofOfPivot(weakest_); }
  double Operations() const override { return operations_; }

  Matrix Solve(const Matrix& right) const override {
    return SolvePart(CHOLMOD_A, right);
  }

  Matrix SolveLower(const Matrix& right) const override {
    Matrix permuted(right.rows(), right.cols());
    for (Eigen::Index j = 0; j < right.cols(); ++j) {
      for (Eigen::Index i = 0; i < right.rows(); ++i) {
        permuted(i, j) = right(DofOfPivot(i), j);
      }
    }
    return SolvePart(CHOLMOD_L, permuted);
  }

  Matrix SolveUpper(const Matrix& right) const override {
    const Matrix permuted = SolvePart(CHOLMOD_Lt, right);
    Matrix result(right.rows(), right.cols());
    for (Eigen::Index j = 0; j < right.cols(); ++j) {
      for (Eigen::Index i = 0; i < right.rows(); ++i) {
        result(DofOfPivot(i), j) = permuted(i, j);
      }
    }
    return result;
  }

 private:
  Eigen::Index DofOfPivot(Eigen::Index pivot) const {
    return static_cast<const SuiteSparse_long*>(factor_->Perm)[pivot];
  }

  void SetPivots() {
    const auto* const super =
        static_cast<const SuiteSparse_long*>(factor_->super);
    const auto* const rows = static_cast<const SuiteSparse_long*>(factor_->pi);
    const auto* const begins =
        static_cast<const SuiteSparse_long*>(factor_->px);
    const auto* const values = static_cast<const double*>(factor_->x);
    pivots_.resize(static_cast<Eigen::Index>(factor_->n));
    for (size_t s = 0; s < factor_->nsuper; ++s) {
      // A dense block. It begins with the triangle of its columns.
      const SuiteSparse_long height = rows[s + 1] - rows[s];
      for (SuiteSparse_long j = super[s]; j < super[s + 1]; ++j) {
        const double root = values[begins[s] + (j - super[s]) * (height + 1)];
        pivots_[j] = root * root;
      }
    }
  }

  // `system` is CHOLMOD_A, CHOLMOD_L or CHOLMOD_Lt.
  Matrix SolvePart(int system, const Matrix& right) const {
    cholmod_dense b = {};
    b.nrow = static_cast<size_t>(right.rows());
    b.ncol = static_cast<size_t>(right.cols());
    b.nzmax = b.nrow * b.ncol;
    b.d = b.nrow;
    b.x = const_cast<double*>(right.data());  // is only read
    b.xtype = CHOLMOD_REAL;
    b.dtype = CHOLMOD_DOUBLE;
    if (cholmod_l_solve2(system, factor_, &b, nullptr, &solution_, nullptr,
                         &work_y_, &work_e_, &common_) == 0) {
      throw std::bad_alloc();
    }
    return Eigen::Map<const Matrix>(static_cast<const double*>(solution_->x),
                                    right.rows(), right.cols());
  }

  // CHOLMOD notes its status in `common_` and keeps its work space from one
  // solution to the next.
  mutable cholmod_common common_;
  cholmod_factor* factor_ = nullptr;
  mutable cholmod_dense* solution_ = nullptr;
  mutable cholmod_dense* work_y_ = nullptr;
  mutable cholmod_dense* work_e_ = nullptr;
  double operations_ = 0.0;
  Eigen::Index weakest_ = 0;
};

}  // namespace

std::unique_ptr<SparseFactor> MakeSupernodalFactor() {
  return std::make_unique<SupernodalFactor>();
}

}  // namespace pinode
