#include "pinode/structure/sparse/finite_element_model.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/model/symmetric.h"
#include "pinode/structure/sparse/sparse_factor.h"

namespace pinode {
namespace {

// Eigenvalues of M above minus this, relative to a unit diagonal, count as
// rounding of the export.
constexpr double kDefinitenessTolerance = 1e-10;

// Part of a product below which it is rounding.
constexpr double kRoundingOfSteps = 1e-10;

// "2.1, 2.2, 2.3 and 20 more".
std::string SomeNames(const std::vector<std::string>& names,
                      const std::vector<int>& dofs) {
  constexpr size_t kShown = 5;
  std::vector<std::string> shown;
  for (size_t i = 0; i < std::min(kShown, dofs.size()); ++i) {
    shown.push_back(names[static_cast<size_t>(dofs[i])]);
  }
  std::string text = Join(shown, ", ");
  if (dofs.size() > kShown) {
    text += " and " + std::to_string(dofs.size() - kShown) + " more";
  }
  return text;
}

std::string DofCount(const std::vector<int>& dofs) {
  return dofs.size() == 1 ? "1 DOF" : std::to_string(dofs.size()) + " DOFs";
}

// "name (a, b)" of an entry of a matrix.
std::string EntryName(const std::string& matrix,
                      const std::vector<std::string>& names, Eigen::Index row,
                      Eigen::Index column) {
  return matrix + "(" + names[static_cast<size_t>(row)] + ", " +
         names[static_cast<size_t>(column)] + ")";
}

bool CheckMatrix(const std::string& name, const SparseMatrix& matrix,
                 const std::vector<std::string>& names, std::string* error) {
  const auto n = static_cast<Eigen::Index>(names.size());
  if (matrix.rows() != n || matrix.cols() != n) {
    *error = name + " is " + std::to_string(matrix.rows()) + " x " +
             std::to_string(matrix.cols()) + ", expected " + std::to_string(n) +
             " x " + std::to_string(n) + ", a row and a column for each DOF";
    return false;
  }
  const Vector diagonal = matrix.diagonal();
  // Column j of the transpose beside column j of the matrix.
  const SparseMatrix transpose = matrix.transpose();
  for (Eigen::Index j = 0; j < n; ++j) {
    SparseMatrix::InnerIterator entry(matrix, j);
    SparseMatrix::InnerIterator mirrored(transpose, j);
    while (entry || mirrored) {
      const bool has_entry =
          entry && (!mirrored || entry.row() <= mirrored.row());
      const bool has_mirrored =
          mirrored && (!entry || mirrored.row() <= entry.row());
      const Eigen::Index i = has_entry ? entry.row() : mirrored.row();
      const double a = has_entry ? entry.value() : 0.0;
      const double b = has_mirrored ? mirrored.value() : 0.0;
      if (!std::isfinite(a) || !std::isfinite(b)) {
        *error = EntryName(name, names, i, j) +
                 " or its mirror image is not a finite number";
        return false;
      }
      if (a != b) {
        const double scale = std::max({std::abs(a), std::abs(b),
                                       std::sqrt(std::abs(diagonal[i])) *
                                           std::sqrt(std::abs(diagonal[j]))});
        if (std::abs(a / scale - b / scale) > kSymmetryTolerance) {
          *error = name + " is not symmetric: " + EntryName("", names, i, j) +
                   " is " + FormatNumber(a) + " and " +
                   EntryName("", names, j, i) + " is " + FormatNumber(b) +
                   "; export a symmetric matrix, or use (A + A') / 2 if it "
                   "means this";
          return false;
        }
      }
      if (has_entry) ++entry;
      if (has_mirrored) ++mirrored;
    }
  }
  return true;
}

// Returns true if the diagonal outweighs each row. A matrix is then positive
// semidefinite. This holds for lumped masses and costs little.
bool IsDiagonallyDominant(const SparseMatrix& matrix) {
  Vector off_diagonal = Vector::Zero(matrix.rows());
  Vector diagonal = Vector::Zero(matrix.rows());
  for (Eigen::Index j = 0; j < matrix.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(matrix, j); entry; ++entry) {
      if (entry.row() == j) {
        diagonal[j] += entry.value();
      } else {
        off_diagonal[j] += std::abs(entry.value());
      }
    }
  }
  return (diagonal.array() >= off_diagonal.array()).all();
}

// Returns true if a matrix is positive definite, as far as a few products show.
// Consistent masses of solids have a smallest eigenvalue of 0.1 beside their
// diagonal, whatever the mesh, and take a fiftieth of the work of factors. A
// matrix that is nearer to singular needs factors.
//
// The largest eigenvalue of `bound` I - A is sought by Lanczos steps from a
// random start. Were it `bound` or more, so that A is not positive definite, k
// steps would leave a relative error e with a probability of at most 1.648
// sqrt(n) exp(-(2 k - 1) sqrt(e)) (J. Kuczynski, H. Wozniakowski, Estimating
// the largest eigenvalue by the power and Lanczos algorithms with a random
// start, SIAM J. Matrix Anal. 13, 1992, theorem 4.2).
bool IsClearlyDefinite(const SparseMatrix& matrix) {
  constexpr int kMostSteps = 120;
  constexpr double kProbability = 1e-9;

  const Eigen::Index n = matrix.cols();
  const double bound = (matrix.cwiseAbs() * Vector::Ones(n)).maxCoeff();
  std::mt19937 generator;
  std::normal_distribution<double> normal;
  Vector before = Vector::Zero(n);
  Vector here = Vector::NullaryExpr(n, [&] { return normal(generator); });
  here.normalize();
  Vector diagonal(kMostSteps);
  Vector beside(kMostSteps);
  for (int k = 1; k <= kMostSteps; ++k) {
    Vector image = bound * here - matrix * here;
    if (k > 1) image -= beside[k - 2] * before;
    diagonal[k - 1] = here.dot(image);
    image -= diagonal[k - 1] * here;
    beside[k - 1] = image.norm();
    // The start leads nowhere else, as in small or regular matrices.
    if (beside[k - 1] <= kRoundingOfSteps * bound) return false;
    if (k % 10 == 0) {
      Eigen::SelfAdjointEigenSolver<Matrix> solver;
      solver.computeFromTridiagonal(diagonal.head(k), beside.head(k - 1),
                                    Eigen::EigenvaluesOnly);
      const double smallest = bound - solver.eigenvalues()[k - 1];
      if (!(smallest > 0.0)) return false;
      const double doubt =
          1.648 * std::sqrt(static_cast<double>(n)) *
          std::exp(-(2.0 * k - 1.0) * std::sqrt(smallest / bound));
      if (doubt <= kProbability) return true;
    }
    before = here;
    here = image / beside[k - 1];
  }
  return false;
}

bool CheckMass(const SparseMatrix& mass, const std::vector<std::string>& names,
               std::string* error) {
  const Vector diagonal = mass.diagonal();
  Vector scale = Vector::Ones(mass.rows());
  for (Eigen::Index j = 0; j < mass.rows(); ++j) {
    if (diagonal[j] < 0.0) {
      *error = EntryName("the mass matrix is not positive semidefinite: M",
                         names, j, j) +
               " is " + FormatNumber(diagonal[j]) + ", expected at least 0";
      return false;
    }
    if (diagonal[j] > 0.0) scale[j] = 1.0 / std::sqrt(diagonal[j]);
  }
  for (Eigen::Index j = 0; j < mass.outerSize(); ++j) {
    for (SparseMatrix::InnerIterator entry(mass, j); entry; ++entry) {
      if (entry.value() != 0.0 && diagonal[j] == 0.0) {
        *error = EntryName("the mass matrix is not positive semidefinite: M",
                           names, entry.row(), j) +
                 " is " + FormatNumber(entry.value()) +
                 " beside a zero diagonal at " + names[static_cast<size_t>(j)];
        return false;
      }
    }
  }
  if (IsDiagonallyDominant(mass)) return true;

  SparseMatrix scaled = scale.asDiagonal() * mass * scale.asDiagonal();
  // Massless DOFs get any positive pivot, because they do not matter here.
  SparseMatrix massless(mass.rows(), mass.cols());
  for (Eigen::Index j = 0; j < mass.rows(); ++j) {
    if (diagonal[j] == 0.0) massless.insert(j, j) = 1.0;
  }
  scaled += massless;
  if (IsClearlyDefinite(scaled)) return true;
  SparseMatrix little(mass.rows(), mass.cols());
  little.setIdentity();
  scaled += kDefinitenessTolerance * little;
  const std::unique_ptr<SparseFactor> factor =
      MakeDefiniteFactor(scaled.rows());
  if (!factor->Factorise(std::move(scaled)) ||
      !(factor->pivots().minCoeff() > 0.0)) {
    const Eigen::Index weakest = factor->WeakestDof();
    *error = "the mass matrix is not positive semidefinite: a motion" +
             (weakest < 0 ? std::string()
                          : " in which " + names[static_cast<size_t>(weakest)] +
                                " takes part") +
             " has a negative kinetic energy; check the export";
    return false;
  }
  return true;
}

}  // namespace

