#include "pinode/structure/sparse/sparse_modes.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/sparse/block_lanczos.h"
#include "pinode/structure/sparse/checked_modes.h"
#include "pinode/structure/sparse/dense_modes.h"
#include "pinode/structure/sparse/inverse_operator.h"
#include "pinode/structure/sparse/modes_from_factors.h"
#include "pinode/structure/sparse/shifted_factors.h"

namespace pinode {
namespace {

// Relative width of a cluster of eigenvalues. Eigenvalues are counted above the
// whole cluster.
constexpr double kClusterWidth = 1e-6;
// Operations of the factors above which the eigenvalues are not counted by
// inertia but searched for. The factors of an indefinite matrix are computed
// column by column, some 1e9 operations a second.
constexpr double kMostOperationsOfCount = 2e9;
// Accuracy of the largest eigenvalue beside those found, and its random start,
// which is another than that of the modes.
constexpr double kToleranceOfSearch = 1e-3;
constexpr unsigned kSeedOfSearch = 4711;
// Columns of a block of right sides.
constexpr int kBlock = 4;
// Number of DOFs above which the dense solver takes too much time and memory.
constexpr int kLargestDense = 4000;
// Share of the cancelling parts below which a stiffness depends on the last
// digits of a file.
constexpr double kLastDigits = 1e-9;

// Applies Rayleigh and Ritz to the image of `basis`. One step of inverse
// iteration removes unwanted parts, mainly massless motions.
bool RayleighRitz(const InverseOperator& inverse, const Matrix& basis,
                  InversePairs* pairs, Vector* error_bounds,
                  std::string* error) {
  Matrix image = inverse.Apply(basis);
  image.colwise().normalize();
  const Eigen::HouseholderQR<Matrix> qr(image);
  const Matrix orthonormal =
      qr.householderQ() * Matrix::Identity(basis.rows(), basis.cols());
  image = inverse.Apply(orthonormal);
  const Matrix projected = orthonormal.transpose() * image;
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(
      Matrix(0.5 * (projected + projected.transpose())));
  if (solver.info() != Eigen::Success) {
    *error = "the eigenvalues of the projected model did not converge";
    return false;
  }
  const Matrix rotation = solver.eigenvectors().rowwise().reverse();
  pairs->theta = solver.eigenvalues().reverse();
  pairs->vectors = orthonormal * rotation;
  const Matrix residual =
      image * rotation - pairs->vectors * pairs->theta.asDiagonal();
  *error_bounds =
      residual.colwise().norm().transpose().cwiseQuotient(pairs->theta);
  return true;
}

// Finds `count` eigenvectors of largest theta beside those found.
LargestEigenpairs FurtherPairs(const InverseOperator& inverse,
                               const Matrix& found, int count, double tolerance,
                               unsigned seed) {
  BlockLanczosOptions options;
  options.count = count;
  options.block = kBlock;
  options.tolerance = tolerance;
  options.seed = seed;
  return BlockLanczos(
      inverse.rows(), [&](const Matrix& y) { return inverse.Apply(y); }, found,
      options);
}

// The computation with all its data.
class LowestModes {
 public:
  // `factors`: those of the positive definite K, or nullptr.
  LowestModes(const SparseMatrix& mass, const SparseMatrix& stiffness,
              const std::vector<int>& held, int num_modes,
              std::unique_ptr<ShiftedFactors> factors)
      : model_(mass, stiffness, held, std::move(factors)),
        num_modes_(num_modes) {}

  bool Compute(SparseModes* modes, std::string* error) {
    const int n = static_cast<int>(model_.mass().rows());
    Vector mass_diagonal = model_.mass().diagonal();
    for (const int dof : model_.held()) mass_diagonal[dof] = 0.0;
    const int with_mass =
        static_cast<int>((mass_diagonal.array() > 0.0).count());
    if (with_mass == 0) {
      *error = model_.held().empty()
                   ? "the mass matrix is zero, expected some mass"
                   : "no DOF with mass is left to move, expected one";
      return false;
    }
    bool dense = n <= kAlwaysDense || 4 * num_modes_ > with_mass;
    if (dense && n > kLargestDense) {
      *error = std::to_string(num_modes_) + " modes are asked of " +
               std::to_string(with_mass) +
               " DOFs with mass, expected at most a quarter of them in a model "
               "of more than " +
               std::to_string(kLargestDense) + " DOFs";
      return false;
    }
    if (!model_.ChooseShift(error)) return false;
    // Each step of an iteration by factors of 32 digits takes long.
    dense = dense || model_.factors().IsDoubled();
    is_held_ = model_.shift() == 0.0;
    first_shift_ = model_.shift();
    std::vector<CheckedMode> found;
    if (dense ? !DenseModes(&model_, num_modes_, with_mass, &found, error)
              : !Search(error) || !CheckAll(&found, error)) {
      return false;
    }
    Finish(found, modes);
    return true;
  }

