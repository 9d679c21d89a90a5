#include "pinode/estimate/shooting/shooting_state.h"

#include <algorithm>

#include "pinode/base/constants.h"

namespace pinode {

const Divergence& ShootingState::divergence() const {
  static const Divergence none;
  return HasFailed() ? *failure_ : none;
}

void ShootingState::SetCut(const std::vector<Matrix>& starts) {
  linearization_.free.resize(0);
  linearization_.starts = starts;
  linearization_.squares.reset();
  SetCostChanged();
}

void ShootingState::SetCostChanged() {
  linearization_.cost = kInfinity;
  SetNothing();
}

void ShootingState::SetTrajectory(const Vector& free, double cost,
                                  bool with_derivatives) {
  free_ = free;
  cost_ = cost;
  propagated_ =
      with_derivatives ? Propagated::kDerivatives : Propagated::kTrajectory;
  failure_.reset();
}

void ShootingState::DropDerivatives() {
  propagated_ = std::min(propagated_, Propagated::kTrajectory);
}

void ShootingState::SetLinearization(ShootingLinearization linearization) {
  linearization_ = std::move(linearization);
  if (!linearization_.system.hessian.allFinite() ||
      !linearization_.system.gradient.allFinite()) {
    linearization_.squares.reset();
    DropDerivatives();
    failure_ = Divergence();
    return;
  }
  propagated_ = Propagated::kSensitivities;
  failure_.reset();
}

}  // namespace pinode
