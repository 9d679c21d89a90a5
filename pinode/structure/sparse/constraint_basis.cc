#include "pinode/structure/sparse/constraint_basis.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/structure/model/symmetric.h"
#include "pinode/structure/sparse/modes_from_factors.h"
#include "pinode/structure/sparse/sparse_modes.h"

namespace pinode {
namespace {

// Returns the rows and columns of the other DOFs. *coupling receives the
// columns of the kept DOFs in the others' rows.
SparseMatrix OthersBlock(const SparseMatrix& matrix, const Partition& partition,
                         Matrix* coupling) {
  std::vector<int> kept_place(static_cast<size_t>(matrix.rows()), -1);
  std::vector<int> other_place(static_cast<size_t>(matrix.rows()), -1);
  for (size_t i = 0; i < partition.kept.size(); ++i) {
    kept_place[static_cast<size_t>(partition.kept[i])] = static_cast<int>(i);
  }
  for (size_t i = 0; i < partition.others.size(); ++i) {
    other_place[static_cast<size_t>(partition.others[i])] = static_cast<int>(i);
  }
  const auto size = static_cast<Eigen::Index>(partition.others.size());
  *coupling =
      Matrix::Zero(size, static_cast<Eigen::Index>(partition.kept.size()));
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index j = 0; j < matrix.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(matrix, j); entry; ++entry) {
      const int row = other_place[static_cast<size_t>(entry.row())];
      if (row < 0) continue;
      const int column = other_place[static_cast<size_t>(j)];
      if (column >= 0) {
        entries.emplace_back(row, column, entry.value());
      } else {
        (*coupling)(row, kept_place[static_cast<size_t>(j)]) += entry.value();
      }
    }
  }
  SparseMatrix block(size, size);
  block.setFromTriplets(entries.begin(), entries.end());
  return block;
}

// Returns a DOF that moves if a matrix is not positive definite: the one that
// yields most to forces. A small amount is added to the diagonal first, so that
// the factors exist.
int LooseDof(const SparseMatrix& stiffness) {
  SparseMatrix little(stiffness.rows(), stiffness.rows());
  little.setIdentity();
  Matrix force(stiffness.rows(), 1);
  for (Eigen::Index i = 0; i < stiffness.rows(); ++i) {
    const double own = std::abs(stiffness.coeff(i, i));
    if (own > 0.0) little.coeffRef(i, i) = own;
    force(i, 0) = std::sin(1.0 + static_cast<double>(i));
  }
  ShiftedFactors factors;
  if (!factors.Factorise(little, stiffness, -1e-10)) return 0;
  Eigen::Index loosest = 0;
  factors.Solve(force).col(0).cwiseAbs().maxCoeff(&loosest);
  return static_cast<int>(loosest);
}

Eigen::Index NumWithMass(const FiniteElementModel& model,
                         const std::vector<int>& dofs) {
  const Vector diagonal = model.mass.diagonal();
  return std::count_if(dofs.begin(), dofs.end(),
                       [&](int dof) { return diagonal[dof] > 0.0; });
}

bool HasAll(const SparseModes& held, int num_modes, std::string* error) {
  if (held.eigenvalues.size() == num_modes) return true;
  *error = std::to_string(num_modes) +
           " modes with the kept DOFs held are asked for, and there are " +
           std::to_string(held.eigenvalues.size());
  return false;
}

// Finds the shapes that unit displacements of the kept DOFs cause, by the
// flexibility of the whole, positive definite K. Returns false if the kept DOFs
// are linked so rigidly that rounding is left of their own flexibility.
bool ConstraintShapes(const SparseMatrix& stiffness,
                      const std::vector<int>& kept,
                      const ShiftedFactors& factors, Matrix* result) {
  // Largest error of a unit displacement before it is set.
  constexpr double kLargestError = 1e-8;

  const auto m = static_cast<Eigen::Index>(kept.size());
  const auto at_kept = [&](const Matrix& shapes) {
    Matrix rows(m, shapes.cols());
    for (Eigen::Index i = 0; i < m; ++i) {
      rows.row(i) = shapes.row(kept[static_cast<size_t>(i)]);
    }
    return rows;
  };
  Matrix forces = Matrix::Zero(stiffness.rows(), m);
  for (Eigen::Index i = 0; i < m; ++i) {
    forces(kept[static_cast<size_t>(i)], i) = 1.0;
  }
  const Matrix flexible = factors.Solve(forces);
  // Translations and rotations are brought to one size.
  const Matrix flexibility = SymmetricPart(at_kept(flexible));
  const Vector scale = flexibility.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LDLT<Matrix> solver(
      Matrix(scale.asDiagonal() * flexibility * scale.asDiagonal()));
  // Shapes that displace the kept DOFs like the columns of `rows`.
  const auto displaced = [&](const Matrix& rows) -> Matrix {
    const Matrix scaled = scale.asDiagonal() * rows;
    Matrix forces = solver.solve(scaled);
    forces = scale.asDiagonal() * forces;
    return flexible * forces;
  };
  Matrix shapes = displaced(Matrix::Identity(m, m));
  // Each step takes away the rounding of the one before, which is large if the
  // kept DOFs lie close together.
  for (int step = 0; step < 2; ++step) {
    Matrix rest = stiffness * shapes;
    for (const int dof : kept) rest.row(dof).setZero();
    rest = factors.Solve(rest);
    shapes -= rest - displaced(at_kept(rest));
  }
  const double error =
      (at_kept(shapes) - Matrix::Identity(m, m)).cwiseAbs().maxCoeff();
  if (!shapes.allFinite() || !(error <= kLargestError)) return false;
  for (Eigen::Index i = 0; i < m; ++i) {
    shapes.row(kept[static_cast<size_t>(i)]) = Matrix::Identity(m, m).row(i);
  }
  result->swap(shapes);
  return true;
}

