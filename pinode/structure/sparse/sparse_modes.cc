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
#include "pinode/structure/sparse/inverse_operator.h"
#include "pinode/structure/sparse/modes_from_factors.h"
#include "pinode/structure/sparse/shifted_factors.h"

namespace pinode {
namespace {

// Relative rounding of one operation.
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// Required accuracy of each mode.
constexpr double kLargestErrorBound = 1e-8;
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

// Eigenpairs of the inverse operator, theta descending (w^2 ascending).
struct InversePairs {
  Vector theta;
  Matrix vectors;  // orthonormal columns
};

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
      0.5 * (projected + projected.transpose()));
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

// All eigenpairs with theta above rounding, by a dense solver.
bool DenseInversePairs(const InverseOperator& inverse, Matrix* basis,
                       std::string* error) {
  const Eigen::Index n = inverse.rows();
  const Matrix dense = inverse.Apply(Matrix::Identity(n, n));
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(
      0.5 * (dense + dense.transpose()));
  if (solver.info() != Eigen::Success) {
    *error = "the dense eigenvalue iteration did not converge";
    return false;
  }
  const Vector& theta = solver.eigenvalues();
  const double rounding =
      8.0 * static_cast<double>(n) * kEpsilon * theta.cwiseAbs().maxCoeff();
  const Eigen::Index rank = (theta.array() > rounding).count();
  *basis = solver.eigenvectors().rightCols(rank);
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
      : mass_(mass),
        stiffness_(stiffness),
        held_(held),
        num_modes_(num_modes),
        factors_(std::move(factors)) {}

  bool Compute(SparseModes* modes, std::string* error) {
    const int n = static_cast<int>(mass_.rows());
    Vector mass_diagonal = mass_.diagonal();
    for (const int dof : held_) mass_diagonal[dof] = 0.0;
    const int with_mass =
        static_cast<int>((mass_diagonal.array() > 0.0).count());
    if (with_mass == 0) {
      *error = held_.empty() ? "the mass matrix is zero, expected some mass"
                             : "no DOF with mass is left to move, expected one";
      return false;
    }
    dense_ = n <= kAlwaysDense || 4 * num_modes_ > with_mass;
    if (dense_ && n > kLargestDense) {
      *error = std::to_string(num_modes_) + " modes are asked of " +
               std::to_string(with_mass) +
               " DOFs with mass, expected at most a quarter of them in a model "
               "of more than " +
               std::to_string(kLargestDense) + " DOFs";
      return false;
    }
    if (!ChooseShift(error)) return false;
    FindHeldDirections();
    if (!Search(error)) return false;
    Finish(modes);
    return true;
  }

  // The factors of the positive definite K; nullptr if K is not.
  std::unique_ptr<ShiftedFactors> TakeFactors() {
    return shift_ == 0.0 ? std::move(factors_) : nullptr;
  }

 private:
  double Eigenvalue(Eigen::Index i) const {
    return shift_ + 1.0 / pairs_.theta[i];
  }

  // Returns the parts that cancel in phi' K phi.
  double Parts(const Vector& shape) const {
    double parts = 0.0;
    for (Eigen::Index j = 0; j < stiffness_.outerSize(); ++j) {
      double column = 0.0;
      for (SparseMatrix::InnerIterator entry(stiffness_, j); entry; ++entry) {
        column += std::abs(entry.value() * shape[entry.row()]);
      }
      parts += column * std::abs(shape[j]);
    }
    return parts;
  }

  // Unit forces on the held DOFs, n x held DOFs.
  Matrix ForcesOnHeld() const {
    Matrix forces =
        Matrix::Zero(mass_.rows(), static_cast<Eigen::Index>(held_.size()));
    for (size_t i = 0; i < held_.size(); ++i) {
      forces(held_[i], static_cast<Eigen::Index>(i)) = 1.0;
    }
    return forces;
  }

  void FindHeldDirections() {
    held_directions_.resize(mass_.rows(), 0);
    if (held_.empty()) return;
    const Eigen::HouseholderQR<Matrix> qr(factors_->FromForce(ForcesOnHeld()));
    held_directions_ =
        qr.householderQ() *
        Matrix::Identity(mass_.rows(), static_cast<Eigen::Index>(held_.size()));
  }

  // Returns the rounding error of eigenvalue i, whose shape has phi' M phi = 1.
  // A smaller eigenvalue cannot be distinguished from zero.
  double Rounding(Eigen::Index i, const Vector& shape) const {
    return std::max(1e-12 * Parts(shape),
                    (error_bounds_[i] + 8.0 * kEpsilon) * std::abs(shift_));
  }

  bool IsRigid(Eigen::Index i) const {
    Vector shape = factors_->ToShape(pairs_.vectors.col(i));
    shape /= std::sqrt(shape.dot(mass_ * shape));
    return std::abs(Eigenvalue(i)) <= Rounding(i, shape);
  }

  // Returns true if K - shift M is positive definite beyond rounding.
  bool IsDefinite(double shift) {
    factors_ = std::make_unique<ShiftedFactors>();
    return factors_->FactoriseDefinite(mass_, stiffness_, shift);
  }

  bool ChooseShift(std::string* error) {
    shift_ = 0.0;
    if (factors_ != nullptr || IsDefinite(0.0)) return true;
    // Finds a shift below the lowest eigenvalue. It starts from a thousandth of
    // the frequency at which the softest DOF would vibrate alone.
    const Vector k = stiffness_.diagonal();
    const Vector m = mass_.diagonal();
    unit_ = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < k.size(); ++i) {
      if (m[i] > 0.0 && k[i] != 0.0) {
        unit_ = std::min(unit_, std::abs(k[i]) / m[i]);
      }
    }
    if (!std::isfinite(unit_)) unit_ = 1.0;
    for (double factor = 1e-3; factor < 1e15; factor *= 10.0) {
      shift_ = -factor * unit_;
      if (IsDefinite(shift_)) return true;
    }
    *error =
        "the stiffness matrix is singular or negative on motions without mass; "
        "constrain or remove them";
    const Eigen::Index weakest = factors_->WeakestDof();
    if (weakest >= 0) {
      *error += " (DOF " + std::to_string(weakest + 1) + " takes part in one)";
    }
    return false;
  }