  // The factors of the positive definite K; nullptr if K is not.
  std::unique_ptr<ShiftedFactors> TakeFactors() { return model_.TakeFactors(); }

 private:
  double Eigenvalue(Eigen::Index i) const {
    return model_.shift() + 1.0 / pairs_.theta[i];
  }

  bool IsRigid(Eigen::Index i) const {
    return ShiftedModel::IsRigid(model_.Check(pairs_, i), is_held_);
  }

  // Moves the shift nearer to the modes if its distance is much larger than
  // theirs. Returns true if it moved.
  bool RefineShift() {
    if (model_.shift() == 0.0 || pairs_.theta.size() == 0) return false;
    Eigen::Index last =
        std::min<Eigen::Index>(num_modes_, pairs_.theta.size()) - 1;
    while (last < pairs_.theta.size() && IsRigid(last)) ++last;
    if (last == pairs_.theta.size()) return false;
    const double span = Eigenvalue(last);
    const double least = -1e-12 * model_.unit();
    if (!(span > 0.0) || span > -0.01 * model_.shift() ||
        model_.shift() >= least) {
      return false;
    }
    // So close to zero the factors may be rounding. Then the shift stays.
    return model_.MoveTo(std::min(least, -span));
  }

  // Finds pairs until the count of eigenvalues below a bound agrees.
  bool Search(std::string* error) {
    const Matrix none(model_.mass().rows(), 0);
    Matrix basis = none;
    int wanted = num_modes_ + 2;
    for (int round = 0; round < 12; ++round) {
      const InverseOperator inverse(model_.factors(), model_.mass(),
                                    model_.held_directions());
      const int missing = wanted - static_cast<int>(basis.cols());
      const Matrix further =
          FurtherPairs(inverse, basis, std::max(missing, 2), 1e-10,
                       static_cast<unsigned>(round + 1))
              .vectors;
      Matrix both(basis.rows(), basis.cols() + further.cols());
      both << basis, further;
      basis.swap(both);
      if (basis.cols() == 0) {
        *error = "no mode was found: the Lanczos iteration did not converge";
        return false;
      }
      if (!RayleighRitz(inverse, basis, &pairs_, &residuals_, error)) {
        return false;
      }
      DropUnconverged();
      basis = pairs_.vectors;
      if (RefineShift()) {
        basis = none;
        continue;
      }
      if (pairs_.theta.size() < num_modes_ + 1) {
        continue;  // those not converged, or still missing
      }
      const CountResult result = CheckCount();
      if (result == CountResult::kComplete) return true;
      if (result == CountResult::kCannotCount) {
        *error =
            "the eigenvalues below the last mode cannot be counted: K - s M "
            "has no factors of use";
        return false;
      }
      wanted = static_cast<int>(basis.cols()) + 4;
    }
    *error =
        "only " + std::to_string(pairs_.theta.size()) +
        " of the lowest modes could be computed to 1e-8; ask for fewer, or "
        "check the matrices for extreme entries";
    return false;
  }

  // Keeps the pairs before the first that is not accurate.
  void DropUnconverged() {
    Eigen::Index good = 0;
    while (good < pairs_.theta.size() &&
           residuals_[good] <= kLargestErrorBound) {
      ++good;
    }
    pairs_.theta.conservativeResize(good);
    pairs_.vectors.conservativeResize(Eigen::NoChange, good);
    residuals_.conservativeResize(good);
  }

  // Checks the modes against the matrices, whose factors are rounded.
  bool CheckAll(std::vector<CheckedMode>* modes, std::string* error) const {
    for (Eigen::Index i = 0; i < num_modes_ && i < pairs_.theta.size(); ++i) {
      CheckedMode mode = model_.Check(pairs_, i);
      if (!(mode.bound <= kLargestErrorBound) &&
          !ShiftedModel::IsRigid(mode, is_held_)) {
        *error = "mode " + std::to_string(i + 1) + " has a stiffness of " +
                 FormatNumber(mode.eigenvalue / mode.parts, 1) +
                 " of the terms that cancel in it, which 16 digits do not "
                 "resolve to 1e-8; soften the stiffest links";
        return false;
      }
      modes->push_back(std::move(mode));
    }
    return true;
  }