// Appends `num_modes` columns of modes with the kept DOFs held to the
// constraint shapes, from `factors` of the whole, positive definite K.
bool BasisOfWhole(const FiniteElementModel& model, const Partition& partition,
                  int num_modes, const Matrix& shapes,
                  std::unique_ptr<ShiftedFactors> factors, Matrix* basis,
                  std::string* error) {
  const auto num_kept = static_cast<Eigen::Index>(partition.kept.size());
  basis->resize(model.num_dofs(), num_kept + num_modes);
  basis->leftCols(num_kept) = shapes;
  if (num_modes == 0) return true;
  SparseModes held;
  if (!ModesFromFactors(model.mass, model.stiffness, partition.kept, num_modes,
                        &factors, &held, error) ||
      !HasAll(held, num_modes, error)) {
    return false;
  }
  basis->rightCols(num_modes) = held.mode_shapes;
  return true;
}

// The same with factors of the part of K that the other DOFs have.
bool BasisOfOthers(const FiniteElementModel& model, const Partition& partition,
                   int num_modes, Matrix* basis, std::string* error) {
  const auto num_kept = static_cast<Eigen::Index>(partition.kept.size());
  const auto num_others = static_cast<Eigen::Index>(partition.others.size());
  *basis = Matrix::Zero(model.num_dofs(), num_kept + num_modes);
  for (Eigen::Index i = 0; i < num_kept; ++i) {
    (*basis)(partition.kept[static_cast<size_t>(i)], i) = 1.0;
  }
  if (num_others == 0) return true;
  Matrix coupling;
  Matrix unused;
  const SparseMatrix stiffness =
      OthersBlock(model.stiffness, partition, &coupling);
  const SparseMatrix mass = OthersBlock(model.mass, partition, &unused);
  Matrix followers(num_others, num_kept + num_modes);
  auto factors = std::make_unique<ShiftedFactors>();
  if (!factors->FactoriseDefinite(mass, stiffness, 0.0)) {
    const int loose = LooseDof(stiffness);
    *error =
        "with the kept DOFs held, the others can still move without "
        "stiffness or against a negative one (" +
        model.dof_names[static_cast<size_t>(
            partition.others[static_cast<size_t>(loose)])] +
        " takes part); keep more of them";
    return false;
  }
  // The second solution takes the rounding of the first away, which would
  // couple rigid-body motions with the others.
  Matrix followed = -factors->Solve(coupling);
  followed -= factors->Solve(stiffness * followed + coupling);
  followers.leftCols(num_kept) = followed;
  if (num_modes > 0) {
    SparseModes held;
    if (!ModesFromFactors(mass, stiffness, {}, num_modes, &factors, &held,
                          error) ||
        !HasAll(held, num_modes, error)) {
      return false;
    }
    followers.rightCols(num_modes) = held.mode_shapes;
  }
  for (Eigen::Index i = 0; i < num_others; ++i) {
    basis->row(partition.others[static_cast<size_t>(i)]) = followers.row(i);
  }
  return true;
}

}  // namespace

bool ConstraintBasis(const FiniteElementModel& model,
                     const Partition& partition, int num_modes,
                     std::unique_ptr<ShiftedFactors> factors, Matrix* basis,
                     std::string* error) {
  // If few DOFs are left, or a quarter of their modes is asked for, the part
  // of K that they have is solved at once.
  const auto others = static_cast<Eigen::Index>(partition.others.size());
  Matrix shapes;
  return factors != nullptr && others > kAlwaysDense &&
                 4 * static_cast<Eigen::Index>(num_modes) <=
                     NumWithMass(model, partition.others) &&
                 ConstraintShapes(model.stiffness, partition.kept, *factors,
                                  &shapes)
             ? BasisOfWhole(model, partition, num_modes, shapes,
                            std::move(factors), basis, error)
             : BasisOfOthers(model, partition, num_modes, basis, error);
}

}  // namespace pinode