  // Moves the shift nearer to the modes if its distance is much larger than
  // theirs. Returns true if it moved.
  bool RefineShift() {
    if (shift_ == 0.0 || pairs_.theta.size() == 0) return false;
    Eigen::Index last =
        std::min<Eigen::Index>(num_modes_, pairs_.theta.size()) - 1;
    while (last < pairs_.theta.size() && IsRigid(last)) ++last;
    if (last == pairs_.theta.size()) return false;
    const double span = Eigenvalue(last);
    const double least = -1e-12 * unit_;
    if (!(span > 0.0) || span > -0.01 * shift_ || shift_ >= least) return false;
    const double previous = shift_;
    shift_ = std::min(least, -span);
    if (IsDefinite(shift_)) return true;
    // So close to zero the factors are rounding. Keep the previous shift.
    shift_ = previous;
    (void)IsDefinite(shift_);
    return false;
  }

  // Finds pairs until the count of eigenvalues below a bound agrees.
  bool Search(std::string* error) {
    const Matrix none(mass_.rows(), 0);
    Matrix basis = none;
    int wanted = num_modes_ + 2;
    for (int round = 0; round < 12; ++round) {
      const InverseOperator inverse(*factors_, mass_, held_directions_);
      if (dense_) {
        if (!DenseInversePairs(inverse, &basis, error)) return false;
        if (basis.cols() > wanted) basis = Matrix(basis.rightCols(wanted));
      } else {
        const int missing = wanted - static_cast<int>(basis.cols());
        const Matrix further =
            FurtherPairs(inverse, basis, std::max(missing, 2), 1e-10,
                         static_cast<unsigned>(round + 1))
                .vectors;
        Matrix both(basis.rows(), basis.cols() + further.cols());
        both << basis, further;
        basis.swap(both);
      }
      if (basis.cols() == 0) {
        *error = "no mode was found: the Lanczos iteration did not converge";
        return false;
      }
      if (!RayleighRitz(inverse, basis, &pairs_, &error_bounds_, error)) {
        return false;
      }
      const Eigen::Index computed = basis.cols();
      DropUnconverged();
      basis = pairs_.vectors;
      const bool complete =
          dense_ && computed < wanted && basis.cols() == computed;
      if (RefineShift()) {
        basis = none;
        continue;
      }
      if (!complete && pairs_.theta.size() < num_modes_ + 1) {
        if (dense_) break;
        continue;  // those not converged, or still missing
      }
      const CountResult result = CheckCount(complete);
      if (result == CountResult::kComplete) return true;
      if (result == CountResult::kCannotCount) {
        *error =
            "the eigenvalues below the last mode cannot be counted: K - s M "
            "has no factors of use";
        return false;
      }
      wanted = static_cast<int>(basis.cols()) + 4;
      if (dense_ && complete) {
        *error = "modes are missing that the dense solver should have found";
        return false;
      }
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
           error_bounds_[good] <= kLargestErrorBound) {
      ++good;
    }
    pairs_.theta.conservativeResize(good);
    pairs_.vectors.conservativeResize(Eigen::NoChange, good);
    error_bounds_.conservativeResize(good);
  }

  enum class CountResult { kComplete, kMissing, kCannotCount };