  enum class CountResult { kComplete, kMissing, kCannotCount };

  // Counts the eigenvalues below a gap behind the last wanted mode.
  CountResult CheckCount() {
    const Eigen::Index found = pairs_.theta.size();
    const Eigen::Index last = std::min<Eigen::Index>(num_modes_, found);
    for (Eigen::Index below = last; below < found; ++below) {
      const double low = Eigenvalue(below - 1);
      const double high = Eigenvalue(below);
      if (!(high - low > kClusterWidth * (high - model_.shift()))) continue;
      // Rigid-body modes form a cluster, whatever their rounded values are.
      if (IsRigid(below)) continue;
      const double between = 1.0 / (0.5 * (low + high) - model_.shift());
      if (model_.factors().Operations() > kMostOperationsOfCount) {
        return SearchMissed(between);
      }
      for (const double part : {0.5, 0.4, 0.6, 0.25, 0.75}) {
        Eigen::Index count = 0;
        if (!CountBelow(low + part * (high - low), &count)) continue;
        return count == below ? CountResult::kComplete : CountResult::kMissing;
      }
      // The factors of an indefinite matrix are not pivoted, and stiff links
      // leave none of their digits.
      return SearchMissed(between);
    }
    return CountResult::kMissing;  // all that was found is one cluster
  }

  // Counts the eigenvalues below `bound` by the inertia of K - bound M. Returns
  // false if its factors are of no use. With DOFs held there are as many as the
  // matrix bordered by their unit forces e has negative eigenvalues, less the
  // number of these DOFs; the border adds the positive eigenvalues of
  // e' (K - bound M)^-1 e (E. Haynsworth, Determination of the inertia of a
  // partitioned Hermitian matrix, Linear Algebra and its Applications 1, 1968).
  bool CountBelow(double bound, Eigen::Index* count) const {
    ShiftedFactors factors;
    if (!factors.Factorise(model_.mass(), model_.stiffness(), bound) ||
        !(factors.SolveError(model_.mass(), model_.stiffness(), bound) <
          1e-6)) {
      return false;
    }
    *count = factors.NumNegative();
    if (model_.held().empty()) return true;
    const Matrix forces = model_.ForcesOnHeld();
    const Matrix flexibility = forces.transpose() * factors.Solve(forces);
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(
        Matrix(0.5 * (flexibility + flexibility.transpose())),
        Eigen::EigenvaluesOnly);
    *count += (solver.eigenvalues().array() > 0.0).count() -
              static_cast<Eigen::Index>(model_.held().size());
    return true;
  }

  // Searches for a theta above `bound` beside the pairs that were found.
  CountResult SearchMissed(double bound) const {
    const InverseOperator inverse(model_.factors(), model_.mass(),
                                  model_.held_directions());
    const LargestEigenpairs rest = FurtherPairs(
        inverse, pairs_.vectors, 1, kToleranceOfSearch, kSeedOfSearch);
    if (rest.values.size() == 0) return CountResult::kComplete;
    if (rest.values[0] > bound) return CountResult::kMissing;
    return rest.residuals[0] <= kToleranceOfSearch ? CountResult::kComplete
                                                   : CountResult::kCannotCount;
  }

