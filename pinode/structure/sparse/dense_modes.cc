#include "pinode/structure/sparse/dense_modes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pinode/structure/sparse/inverse_operator.h"

namespace pinode {
namespace {

// Relative rounding of one operation.
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// Most shifts. Each covers more than six of the 30 decades that occur.
constexpr int kMostShifts = 16;
// Ratio of an eigenvalue to the size of the shift from which on a nearer shift
// is worth its factors.
constexpr double kNear = 1e-3;
// Largest residual of a mode that is not computed again at a nearer shift. The
// shapes of a shift are orthogonal to this.
constexpr double kLargestResidual = 1e-10;
// The same of a mode of at most kNearestShift times the size of the shift, for
// which no better shift exists. It is rounding of the shape in stiff links,
// which leaves shapes orthogonal to 1e-9 (600 random models, links of up to
// 1e12).
constexpr double kLastResidual = 1e-5;
constexpr double kNearestShift = 4.0;
// Relative gap between eigenvalues at which one shift may follow another. Close
// modes come from one shift, which makes them orthogonal.
constexpr double kGap = 1e-3;

class Search {
 public:
  Search(ShiftedModel* model, int num_modes, int with_mass)
      : model_(*model),
        num_modes_(num_modes),
        with_mass_(with_mass),
        is_held_(model->shift() == 0.0) {}

  bool Run(std::vector<CheckedMode>* modes, std::string* error) {
    if (!FindPairs(error) || !MoveDown(error)) return false;
    for (int shifts = 0; shifts < kMostShifts; ++shifts) {
      AcceptGood();
      if (modes_.size() == Wanted()) {
        modes->swap(modes_);
        return true;
      }
      if (!MoveUp(error)) return false;
      if (is_complete_) {
        modes->swap(modes_);
        return true;
      }
    }
    return Fail(error);
  }

 private:
  size_t Wanted() const { return static_cast<size_t>(num_modes_); }

  bool Fail(std::string* error) const {
    *error =
        "only " + std::to_string(modes_.size()) +
        " of the lowest modes could be computed to 1e-8; ask for fewer, or "
        "check the matrices for extreme entries";
    return false;
  }

  // Finds all eigenpairs with theta above rounding at the model's shift.
  bool FindPairs(std::string* error) {
    const InverseOperator inverse(model_.factors(), model_.mass(),
                                  model_.held_directions());
    const Eigen::Index n = inverse.rows();
    const Matrix dense = inverse.Apply(Matrix::Identity(n, n));
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(
        Matrix(0.5 * (dense + dense.transpose())));
    if (solver.info() != Eigen::Success) {
      *error = "the dense eigenvalue iteration did not converge";
      return false;
    }
    const Vector& theta = solver.eigenvalues();
    const double rounding =
        8.0 * static_cast<double>(n) * kEpsilon * theta.cwiseAbs().maxCoeff();
    const Eigen::Index rank =
        std::min<Eigen::Index>((theta.array() > rounding).count(), with_mass_);
    pairs_.theta = theta.tail(rank).reverse();
    pairs_.vectors = solver.eigenvectors().rightCols(rank).rowwise().reverse();
    pairs_.are_all = true;
    return true;
  }

  // Moves a shift that is much larger than the lowest elastic mode towards it.
  bool MoveDown(std::string* error) {
    for (int shifts = 0; shifts < kMostShifts && model_.shift() < 0.0;
         ++shifts) {
      const Eigen::Index count =
          std::min<Eigen::Index>(num_modes_, pairs_.theta.size());
      double lowest = 0.0;
      for (Eigen::Index i = 0; i < count && lowest == 0.0; ++i) {
        const CheckedMode mode = model_.Check(pairs_, i);
        if (!ShiftedModel::IsRigid(mode, is_held_)) lowest = mode.eigenvalue;
      }
      if (!(lowest > 0.0) || lowest > kNear * -model_.shift()) return true;
      // So close to zero the factors may be rounding. Then the shift stays.
      if (!model_.MoveTo(-lowest)) return true;
      if (!FindPairs(error)) return false;
    }
    return true;
  }

  // Appends the modes that follow and are accurate at this shift.
  void AcceptGood() {
    const auto end =
        std::min<size_t>(Wanted(), static_cast<size_t>(pairs_.theta.size()));
    const size_t before = modes_.size();
    next_ = 0.0;
    for (size_t i = before; i < end; ++i) {
      CheckedMode mode = model_.Check(pairs_, static_cast<Eigen::Index>(i));
      const double largest_residual =
          mode.eigenvalue <= kNearestShift * -model_.shift() ? kLastResidual
                                                             : kLargestResidual;
      if (!(mode.residual <= largest_residual) ||
          (!(mode.bound <= kLargestErrorBound) &&
           !ShiftedModel::IsRigid(mode, is_held_))) {
        next_ = std::abs(mode.eigenvalue);
        break;
      }
      modes_.push_back(std::move(mode));
    }
    if (modes_.size() == end || next_ == 0.0) return;
    // Back to a gap.
    double above = next_;
    size_t last = modes_.size();
    while (last > before &&
           above - modes_[last - 1].eigenvalue < kGap * above) {
      above = modes_[last - 1].eigenvalue;
      --last;
    }
    if (last > before) modes_.resize(last);
  }

  // Moves the shift to the first mode that is missing. Sets is_complete_ if
  // there is none.
  bool MoveUp(std::string* error) {
    const double size = -model_.shift();
    double next = next_;
    if (next == 0.0) {
      // All that this shift shows is accepted, and it may hide others.
      if (modes_.size() == static_cast<size_t>(with_mass_)) {
        is_complete_ = true;
        return true;
      }
      const double last = modes_.empty() ? 0.0 : modes_.back().eigenvalue;
      next = Stiffest();
      if (size >= 0.25 * next || last >= next) {
        is_complete_ = true;
        return true;
      }
    }
    if (next <= kNearestShift * size || !model_.MoveTo(-next))
      return Fail(error);
    return FindPairs(error);
  }

  // Returns a frequency squared that is large for the model.
  double Stiffest() const {
    const Vector k = model_.stiffness().diagonal();
    const Vector m = model_.mass().diagonal();
    double largest = 0.0;
    for (Eigen::Index i = 0; i < k.size(); ++i) {
      if (m[i] > 0.0) largest = std::max(largest, std::abs(k[i]) / m[i]);
    }
    return largest;
  }

  ShiftedModel& model_;
  const int num_modes_;
  const int with_mass_;
  const bool is_held_;  // K is positive definite
  InversePairs pairs_;
  std::vector<CheckedMode> modes_;
  double next_ = 0.0;  // size of the first eigenvalue that is not accurate
  bool is_complete_ = false;
};

}  // namespace

bool DenseModes(ShiftedModel* model, int num_modes, int with_mass,
                std::vector<CheckedMode>* modes, std::string* error) {
  return Search(model, num_modes, with_mass).Run(modes, error);
}

}  // namespace pinode
