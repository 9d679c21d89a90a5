#include "pinode/structure/sparse/checked_modes.h"

#include <Eigen/QR>
#include <algorithm>
#include <limits>

#include "pinode/base/power_of_two.h"
#include "pinode/structure/sparse/mode_quotient.h"

namespace pinode {
namespace {

// Returns the parts that cancel in phi' K phi.
double PartsOf(const SparseMatrix& stiffness, const Vector& shape) {
  double parts = 0.0;
  for (Eigen::Index j = 0; j < stiffness.outerSize(); ++j) {
    double column = 0.0;
    for (SparseMatrix::InnerIterator entry(stiffness, j); entry; ++entry) {
      column += std::abs(entry.value() * shape[entry.row()]);
    }
    parts += column * std::abs(shape[j]);
  }
  return parts;
}

// Returns half the distance of theta i from the others. The other half covers
// their errors. Returns 0 if a neighbour is not known.
double HalfGap(const InversePairs& pairs, Eigen::Index i) {
  const Eigen::Index last = pairs.theta.size() - 1;
  if (i == last && !pairs.are_all) return 0.0;
  double gap = pairs.theta[i] - (i < last ? pairs.theta[i + 1] : 0.0);
  if (i > 0) gap = std::min(gap, pairs.theta[i - 1] - pairs.theta[i]);
  return 0.5 * std::max(gap, 0.0);
}

}  // namespace

bool ShiftedModel::ChooseShift(std::string* error) {
  shift_ = 0.0;
  if (factors_ == nullptr) {
    factors_ = std::make_unique<ShiftedFactors>();
    if (!factors_->FactoriseDefinite(mass_, stiffness_, 0.0)) factors_.reset();
  }
  if (factors_ != nullptr) {
    FindHeldDirections();
    return true;
  }
  const Vector k = stiffness_.diagonal();
  const Vector m = mass_.diagonal();
  unit_ = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < k.size(); ++i) {
    if (m[i] > 0.0 && k[i] != 0.0) {
      unit_ = std::min(unit_, std::abs(k[i]) / m[i]);
    }
  }
  if (!std::isfinite(unit_)) unit_ = 1.0;
  Eigen::Index weakest = -1;
  for (double factor = 1e-3; factor < 1e15; factor *= 10.0) {
    shift_ = -PowerOfTwoBelow(factor * unit_);
    auto factors = std::make_unique<ShiftedFactors>();
    if (factors->FactoriseDefinite(mass_, stiffness_, shift_)) {
      factors_ = std::move(factors);
      FindHeldDirections();
      return true;
    }
    weakest = factors->WeakestDof();
  }
  *error =
      "the stiffness matrix is singular or negative on motions without mass; "
      "constrain or remove them";
  if (weakest >= 0) {
    *error += " (DOF " + std::to_string(weakest + 1) + " takes part in one)";
  }
  return false;
}

bool ShiftedModel::MoveTo(double shift) {
  shift = -PowerOfTwoBelow(-shift);
  auto factors = std::make_unique<ShiftedFactors>();
  if (!factors->FactoriseDefinite(mass_, stiffness_, shift)) return false;
  shift_ = shift;
  factors_ = std::move(factors);
  FindHeldDirections();
  return true;
}

Matrix ShiftedModel::ForcesOnHeld() const {
  Matrix forces =
      Matrix::Zero(mass_.rows(), static_cast<Eigen::Index>(held_.size()));
  for (size_t i = 0; i < held_.size(); ++i) {
    forces(held_[i], static_cast<Eigen::Index>(i)) = 1.0;
  }
  return forces;
}

void ShiftedModel::FindHeldDirections() {
  held_directions_.resize(mass_.rows(), 0);
  if (held_.empty()) return;
  const Eigen::HouseholderQR<Matrix> qr(factors_->FromForce(ForcesOnHeld()));
  held_directions_ =
      qr.householderQ() *
      Matrix::Identity(mass_.rows(), static_cast<Eigen::Index>(held_.size()));
}

CheckedMode ShiftedModel::Check(const InversePairs& pairs,
                                Eigen::Index i) const {
  CheckedMode mode;
  mode.shape = factors_->ToShape(pairs.vectors.col(i));
  for (const int dof : held_) mode.shape[dof] = 0.0;
  const ModeQuotient quotient = QuotientOf(mass_, stiffness_, mode.shape);
  const double scale = 1.0 / std::sqrt(quotient.modal_mass);
  mode.eigenvalue = quotient.eigenvalue;
  mode.shape *= scale;
  Eigen::Index largest = 0;
  mode.shape.cwiseAbs().maxCoeff(&largest);
  if (mode.shape[largest] < 0.0) mode.shape = -mode.shape;
  mode.parts = PartsOf(stiffness_, mode.shape);

  Matrix rest = factors_->FromForce(scale * quotient.residual);
  if (!held_.empty()) {
    const Matrix along = held_directions_.transpose() * rest;
    rest -= held_directions_ * along;
  }
  // In the inverse operator, in parts of theta.
  const double from_shift = mode.eigenvalue - shift_;
  const double residual = rest.norm() / std::sqrt(from_shift);
  mode.residual = residual;
  const double gap = HalfGap(pairs, i);
  double bound = residual;
  if (residual * pairs.theta[i] < gap) {
    bound = std::min(bound, residual * residual * pairs.theta[i] / gap);
  }
  mode.bound = bound * from_shift / std::abs(mode.eigenvalue);
  return mode;
}

}  // namespace pinode