  // Counts the eigenvalues below a gap behind the last wanted mode. `complete`:
  // there are no other modes than those found.
  CountResult CheckCount(bool complete) {
    const Eigen::Index found = pairs_.theta.size();
    const Eigen::Index last = std::min<Eigen::Index>(num_modes_, found);
    for (Eigen::Index below = last; below <= found; ++below) {
      const double low = Eigenvalue(below - 1);
      double high = 0.0;
      if (below < found) {
        high = Eigenvalue(below);
      } else if (complete) {
        high = low + std::max(std::abs(low), low - shift_);
      } else {
        break;
      }
      if (!(high - low > kClusterWidth * (high - shift_))) continue;
      // Rigid-body modes form a cluster, whatever their rounded values are.
      if (below < found && IsRigid(below)) continue;
      if (factors_->Operations() > kMostOperationsOfCount) {
        return SearchMissed(1.0 / (0.5 * (low + high) - shift_));
      }
      for (const double part : {0.5, 0.4, 0.6, 0.25, 0.75}) {
        Eigen::Index count = 0;
        if (!CountBelow(low + part * (high - low), &count)) continue;
        return count == below ? CountResult::kComplete : CountResult::kMissing;
      }
      return CountResult::kCannotCount;
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
    if (!factors.Factorise(mass_, stiffness_, bound) ||
        !(factors.SolveError(mass_, stiffness_, bound) < 1e-6)) {
      return false;
    }
    *count = factors.NumNegative();
    if (held_.empty()) return true;
    const Matrix forces = ForcesOnHeld();
    const Matrix flexibility = forces.transpose() * factors.Solve(forces);
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(
        0.5 * (flexibility + flexibility.transpose()), Eigen::EigenvaluesOnly);
    *count += (solver.eigenvalues().array() > 0.0).count() -
              static_cast<Eigen::Index>(held_.size());
    return true;
  }

  // Searches for a theta above `bound` beside the pairs that were found.
  CountResult SearchMissed(double bound) const {
    const InverseOperator inverse(*factors_, mass_, held_directions_);
    const LargestEigenpairs rest = FurtherPairs(
        inverse, pairs_.vectors, 1, kToleranceOfSearch, kSeedOfSearch);
    if (rest.values.size() == 0) return CountResult::kComplete;
    if (rest.values[0] > bound) return CountResult::kMissing;
    return rest.residuals[0] <= kToleranceOfSearch ? CountResult::kComplete
                                                   : CountResult::kCannotCount;
  }

  void Finish(SparseModes* modes) const {
    SparseModes result;
    const int count =
        std::min(num_modes_, static_cast<int>(pairs_.theta.size()));
    if (count < num_modes_) {
      result.notes.push_back("the model has " + std::to_string(count) +
                             " modes, " + std::to_string(num_modes_) +
                             " were asked for");
    }
    result.shift = shift_;
    result.eigenvalues.resize(count);
    result.frequency_hz.resize(count);
    result.mode_shapes.resize(mass_.rows(), count);
    result.error_bounds = error_bounds_.head(count);
    int on_last_digits = 0;
    for (int i = 0; i < count; ++i) {
      Vector shape = factors_->ToShape(pairs_.vectors.col(i));
      for (const int dof : held_) shape[dof] = 0.0;
      shape /= std::sqrt(shape.dot(mass_ * shape));
      Eigen::Index largest = 0;
      shape.cwiseAbs().maxCoeff(&largest);
      if (shape[largest] < 0.0) shape = -shape;
      double eigenvalue = Eigenvalue(i);
      const double digits = kLastDigits * Parts(shape);
      const bool rigid = std::abs(eigenvalue) <= Rounding(i, shape);
      const bool on_digits = !rigid && std::abs(eigenvalue) <= digits;
      if (on_digits) ++on_last_digits;
      // The last digits of a file cannot show a negative stiffness either. A
      // small positive one may belong to a slender beam with many elements.
      if (rigid || (on_digits && eigenvalue < 0.0)) {
        eigenvalue = 0.0;
        ++result.num_rigid_body_modes;
      }
      result.eigenvalues[i] = eigenvalue;
      result.frequency_hz[i] = eigenvalue < 0.0
                                   ? std::numeric_limits<double>::quiet_NaN()
                                   : std::sqrt(eigenvalue) / kTwoPi;
      result.mode_shapes.col(i) = shape;
    }
    if (result.num_rigid_body_modes > 0) {
      result.notes.push_back(std::to_string(result.num_rigid_body_modes) +
                             " rigid-body modes at 0 Hz: nothing holds the "
                             "structure there");
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

  const SparseMatrix& mass_;
  const SparseMatrix& stiffness_;
  const std::vector<int>& held_;
  const int num_modes_;
  bool dense_ = false;
  double shift_ = 0.0;
  double unit_ = 1.0;
  std::unique_ptr<ShiftedFactors> factors_;
  Matrix held_directions_;  // n x held DOFs, see InverseOperator
  InversePairs pairs_;
  Vector error_bounds_;
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
