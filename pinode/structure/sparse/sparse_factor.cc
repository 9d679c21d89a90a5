#include "pinode/structure/sparse/sparse_factor.h"

#include <metis.h>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <vector>

#ifdef PINODE_SUPERNODAL
#include "pinode/structure/sparse/supernodal_factor.h"
#endif

namespace pinode {
namespace {

// Number of rows below which all orders are fast, and METIS is the slower one.
constexpr Eigen::Index kNestedFrom = 2000;

// Finds the order from the neighbours of each row (without the row itself).
// Returns false if METIS finds no order.
bool NestedDissection(
    const SparseMatrix& symmetric,
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>* inverse) {
  idx_t size = static_cast<idx_t>(symmetric.rows());
  std::vector<idx_t> begins = {0};
  std::vector<idx_t> neighbours;
  begins.reserve(static_cast<size_t>(size) + 1);
  neighbours.reserve(static_cast<size_t>(symmetric.nonZeros()));
  for (Eigen::Index j = 0; j < symmetric.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(symmetric, j); entry; ++entry) {
      if (entry.row() != j) {
        neighbours.push_back(static_cast<idx_t>(entry.row()));
      }
    }
    begins.push_back(static_cast<idx_t>(neighbours.size()));
  }
  if (neighbours.empty()) return false;
  std::vector<idx_t> order(static_cast<size_t>(size));
  std::vector<idx_t> places(static_cast<size_t>(size));
  if (METIS_NodeND(&size, begins.data(), neighbours.data(), nullptr, nullptr,
                   order.data(), places.data()) != METIS_OK) {
    return false;
  }
  inverse->resize(size);
  for (idx_t i = 0; i < size; ++i) {
    inverse->indices()[i] = static_cast<int>(order[static_cast<size_t>(i)]);
  }
  return true;
}

// Order of elimination with the least fill in the factors. Large models use
// nested dissection (METIS), which halves the factors of minimum degree if the
// model is solid. Small models, and models for which METIS fails, use minimum
// degree (AMD).
struct FillReducingOrdering {
  // Signature required by Eigen.
  void operator()(const SparseMatrix& symmetric,
                  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>&
                      inverse) const {
    if (symmetric.rows() < kNestedFrom ||
        !NestedDissection(symmetric, &inverse)) {
      Eigen::AMDOrdering<int>()(symmetric, inverse);
    }
  }
};

class SimplicialFactor : public SparseFactor {
 public:
  bool Factorise(SparseMatrix symmetric) override {
    solver_.compute(symmetric);
    if (solver_.info() != Eigen::Success) return false;
    pivots_ = solver_.vectorD();
    root_ = pivots_.cwiseAbs().cwiseSqrt();
    return pivots_.allFinite();
  }

  Eigen::Index WeakestDof() const override {
    if (pivots_.size() == 0 || !pivots_.allFinite()) return -1;
    Eigen::Index weakest = 0;
    pivots_.minCoeff(&weakest);
    return solver_.permutationPinv().indices()[weakest];
  }

  Matrix Solve(const Matrix& right) const override {
    return solver_.solve(right);
  }

  Matrix SolveLower(const Matrix& right) const override {
    Matrix y = solver_.permutationP() * right;
    solver_.matrixL().solveInPlace(y);
    return root_.cwiseInverse().asDiagonal() * y;
  }

  Matrix SolveUpper(const Matrix& right) const override {
    Matrix x = root_.cwiseInverse().asDiagonal() * right;
    solver_.matrixU().solveInPlace(x);
    return solver_.permutationPinv() * x;
  }

 private:
  Eigen::SimplicialLDLT<SparseMatrix, Eigen::Lower, FillReducingOrdering>
      solver_;
  Vector root_;
};

}  // namespace

std::unique_ptr<SparseFactor> MakeSimplicialFactor() {
  return std::make_unique<SimplicialFactor>();
}

std::unique_ptr<SparseFactor> MakeDefiniteFactor(Eigen::Index n) {
#ifdef PINODE_SUPERNODAL
  if (n >= kNestedFrom) return MakeSupernodalFactor();
#endif
  (void)n;
  return MakeSimplicialFactor();
}

}  // namespace pinode