int FiniteElementModel::DofIndex(const std::string& name) const {
  const auto found = std::find(dof_names.begin(), dof_names.end(), name);
  return found == dof_names.end() ? -1
                                  : static_cast<int>(found - dof_names.begin());
}

bool FiniteElementModel::IsValid(std::string* error,
                                 const SparseMatrix** culprit) const {
  CHECK(error != nullptr);
  const SparseMatrix* ignored = nullptr;
  if (culprit == nullptr) culprit = &ignored;
  *culprit = nullptr;
  if (dof_names.empty()) {
    *error = "the model has no DOFs";
    return false;
  }
  std::unordered_set<std::string> seen;
  for (size_t i = 0; i < dof_names.size(); ++i) {
    if (dof_names[i].empty()) {
      *error = "DOF " + std::to_string(i + 1) + " has no name";
      return false;
    }
    if (!seen.insert(dof_names[i]).second) {
      *error = "two DOFs are called '" + dof_names[i] +
               "', expected unique names (NumberRepeatedNames makes them)";
      return false;
    }
  }
  *culprit = &mass;
  if (!CheckMatrix("M", mass, dof_names, error)) return false;
  *culprit = &stiffness;
  if (!CheckMatrix("K", stiffness, dof_names, error)) return false;
  *culprit = &damping;
  if (has_damping() && !CheckMatrix("C", damping, dof_names, error)) {
    return false;
  }
  *culprit = &mass;
  if (!CheckMass(mass, dof_names, error)) return false;
  *culprit = nullptr;
  std::vector<bool> used(dof_names.size(), false);
  for (const SparseMatrix* matrix : {&mass, &stiffness}) {
    for (Eigen::Index j = 0; j < matrix->outerSize(); ++j) {
      for (SparseMatrix::InnerIterator entry(*matrix, j); entry; ++entry) {
        if (entry.value() != 0.0) used[static_cast<size_t>(j)] = true;
      }
    }
  }
  std::vector<int> unused;
  for (size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) unused.push_back(static_cast<int>(i));
  }
  if (!unused.empty()) {
    *error = DofCount(unused) + " without mass and without stiffness (" +
             SomeNames(dof_names, unused) +
             "), whose motion nothing determines; constrain or remove them";
    return false;
  }
  return true;
}

