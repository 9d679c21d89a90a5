#include "pinode/structure/sparse/reduction.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/structure/model/symmetric.h"
#include "pinode/structure/sparse/constraint_basis.h"
#include "pinode/structure/sparse/modes_from_factors.h"
#include "pinode/structure/sparse/rigid_body.h"
#include "pinode/structure/sparse/shifted_factors.h"
#include "pinode/structure/sparse/sparse_modes.h"

namespace pinode {
namespace {

// Ratio of singular values above which modes at the kept DOFs count as
// independent. Below it, T magnifies rounding and noise a million times.
constexpr double kSmallestObservability = 1e-6;
// Ratio below which a note says so. With 7e-5, for six sensors close together
// on a frame and twelve modes, rounding left 0.3 % of a fit's cost, and the fit
// stalled. Sensors that were chosen by hand had 0.03.
constexpr double kNotedObservability = 1e-3;
// Share of the largest entry below which the entries of a shape are rounding.
constexpr double kRoundingOfShapes = 1e-10;

bool FindKept(const FiniteElementModel& model,
              const std::vector<std::string>& names, Partition* partition,
              std::string* error) {
  std::vector<bool> is_kept(static_cast<size_t>(model.num_dofs()), false);
  for (const std::string& name : names) {
    const int dof = model.DofIndex(name);
    if (dof < 0) {
      // Largest model for which the hint compares every name. It would take too
      // long for larger models.
      constexpr int kHinted = 2000;
      *error = "the kept DOF '" + name + "' does not exist" +
               (model.num_dofs() <= kHinted ? NameHint(name, model.dof_names)
                                            : std::string());
      return false;
    }
    if (is_kept[static_cast<size_t>(dof)]) {
      *error = "the kept DOF '" + name + "' is named twice";
      return false;
    }
    is_kept[static_cast<size_t>(dof)] = true;
    partition->kept.push_back(dof);
  }
  for (int i = 0; i < model.num_dofs(); ++i) {
    if (!is_kept[static_cast<size_t>(i)]) partition->others.push_back(i);
  }
  return true;
}

// Checks that the kept DOFs prevent the rigid-body modes. Otherwise the others
// could not follow them.
bool HoldRigidBody(const FiniteElementModel& model, const Partition& partition,
                   const Matrix& rigid_shapes, std::string* error) {
  const std::vector<int> missing =
      DofsToHold(rigid_shapes, model.mass.diagonal(), partition.kept);
  if (missing.empty()) return true;
  std::vector<std::string> names;
  for (const int dof : missing) {
    names.push_back(model.dof_names[static_cast<size_t>(dof)]);
  }
  const auto num_rigid = static_cast<size_t>(rigid_shapes.cols());
  *error = "nothing holds the model in " + std::to_string(num_rigid) +
           (num_rigid == 1 ? " rigid-body mode" : " rigid-body modes") +
           ", and the kept DOFs hold " +
           std::to_string(num_rigid - missing.size()) +
           " of them; keep DOFs that hold all, such as " + Join(names, ", ") +
           " beside those kept";
  return false;
}

// Computes W of SEREP and modal truncation: modes to coordinates. Its first
// columns move one kept DOF by one and the others not at all, with the smallest
// combination of modes. The other columns move no kept DOF: they are the modes
// of the remaining motion, orthonormal.
bool ModalCoordinates(const Partition& partition, const Matrix& shapes,
                      const Vector& eigenvalues, Matrix* modes_of_coordinates,
                      std::vector<std::string>* notes, std::string* error) {
  const Eigen::Index num_modes = shapes.cols();
  const auto num_kept = static_cast<Eigen::Index>(partition.kept.size());
  if (num_kept > num_modes) {
    *error = "more DOFs are kept (" + std::to_string(num_kept) +
             ") than modes are taken (" + std::to_string(num_modes) +
             ") and could move independently; keep fewer, or take more modes";
    return false;
  }
  Matrix at_kept(num_kept, num_modes);
  Vector size(num_kept);
  for (Eigen::Index i = 0; i < num_kept; ++i) {
    at_kept.row(i) = shapes.row(partition.kept[static_cast<size_t>(i)]);
    size[i] = at_kept.row(i).norm();
  }
  // Rows are scaled to one size, so that the units of translations and
  // rotations do not matter. A DOF that moves by rounding alone does not take
  // part in the modes.
  bool independent =
      size.minCoeff() > kRoundingOfShapes * shapes.cwiseAbs().maxCoeff();
  Eigen::JacobiSVD<Matrix> svd;
  if (independent) {
    svd.compute(size.cwiseInverse().asDiagonal() * at_kept,
                Eigen::ComputeFullU | Eigen::ComputeFullV);
    independent = svd.singularValues()[num_kept - 1] >
                  kSmallestObservability * svd.singularValues()[0];
  }
  if (!independent) {
    *error = "the " + std::to_string(num_modes) +
             " lowest modes do not move the kept DOFs independently; keep "
             "fewer or others, or, by modal truncation, take more modes";
    return false;
  }
  const double ratio =
      svd.singularValues()[num_kept - 1] / svd.singularValues()[0];
  if (ratio < kNotedObservability) {
    notes->push_back(
        "the kept DOFs hardly move independently in " +
        std::to_string(num_modes) + " modes (" + FormatNumber(ratio, 2) +
        " of the largest combination), so that rounding grows and a fit may "
        "stall: keep DOFs farther apart, or take the method modal with more "
        "modes");
  }
  modes_of_coordinates->resize(num_modes, num_modes);
  modes_of_coordinates->leftCols(num_kept) =
      svd.matrixV().leftCols(num_kept) *
      svd.singularValues().cwiseInverse().asDiagonal() *
      svd.matrixU().transpose() * size.cwiseInverse().asDiagonal();
  if (num_kept == num_modes) return true;
  const Matrix still = svd.matrixV().rightCols(num_modes - num_kept);
  const Eigen::SelfAdjointEigenSolver<Matrix> held(
      SymmetricPart(still.transpose() * eigenvalues.asDiagonal() * still));
  Matrix rest = still * held.eigenvectors();
  for (Eigen::Index j = 0; j < rest.cols(); ++j) {
    Eigen::Index largest = 0;
    rest.col(j).cwiseAbs().maxCoeff(&largest);
    if (rest(largest, j) < 0.0) rest.col(j) *= -1.0;
  }
  modes_of_coordinates->rightCols(num_modes - num_kept) = rest;
  return true;
}

// Computes the basis of the lowest modes, and M and K in it without the
// rounding of sums over all DOFs. That rounding would turn a rigid-body mode
// into a mode determined by the last digit.
bool ModalBasis(const Partition& partition, int num_modes,
                ReducedModel* reduced, std::string* error) {
  const SparseModes& whole = reduced->whole_modes;
  if (whole.eigenvalues.size() < num_modes) {
    *error = std::to_string(num_modes) +
             " modes are needed, and the model has " +
             std::to_string(whole.eigenvalues.size());
    return false;
  }
  // Only rounding would determine the combination in a part of them.
  if (num_modes < whole.num_rigid_body_modes) {
    *error = std::to_string(num_modes) + " modes are taken of a model with " +
             std::to_string(whole.num_rigid_body_modes) +
             " rigid-body modes; take these and the elastic ones that matter";
    return false;
  }
  const Matrix shapes = whole.mode_shapes.leftCols(num_modes);
  const Vector eigenvalues = whole.eigenvalues.head(num_modes);
  Matrix w = Matrix::Identity(num_modes, num_modes);
  if (!partition.kept.empty() &&
      !ModalCoordinates(partition, shapes, eigenvalues, &w, &reduced->notes,
                        error)) {
    return false;
  }
  reduced->basis = shapes * w;
  const Matrix coordinates_of_modes =
      w.fullPivLu().solve(Matrix::Identity(num_modes, num_modes));
  reduced->rigid_body_motions.resize(num_modes, whole.num_rigid_body_modes);
  for (int i = 0, next = 0; i < num_modes; ++i) {
    if (eigenvalues[i] != 0.0) continue;
    reduced->rigid_body_motions.col(next++) = coordinates_of_modes.col(i);
  }
  reduced->mass = SymmetricPart(w.transpose() * w);
  reduced->stiffness = WithoutResistance(
      SymmetricPart(w.transpose() * eigenvalues.asDiagonal() * w),
      reduced->rigid_body_motions);
  return true;
}

// Relative tolerance for equal frequencies. If modes first .. last - 1 of the
// whole model have one frequency, any combination of them is a mode too.
constexpr double kSameFrequency = 1e-6;

// Share of an elastic frequency that may be rounding of zero. Its square
// applies to eigenvalues.
constexpr double kRounding = 1e-5;

int ClusterEnd(const Vector& eigenvalues, int first, int count) {
  int last = first + 1;
  while (last < count && eigenvalues[last] - eigenvalues[last - 1] <=
                             kSameFrequency * std::abs(eigenvalues[last])) {
    ++last;
  }
  return last;
}

// Returns the squared cosine between a shape and the space of some others. With
// one shape it is the MAC.
double MacOfSpace(const Vector& shape, const Matrix& space) {
  const Vector coordinates = space.householderQr().solve(shape);
  const Vector nearest = space * coordinates;
  return Mac(shape, nearest);
}

// Computes the error of the reduction.
bool Compare(int count, ReducedModel* reduced, std::string* error) {
  const SparseModes& whole = reduced->whole_modes;
  const SparseMatrix mass = reduced->mass.sparseView(0.0, 0.0);
  const SparseMatrix stiffness = reduced->stiffness.sparseView(0.0, 0.0);
  SparseModes modes;
  // More modes than are compared, because the best partner of a mode may have
  // another position.
  const int candidates =
      std::min(2 * count, static_cast<int>(reduced->mass.rows()));
  if (!ComputeLowestModes(mass, stiffness, candidates, &modes, error)) {
    *error = "the reduced model has no modes of use: " + *error;
    return false;
  }
  count = std::min({count, static_cast<int>(whole.eigenvalues.size()),
                    static_cast<int>(modes.eigenvalues.size())});
  const Matrix expanded = reduced->basis * modes.mode_shapes;
  const std::vector<int> partner =
      PairModes(whole.mode_shapes.leftCols(count), expanded);
  reduced->frequency_error.resize(count);
  reduced->mac.resize(count);
  // The lowest elastic eigenvalue of the whole model; 0: none is compared.
  double elastic = 0.0;
  for (int i = count - 1; i >= 0; --i) {
    if (whole.frequency_hz[i] > 0.0) elastic = whole.eigenvalues[i];
  }
  for (int i = 0; i < count; ++i) {
    const double exact = whole.frequency_hz[i];
    const double found = modes.frequency_hz[partner[static_cast<size_t>(i)]];
    double relative = (found - exact) / exact;
    if (exact == 0.0) {
      // Rounding in the products of the reduced matrices gives a rigid body a
      // small stiffness of either sign.
      const double left = modes.eigenvalues[partner[static_cast<size_t>(i)]];
      relative = std::abs(left) <= kRounding * elastic
                     ? 0.0
                     : std::numeric_limits<double>::quiet_NaN();
    }
    reduced->frequency_error[i] = relative;
  }
  for (int first = 0; first < count;) {
    const int last = ClusterEnd(whole.eigenvalues, first, count);
    Matrix space(expanded.rows(), last - first);
    for (int i = first; i < last; ++i) {
      space.col(i - first) = expanded.col(partner[static_cast<size_t>(i)]);
    }
    for (int i = first; i < last; ++i) {
      reduced->mac[i] = MacOfSpace(whole.mode_shapes.col(i), space);
    }
    first = last;
  }
  return true;
}

bool CheckOptions(const FiniteElementModel& model,
                  const ReductionOptions& options, std::string* error) {
  const bool modal = options.method == ReductionMethod::kModal;
  const bool uses_modes =
      modal || options.method == ReductionMethod::kCraigBampton;
  if (!modal && options.kept_dofs.empty()) {
    *error = "no kept DOFs are named, expected at least one";
    return false;
  }
  const int least = modal ? 1 : 0;
  if (options.num_modes < least || (!uses_modes && options.num_modes > 0)) {
    *error = std::to_string(options.num_modes) +
             " modes are asked for, expected " +
             (uses_modes ? "at least " + std::to_string(least)
                         : std::string("none")) +
             " of this method";
    return false;
  }
  if (options.num_compared_modes < 1) {
    *error = std::to_string(options.num_compared_modes) +
             " modes are to be compared, expected at least 1";
    return false;
  }
  if (options.num_modes > model.num_dofs()) {
    *error = std::to_string(options.num_modes) + " modes are asked of " +
             std::to_string(model.num_dofs()) + " DOFs";
    return false;
  }
  return true;
}

// Returns "q", unless a kept DOF has such a name.
std::string ModePrefix(const ReductionOptions& options) {
  std::string prefix = "q";
  for (int i = 1; i <= options.num_modes; ++i) {
    for (const std::string& name : options.kept_dofs) {
      if (name == prefix + std::to_string(i)) {
        prefix += "q";
        i = 0;
        break;
      }
    }
  }
  return prefix;
}

// Computes at least `needed` modes, and the first elastic one. *factors are
// those of K if it is positive definite, otherwise nullptr.
bool ModesOfWhole(const FiniteElementModel& model, int needed,
                  std::unique_ptr<ShiftedFactors>* factors, SparseModes* whole,
                  std::string* error) {
  for (int count = std::min(needed, model.num_dofs());;) {
    if (!ModesFromFactors(model.mass, model.stiffness, {}, count, factors,
                          whole, error)) {
      return false;
    }
    const auto found = static_cast<int>(whole->eigenvalues.size());
    if (whole->num_rigid_body_modes < found || found < count ||
        count == model.num_dofs()) {
      return true;
    }
    count = std::min(count + std::max(count, 6), model.num_dofs());
  }
}

// Computes T of Guyan or of Craig and Bampton, and M, K and the rigid-body
// modes in it.
bool ReduceByConstraints(const FiniteElementModel& model,
                         const Partition& partition, int num_modes,
                         std::unique_ptr<ShiftedFactors> factors,
                         ReducedModel* reduced, std::string* error) {
  const Matrix rigid_shapes = RigidBodyShapes(reduced->whole_modes);
  if (!HoldRigidBody(model, partition, rigid_shapes, error) ||
      !ConstraintBasis(model, partition, num_modes, std::move(factors),
                       &reduced->basis, error)) {
    return false;
  }
  // In a rigid-body motion the others follow the kept DOFs, so no mode of
  // theirs takes part.
  reduced->rigid_body_motions =
      Matrix::Zero(reduced->basis.cols(), rigid_shapes.cols());
  for (size_t i = 0; i < partition.kept.size(); ++i) {
    reduced->rigid_body_motions.row(static_cast<Eigen::Index>(i)) =
        rigid_shapes.row(partition.kept[i]);
  }
  reduced->mass = ReduceMatrix(model.mass, reduced->basis);
  reduced->stiffness =
      WithoutResistance(ReduceMatrix(model.stiffness, reduced->basis),
                        reduced->rigid_body_motions);
  return true;
}

bool Reduce(const FiniteElementModel& model, const ReductionOptions& options,
            ReducedModel* reduced, std::string* error) {
  Partition partition;
  if (!CheckOptions(model, options, error) ||
      !FindKept(model, options.kept_dofs, &partition, error)) {
    return false;
  }
  const int num_kept = static_cast<int>(partition.kept.size());
  ReducedModel result;
  const bool modal = options.method == ReductionMethod::kModal ||
                     options.method == ReductionMethod::kSerep;
  const int num_modes =
      options.method == ReductionMethod::kSerep ? num_kept : options.num_modes;
  const int needed =
      std::max(options.num_compared_modes, modal ? num_modes : 0);
  std::unique_ptr<ShiftedFactors> factors;
  if (!ModesOfWhole(model, needed, &factors, &result.whole_modes, error)) {
    return false;
  }
  result.coordinate_names = options.kept_dofs;
  result.kept_dofs = partition.kept;
  const bool done =
      modal ? ModalBasis(partition, num_modes, &result, error)
            : ReduceByConstraints(model, partition, num_modes,
                                  std::move(factors), &result, error);
  if (!done) return false;
  const std::string prefix = ModePrefix(options);
  for (int i = 1; num_kept + i <= result.basis.cols(); ++i) {
    result.coordinate_names.push_back(prefix + std::to_string(i));
  }
  result.damping =
      model.has_damping()
          ? ReduceMatrix(model.damping, result.basis, result.rigid_body_motions)
          : Matrix(0.0 * result.mass);
  if (!Compare(options.num_compared_modes, &result, error)) return false;
  if (result.mass.llt().info() != Eigen::Success) {
    result.notes.push_back(
        "the reduced mass matrix is singular: a kept DOF carries no mass and "
        "takes none from the others; keep one that does");
  }
  *reduced = std::move(result);
  return true;
}

}  // namespace

Matrix ReduceMatrix(const SparseMatrix& matrix, const Matrix& basis) {
  CHECK_EQ(matrix.rows(), basis.rows()) << "the basis has a row for each DOF";
  CHECK_EQ(matrix.cols(), basis.rows()) << "the basis has a row for each DOF";
  return SymmetricPart(basis.transpose() * Matrix(matrix * basis));
}

ReducedInfluence ReduceInfluence(const FiniteElementModel& model,
                                 const ReducedModel& reduced,
                                 const Matrix& influence) {
  CHECK_EQ(influence.rows(), model.num_dofs())
      << "r has a row for each DOF of the whole model";
  ReducedInfluence result;
  result.influence = Matrix::Zero(reduced.basis.cols(), influence.cols());
  for (size_t i = 0; i < reduced.kept_dofs.size(); ++i) {
    result.influence.row(static_cast<Eigen::Index>(i)) =
        influence.row(reduced.kept_dofs[i]);
  }
  result.support_mass_coupling =
      reduced.basis.transpose() * Matrix(model.mass * influence) -
      reduced.mass * result.influence;
  return result;
}

bool ReduceModel(const FiniteElementModel& model,
                 const ReductionOptions& options, ReducedModel* reduced,
                 std::string* error) {
  CHECK(reduced != nullptr);
  CHECK(error != nullptr);
  // The factorisation throws if memory runs out.
  try {
    return Reduce(model, options, reduced, error);
  } catch (const std::exception& problem) {
    *error = std::string("reduction: ") + problem.what();
    return false;
  }
}

}  // namespace pinode
