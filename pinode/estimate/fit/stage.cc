#include "pinode/estimate/fit/stage.h"

#include <algorithm>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/estimate/shooting/segment_cut.h"
#include "pinode/estimate/shooting/trajectory_outline.h"
#include "pinode/estimate/start/initial_states.h"

namespace pinode {

bool Stage::CloseGaps(bool last, FitState* state, bool* settled) {
  MultipleShooting& shooting = context_.objective.shooting();
  const GapTuning& gaps = context_.tuning().gaps;
  const SolveTuning& solve = context_.tuning().solve;
  const bool networks = context_.HasNetworks();
  const Solver::Limits limits{
      networks ? solve.network_round_iterations : solve.round_iterations,
      solve.round_tolerance, 0.0, networks ? solve.network_crawl : 0.0};
  // Gaps begin softer than the data hold the starts, and end much firmer.
  double firmness =
      networks ? gaps.first_network_firmness : gaps.first_firmness;
  shooting.SetGapPenalty(
      std::max(1.0, firmness * shooting.state().data_curvature()));
  double first_cost = kInfinity;
  for (int round = 0; round < solve.max_rounds && context_.IterationsLeft();
       ++round) {
    bool converged = false;
    if (!solver_->Solve(limits, state, &converged)) return false;
    if (log_->interrupted()) break;
    // A firmer penalty makes the cost grow, but not as much as this: the
    // trajectories diverge, and no further round reunites them.
    if (round == 0) first_cost = std::max(1.0, state->cost);
    if (!(state->cost <= solve.diverged * first_cost)) break;
    // The multipliers belong to the present noise levels: close gaps first.
    if (shooting.LargestGap() < gaps.closed && (converged || !last)) {
      *settled = converged;
      break;
    }
    shooting.UpdateMultipliers();
    reweighting_->Update(converged, state);
    const double before = shooting.gap_penalty();
    firmness = std::min(gaps.most_firmness, gaps.growth * firmness);
    CondensedSystem system;
    if (!context_.objective.Linearize(state->free, &system)) break;
    const double after = std::max(
        before, firmness * std::max(1.0, shooting.state().data_curvature()));
    shooting.SetGapPenalty(after);
  }
  return true;
}

bool Stage::SettleSingle(FitState* state, bool* settled) {
  const SolveTuning& solve = context_.tuning().solve;
  const EvidenceTuning& evidence = context_.tuning().evidence;
  const bool networks = context_.HasNetworks();
  const double residual = networks ? solve.smallest_residual : 0.0;
  const double asked = context_.options.function_tolerance;
  // In the first rounds noise levels and decay settle, and they end early. The
  // last round runs to the tolerance asked for.
  bool fine = false;
  int evidence_rounds = 0;
  bool quiet = false;  // noise and decay, as of the last round
  int quiet_rounds = 0;
  for (int round = 0; round < solve.max_rounds && context_.IterationsLeft();
       ++round) {
    bool converged = false;
    double tolerance = fine ? asked : solve.round_tolerance;
    int iterations =
        fine ? context_.options.max_num_iterations : solve.round_iterations;
    if (networks) {
      // The cost is a negative log-likelihood. Valleys of networks do not end,
      // and smaller changes of the cost are invisible. The rounds before must
      // not end sooner either: a network on a plateau would stay there while
      // the noise decreases.
      tolerance = std::clamp(solve.smallest_change / state->cost, asked,
                             solve.most_network_tolerance);
      iterations =
          fine ? solve.fine_network_iterations : solve.network_round_iterations;
    }
    if (!solver_->Solve({iterations, tolerance, residual, 0.0}, state,
                        &converged)) {
      return false;
    }
    if (log_->interrupted()) break;
    if (networks && fine && converged &&
        (quiet || evidence_rounds >= 2 * evidence.rounds ||
         solver_->IsBelow(residual, state->free))) {
      *settled = true;
      break;
    }
    const Reweighting::Outcome outcome = reweighting_->Update(converged, state);
    quiet = outcome.is_quiet;
    if (networks) {
      quiet_rounds =
          outcome.noise_is_quiet && outcome.evidence_change < evidence.quiet
              ? quiet_rounds + 1
              : 0;
      quiet = quiet_rounds >= evidence.quiet_rounds;
      if (fine && outcome.evidence_change > evidence.new_evidence) {
        fine = false;
        evidence_rounds = 0;
        continue;
      }
    }
    // Idle inputs continue to fade long after they matter.
    evidence_rounds += outcome.noise_is_quiet ? 1 : 0;
    if (fine && converged) {
      *settled = true;
      if (quiet && !networks) return solver_->Polish(state);
    }
    fine = fine || quiet || evidence_rounds >= evidence.rounds ||
           round + 1 >= solve.max_rounds / 2;
  }
  return true;
}

bool Stage::Run(Eigen::Index samples, bool last, FitState* state,
                StageRecord* record, bool* settled) {
  *settled = false;
  MultipleShooting& shooting = context_.objective.shooting();
  if (!SetSegmentsAlong(samples, state->trajectories, &shooting)) {
    log_->SetMessage("the trajectory is not finite");
    return false;
  }
  shooting.SetSigmas(state->sigmas);
  context_.objective.priors().SetDecays(state->decays);
  std::vector<Vector> scales;
  record->segment_samples = samples;
  for (size_t t = 0; t < state->trajectories.records.size(); ++t) {
    scales.push_back(StateScalesOf(
        context_.problem, state->trajectories.records[t].mean_squares));
    record->num_segments += shooting.record(t).num_segments();
  }
  shooting.SetStateScales(scales);

  const int iterations_before = context_.summary.num_iterations;
  CondensedSystem system;
  shooting.SetGapPenalty(1.0);
  if (!context_.objective.Linearize(state->free, &system)) {
    log_->SetMessage(context_.objective.Failure());
    return false;
  }
  const auto measure = [&]() {
    const double error =
        FreeRunError(context_.problem, context_.layout, shooting, state->free);
    log_->SetFreeRunError(error);
    return error;
  };
  measure();
  const bool single = IsSingleShooting(shooting);
  if (!(single ? SettleSingle(state, settled)
               : CloseGaps(last, state, settled))) {
    return false;
  }
  record->iterations = context_.summary.num_iterations - iterations_before;
  record->largest_gap = shooting.LargestGap();
  record->free_run_error = state->free_run_error = measure();
  TrajectoryOutlines trajectories;
  if (OutlineTrajectories(shooting, state->free, &trajectories)) {
    state->trajectories = std::move(trajectories);
  }
  shooting.KeepRows(false);
  log_->SetSegments(record->largest_gap, single);
  return true;
}

}  // namespace pinode