std::vector<std::string> NumberRepeatedNames(std::vector<std::string> names,
                                             std::vector<std::string>* notes) {
  CHECK(notes != nullptr);
  std::unordered_map<std::string, int> count;
  for (const std::string& name : names) ++count[name];
  std::unordered_map<std::string, int> seen;
  std::vector<std::string> repeated;  // in the order of the rows
  for (std::string& name : names) {
    if (count[name] == 1) continue;
    const int number = ++seen[name];
    if (number == 1) repeated.push_back(name);
    std::string numbered = name + "#" + std::to_string(number);
    // A file may have `a#1` in addition to two `a`. These must not be merged
    // either.
    while (count.count(numbered) > 0) numbered += "'";
    name = std::move(numbered);
  }
  if (repeated.empty()) return names;
  constexpr size_t kShown = 3;
  std::vector<std::string> shown;
  for (size_t i = 0; i < std::min(kShown, repeated.size()); ++i) {
    shown.push_back(repeated[i] + " (" + std::to_string(count[repeated[i]]) +
                    " times)");
  }
  notes->push_back(std::to_string(repeated.size()) +
                   " DOF names occur more than once: " + Join(shown, ", ") +
                   (repeated.size() > kShown ? ", ..." : "") +
                   ". They are different DOFs, for instance of beams that the "
                   "program expands into solids. Their names are '" +
                   repeated[0] + "#1', '" + repeated[0] +
                   "#2', ... in the order of the rows");
  return names;
}

