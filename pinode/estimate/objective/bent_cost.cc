#include "pinode/estimate/objective/bent_cost.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/dynamics/network_term.h"

namespace pinode {
namespace {

// Largest 2 |a| / |d|, as published.
constexpr double kMostBend = 0.75;

}  // namespace

BentCost::BentCost(CostPart* part, Bend bend, const double* radius, int held)
    : part_(part), bend_(std::move(bend)), radius_(radius), held_(held) {}

const BentCost::Place* BentCost::Find(const Vector& flat) const {
  const auto is_here = [&flat](const Place& place) {
    return place.flat.size() == flat.size() && place.flat == flat;
  };
  if (is_here(trial_)) return &trial_;
  const auto found = std::find_if(centers_.rbegin(), centers_.rend(), is_here);
  return found == centers_.rend() ? nullptr : &*found;
}

Vector BentCost::PointOf(const Vector& flat) const {
  const Place* place = Find(flat);
  CHECK(place != nullptr) << "asked for a point that was never evaluated";
  return place->point;
}

Vector BentCost::Bent(const Vector& step) const {
  Vector projected;
  if (!(step.squaredNorm() > 0.0) || !bend_(step, &projected)) return step;
  const Vector diagonal = hessian_.diagonal();
  Matrix damped = hessian_;
  damped.diagonal() += diagonal / *radius_;
  if (held_ >= 0) {
    damped.row(held_).setZero();
    damped.col(held_).setZero();
    damped(held_, held_) = 1.0;
    projected[held_] = 0.0;
  }
  const Eigen::LLT<Matrix> factor(damped);
  if (factor.info() != Eigen::Success) return step;
  const Vector acceleration = -factor.solve(projected);
  const auto length = [&diagonal](const Vector& vector) {
    return std::sqrt(vector.cwiseAbs2().dot(diagonal));
  };
  const double bend = 2.0 * length(acceleration);
  const double most = kMostBend * length(step);
  if (!std::isfinite(bend)) return step;
  return step + (bend > most ? most / bend : 1.0) * 0.5 * acceleration;
}

void BentCost::Go(const Vector& flat) {
  const Place* known = Find(flat);
  if (known != nullptr) {
    trial_ = Place(*known);
    return;
  }
  if (centers_.empty()) {
    trial_ = {flat, flat};
    return;
  }
  const Place& center = centers_.back();
  trial_ = {flat, center.point + Bent(flat - center.flat)};
}

bool BentCost::Evaluate(const Vector& flat, double* cost) {
  Go(flat);
  return part_->Evaluate(trial_.point, cost);
}

bool BentCost::Linearize(const Vector& flat, CondensedSystem* system) {
  Go(flat);
  if (!part_->Linearize(trial_.point, system)) return false;
  centers_.push_back(trial_);
  hessian_ = system->hessian;
  return true;
}

bool HasNetworksOfState(const IdentificationProblem& problem,
                        const ParameterLayout& layout) {
  const auto& networks = problem.dynamics->networks();
  return layout.HasNetworkDecay() &&
         !std::all_of(networks.begin(), networks.end(), IsForceOfTime);
}

bool BendsSteps(const IdentificationProblem& problem,
                const ParameterLayout& layout) {
  for (int j = 0; j < layout.num_free(); ++j) {
    const Parameter& parameter = layout.free_parameter(j);
    if (std::isfinite(parameter.lower) || std::isfinite(parameter.upper)) {
      return false;
    }
  }
  return HasNetworksOfState(problem, layout);
}

BentCost::Bend BendOf(Objective* objective, const BoundedCost* bounded) {
  return [objective, bounded](const Vector& step, Vector* projected) {
    if (!objective->shooting().BendAlong(bounded->Unscaled(step), projected)) {
      return false;
    }
    *projected = bounded->Unscaled(*projected);
    return true;
  };
}

}  // namespace pinode
