#include "pinode/estimate/fit/reweighting.h"

#include <cmath>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/estimate/shooting/residual_statistics.h"

namespace pinode {

Reweighting::Outcome Reweighting::Update(bool converged, FitState* state) {
  Objective& objective = context_.objective;
  const EvidenceTuning& tuning = context_.tuning().evidence;
  Outcome outcome;
  outcome.noise_is_quiet = noise_is_quiet_;
  // A force acts on some channels directly and can follow their noise: its
  // used-up share must be counted per channel.
  const bool by_channel = !context_.problem.dynamics->unknown_forces().empty();
  CondensedSystem system;
  WeightedRows rows;
  Evidence evidence;
  if (!objective.Linearize(state->free, &system)) return outcome;
  MultipleShooting& shooting = objective.shooting();
  const std::vector<Vector>* squares = shooting.state().SquaresAt(state->free);
  CHECK(squares != nullptr) << "just linearised";
  rows.squares = *squares;
  if (((by_channel || context_.HasNetworks()) &&
       !WeightedResiduals(state->free, by_channel, &shooting, &rows.residuals,
                          &rows.jacobians)) ||
      !MeasureEvidence(context_.layout, system.hessian, state->decays,
                       state->free, &evidence)) {
    return outcome;
  }
  const double before = context_.summary.effective_parameters;
  const double after = evidence.effective;
  log_->SetEffectiveParameters(after);
  UpdateDecays(context_.layout, tuning, evidence, &state->decays);
  objective.priors().SetDecays(state->decays);
  const NoiseLevels::Change change =
      noise_.Update(rows, evidence, converged, annealing_, state);
  log_->SetFollowedChannel(change.followed_record, change.followed_channel);
  objective.shooting().SetSigmas(state->sigmas);
  VLOG(1) << "noise to change by " << change.wanted << ", well-determined "
          << "parameters " << before << " -> " << after;
  noise_is_quiet_ = change.quiet;
  outcome.noise_is_quiet = change.quiet;
  outcome.is_quiet =
      change.quiet && std::abs(after - before) <
                          tuning.quiet_share * context_.layout.num_free() +
                              tuning.quiet_parameters;
  outcome.evidence_change = std::abs(after / before - 1.0);
  return outcome;
}

}  // namespace pinode