  void Finish(const std::vector<CheckedMode>& found, SparseModes* modes) const {
    SparseModes result;
    const int count = static_cast<int>(found.size());
    if (count < num_modes_) {
      result.notes.push_back("the model has " + std::to_string(count) +
                             " modes, " + std::to_string(num_modes_) +
                             " were asked for");
    }
    result.shift = first_shift_;
    result.eigenvalues.resize(count);
    result.frequency_hz.resize(count);
    result.mode_shapes.resize(model_.mass().rows(), count);
    result.error_bounds.resize(count);
    int on_last_digits = 0;
    int perhaps_soft = 0;
    for (int i = 0; i < count; ++i) {
      const CheckedMode& mode = found[static_cast<size_t>(i)];
      double eigenvalue = mode.eigenvalue;
      const bool rigid = ShiftedModel::IsRigid(mode, is_held_);
      const bool on_digits =
          !rigid && std::abs(eigenvalue) <= kLastDigits * mode.parts;
      if (on_digits) ++on_last_digits;
      // The last digits of a file cannot show a negative stiffness either. A
      // small positive one may belong to a slender beam with many elements.
      const bool is_zero = rigid || (on_digits && eigenvalue < 0.0);
      if (is_zero) {
        if (eigenvalue > kRigidIfHeld * mode.parts) ++perhaps_soft;
        eigenvalue = 0.0;
        ++result.num_rigid_body_modes;
      }
      result.eigenvalues[i] = eigenvalue;
      result.frequency_hz[i] = eigenvalue < 0.0
                                   ? std::numeric_limits<double>::quiet_NaN()
                                   : std::sqrt(eigenvalue) / kTwoPi;
      result.mode_shapes.col(i) = mode.shape;
      result.error_bounds[i] = is_zero ? 0.0 : mode.bound;
    }
    if (result.num_rigid_body_modes > 0) {
      result.notes.push_back(std::to_string(result.num_rigid_body_modes) +
                             " rigid-body modes at 0 Hz: nothing holds the "
                             "structure there");
    }
    if (perhaps_soft > 0) {
      result.notes.push_back(
          std::to_string(perhaps_soft) +
          " of the modes at 0 Hz have a stiffness of 1e-14 to 1e-12 of the "
          "terms that cancel in it: rounding of a file, or soft modes beside "
          "stiff links. Soften the links to see which");
    }
    if (on_last_digits > 0) {
      result.notes.push_back(
          "the stiffness of " + std::to_string(on_last_digits) +
          " modes is less than 1e-9 of the terms that cancel in it. With fewer "
          "than 16 digits in the file, such frequencies are noise or zero "
          "frequencies of rigid bodies");
    }
    *modes = std::move(result);
  }

  ShiftedModel model_;
  const int num_modes_;
  bool is_held_ = false;  // K is positive definite
  double first_shift_ = 0.0;
  InversePairs pairs_;
  Vector residuals_;  // of the pairs, in parts of theta
};

}  // namespace

bool ComputeLowestModes(const SparseMatrix& mass, const SparseMatrix& stiffness,
                        int num_modes, SparseModes* modes, std::string* error) {
  std::unique_ptr<ShiftedFactors> factors;
  return ModesFromFactors(mass, stiffness, {}, num_modes, &factors, modes,
                          error);
}

bool ModesFromFactors(const SparseMatrix& mass, const SparseMatrix& stiffness,
                      const std::vector<int>& held, int num_modes,
                      std::unique_ptr<ShiftedFactors>* factors,
                      SparseModes* modes, std::string* error) {
  CHECK(held.empty() || *factors != nullptr)
      << "held DOFs need factors of K itself";
  CHECK(modes != nullptr);
  CHECK(error != nullptr);
  CHECK_GT(num_modes, 0) << "ask for at least one mode";
  const Eigen::Index n = mass.rows();
  CHECK(n > 0 && mass.cols() == n && stiffness.rows() == n &&
        stiffness.cols() == n)
      << "M is " << mass.rows() << " x " << mass.cols() << ", K "
      << stiffness.rows() << " x " << stiffness.cols()
      << "; both must be square, of the same size and not empty";
  bool success = false;
  // The factorisation throws if memory runs out.
  try {
    LowestModes computation(mass, stiffness, held, num_modes,
                            std::move(*factors));
    success = computation.Compute(modes, error);
    *factors = computation.TakeFactors();
  } catch (const std::exception& problem) {
    *error = problem.what();
  }
  if (!success) *error = "lowest modes: " + *error;
  return success;
}

bool CheckExpectedFrequencies(const SparseModes& modes,
                              const std::vector<double>& expected,
                              double tolerance, std::string* error) {
  CHECK(error != nullptr);
  CHECK_GT(tolerance, 0.0) << "the tolerance is relative, such as 0.001";
  const auto first = static_cast<size_t>(modes.num_rigid_body_modes);
  for (size_t i = 0; i < expected.size(); ++i) {
    const auto mode = static_cast<Eigen::Index>(first + i);
    if (mode >= modes.frequency_hz.size()) {
      *error = std::to_string(expected.size()) +
               " frequencies are expected, and " +
               std::to_string(modes.frequency_hz.size() - first) +
               " modes above 0 Hz were computed";
      return false;
    }
    const double found = modes.frequency_hz[mode];
    if (!(std::abs(found - expected[i]) <= tolerance * std::abs(expected[i]))) {
      *error = "mode " + std::to_string(i + 1) + " above 0 Hz has " +
               FormatNumber(found, 7) + ", expected " +
               FormatNumber(expected[i], 7) + " within " +
               FormatNumber(100.0 * tolerance, 3) +
               " %: other units, supports or masses than those of the "
               "expected frequencies?";
      return false;
    }
  }
  return true;
}

}  // namespace pinode