std::vector<std::string> DefaultDofNames(int num_dofs) {
  std::vector<std::string> names;
  names.reserve(static_cast<size_t>(num_dofs));
  for (int i = 1; i <= num_dofs; ++i) names.push_back("u" + std::to_string(i));
  return names;
}

SpecialDofs FindSpecialDofs(const FiniteElementModel& model) {
  const auto n = static_cast<size_t>(model.num_dofs());
  std::vector<bool> has_mass(n, false);
  std::vector<bool> has_stiffness(n, false);
  std::vector<bool> coupled(n, false);
  const auto look = [&coupled](const SparseMatrix& matrix,
                               std::vector<bool>* has_entry) {
    for (Eigen::Index j = 0; j < matrix.outerSize(); ++j) {
      for (SparseMatrix::InnerIterator entry(matrix, j); entry; ++entry) {
        if (entry.value() == 0.0) continue;
        (*has_entry)[static_cast<size_t>(j)] = true;
        if (entry.row() != j) coupled[static_cast<size_t>(j)] = true;
      }
    }
  };
  look(model.mass, &has_mass);
  look(model.stiffness, &has_stiffness);
  SpecialDofs special;
  for (size_t i = 0; i < n; ++i) {
    const int dof = static_cast<int>(i);
    if (!has_mass[i]) special.massless.push_back(dof);
    if (!has_stiffness[i]) special.unsupported.push_back(dof);
    if (has_stiffness[i] && !coupled[i]) special.uncoupled.push_back(dof);
  }
  return special;
}

std::vector<std::string> DescribeSpecialDofs(const FiniteElementModel& model) {
  const SpecialDofs special = FindSpecialDofs(model);
  std::vector<std::string> sentences;
  if (!special.massless.empty()) {
    sentences.push_back(DofCount(special.massless) + " without mass (" +
                        SomeNames(model.dof_names, special.massless) +
                        "): they follow the others statically and add no "
                        "modes");
  }
  if (!special.uncoupled.empty()) {
    sentences.push_back(DofCount(special.uncoupled) + " coupled to no other (" +
                        SomeNames(model.dof_names, special.uncoupled) +
                        "): probably constrained DOFs, kept in the export with "
                        "a number on the diagonal. Remove them if they have "
                        "mass, or their frequencies appear among the modes");
  }
  if (!special.unsupported.empty()) {
    sentences.push_back(DofCount(special.unsupported) +
                        " with mass but without stiffness (" +
                        SomeNames(model.dof_names, special.unsupported) +
                        "): free to fly, modes at 0 Hz");
  }
  return sentences;
}

FiniteElementModel RemoveDofs(const FiniteElementModel& model,
                              const std::vector<int>& dofs) {
  const int n = model.num_dofs();
  std::vector<bool> removed(static_cast<size_t>(n), false);
  for (const int dof : dofs) {
    CHECK(dof >= 0 && dof < n)
        << "DOF " << dof << " does not exist; the model has " << n;
    removed[static_cast<size_t>(dof)] = true;
  }
  FiniteElementModel rest;
  rest.notes = model.notes;
  std::vector<int> position(static_cast<size_t>(n), -1);
  for (int i = 0; i < n; ++i) {
    if (removed[static_cast<size_t>(i)]) continue;
    position[static_cast<size_t>(i)] = rest.num_dofs();
    rest.dof_names.push_back(model.dof_names[static_cast<size_t>(i)]);
  }
  CHECK_GT(rest.num_dofs(), 0) << "all DOFs would be removed";
  const auto select = [&rest, &position](const SparseMatrix& matrix) {
    std::vector<Eigen::Triplet<double>> entries;
    for (Eigen::Index j = 0; j < matrix.outerSize(); ++j) {
      const int column = position[static_cast<size_t>(j)];
      if (column < 0) continue;
      for (SparseMatrix::InnerIterator entry(matrix, j); entry; ++entry) {
        const int row = position[static_cast<size_t>(entry.row())];
        if (row >= 0) entries.emplace_back(row, column, entry.value());
      }
    }
    SparseMatrix selected(rest.num_dofs(), rest.num_dofs());
    selected.setFromTriplets(entries.begin(), entries.end());
    return selected;
  };
  rest.mass = select(model.mass);
  rest.stiffness = select(model.stiffness);
  if (model.has_damping()) rest.damping = select(model.damping);
  return rest;
}

}  // namespace pinode
