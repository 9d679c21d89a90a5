#include "pinode/estimate/solver/bounded_cost.h"

#include <cmath>

#include "pinode/base/power_of_two.h"
#include "pinode/estimate/solver/optimality.h"

namespace pinode {
namespace {

// Norm of a scaled column. Ceres divides each column of the Jacobian by one
// plus its norm, so that columns far longer than one are treated alike.
constexpr double kColumnNorm = 1048576.0;

}  // namespace

BoundedCost::BoundedCost(const ParameterLayout& layout, const Vector& start,
                         CostPart* part)
    : layout_(layout), part_(part), at_(start) {
  const int n = layout.num_free();
  scale_ = Vector::Ones(n);
  lower_.resize(n);
  upper_.resize(n);
  valid_ = part_->Linearize(start, &system_);
  for (int j = 0; j < n; ++j) {
    const bool named = layout.IsNamed(layout.free()[static_cast<size_t>(j)]);
    if (valid_ && named && system_.hessian(j, j) > 0.0) {
      const double norm = std::sqrt(system_.hessian(j, j));
      scale_[j] = PowerOfTwoBelow(kColumnNorm / norm);
    }
    lower_[j] = layout.free_parameter(j).lower / scale_[j];
    upper_[j] = layout.free_parameter(j).upper / scale_[j];
  }
}

Vector BoundedCost::Scaled(const Vector& free) const {
  return free.cwiseQuotient(scale_);
}

Vector BoundedCost::Unscaled(const Vector& scaled) const {
  return scaled.cwiseProduct(scale_);
}

bool BoundedCost::Evaluate(const Vector& scaled, double* cost) {
  return part_->Evaluate(Unscaled(scaled), cost);
}

bool BoundedCost::Linearize(const Vector& scaled, CondensedSystem* system) {
  const Vector free = Unscaled(scaled);
  if (!valid_ || free != at_) {
    valid_ = part_->Linearize(free, &system_);
    at_ = free;
    if (!valid_) return false;
  }
  system->cost = system_.cost;
  system->gradient = scale_.cwiseProduct(system_.gradient);
  system->hessian = scale_.asDiagonal() * system_.hessian * scale_.asDiagonal();
  for (int j = 0; j < free.size(); ++j) {
    if (!IsHeldAtBound(layout_.free_parameter(j), free[j],
                       system_.gradient[j])) {
      continue;
    }
    const double diagonal = system->hessian(j, j);
    system->hessian.row(j).setZero();
    system->hessian.col(j).setZero();
    system->hessian(j, j) = diagonal;
    system->gradient[j] = 0.0;
  }
  return true;
}

}  // namespace pinode
