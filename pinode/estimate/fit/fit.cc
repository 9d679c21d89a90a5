#include "pinode/estimate/fit/fit.h"

#include <algorithm>
#include <string>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/estimate/fit/valley.h"
#include "pinode/estimate/objective/evidence.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "pinode/estimate/shooting/residual_statistics.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/estimate/shooting/trajectory_outline.h"
#include "pinode/estimate/start/initial_states.h"
#include "pinode/estimate/start/stage_schedule.h"

namespace pinode {

Fit::Fit(const IdentificationProblem& problem,
         const IdentificationOptions& options)
    : options_(options),
      log_(
          options_, [this](const Vector& free) { return ModelToKeep(free); },
          &summary_),
      layout_(problem),
      shooting_options_(ShootingOptions(options)),
      objective_(problem, layout_, shooting_options_),
      context_{problem, options_, layout_, objective_, summary_},
      solver_(context_, &log_),
      annealing_(context_),
      reweighting_(context_, &log_, &annealing_) {}

Vector Fit::BestParameters() const {
  Vector parameters = layout_.InitialValues();
  layout_.SetFree(best_.free, &parameters);
  return parameters;
}

double Fit::MeasureFreeRun(const Vector& free) {
  const double error =
      FreeRunError(context_.problem, layout_, objective_.shooting(), free);
  log_.SetFreeRunError(error);
  return error;
}

IdentifiedModel Fit::ModelToKeep(const Vector& free) {
  bool earlier = false;
  if (annealing_.HasBegun()) {
    current_.free_run_error = MeasureFreeRun(free);
    earlier = IsWorseThanBest(current_);
  }
  const FitState& state = earlier ? best_ : current_;
  IdentifiedModel model;
  model.parameters = layout_.InitialValues();
  layout_.SetFree(earlier ? best_.free : free, &model.parameters);
  model.decays = state.decays;
  model.sigmas.resize(context_.problem.records.size());
  for (size_t t = 0; t < state.sigmas.size(); ++t) {
    const int record = context_.train_records()[t];
    model.sigmas[static_cast<size_t>(record)] = state.sigmas[t];
  }
  model.resume_stage = stage_;
  return model;
}

bool Fit::IsWorseThanBest(const FitState& state) const {
  const Tuning& tuning = context_.tuning();
  if (context_.HasNetworks() &&
      state.free_run_error <= tuning.noise.smallest_misfit) {
    return false;
  }
  return !(state.ExpectedError() <=
           (1.0 + tuning.stages.worse_share) * best_.ExpectedError());
}

bool Fit::Prepare(const Vector& parameters, Eigen::Index segment_samples,
                  const IdentifiedModel* initial) {
  current_ = FitState();
  current_.free = layout_.Free(parameters);
  first_free_ = initial == nullptr ? current_.free
                                   : layout_.Free(layout_.InitialValues());
  // With networks an interrupted fit has to measure its noise again.
  const IdentifiedModel* known =
      context_.HasNetworks() && initial != nullptr && initial->resume_stage > 0
          ? nullptr
          : initial;
  current_.sigmas = reweighting_.FirstSigmas(known);
  current_.decays = FirstDecays(layout_, context_.tuning().evidence, known);
  solver_.ResetRadius();
  objective_.shooting().SetSigmas(current_.sigmas);
  objective_.priors().SetDecays(current_.decays);
  if (!InitialTrajectories(context_.problem, segment_samples, current_.free,
                           context_.tuning().stages, &objective_.shooting(),
                           &current_.trajectories, KnownStarts(initial))) {
    log_.SetMessage(objective_.Failure());
    return false;
  }
  best_ = current_;
  return true;
}

std::vector<Vector> Fit::KnownStarts(const IdentifiedModel* initial) const {
  std::vector<Vector> known;
  const StructuralDynamics& dynamics = *context_.problem.dynamics;
  if (initial == nullptr || dynamics.IsLinear()) return known;
  for (const int record : context_.train_records()) {
    const size_t r = static_cast<size_t>(record);
    if (r >= initial->starts.size() ||
        initial->starts[r].size() != dynamics.num_states() ||
        !initial->starts[r].allFinite()) {
      return {};
    }
    known.push_back(initial->starts[r]);
  }
  return known;
}

void Fit::BeginAnnealing() {
  if (!annealing_.SetFirstDecays(&current_.decays)) return;
  if (summary_.stages.empty()) {
    annealing_.Begin(first_free_, nullptr, &current_);
  } else {
    // Decays of intermediate steps are discarded.
    const Vector decays = current_.decays;
    // Noise grows tenfold at most at once.
    for (int i = 0; i < context_.tuning().annealing.measuring_rounds; ++i) {
      reweighting_.Update(true, &current_);
    }
    current_.decays = decays;
    Annealing::LeftOver left_over;
    left_over.sigmas = current_.sigmas;
    if (!WeightedResiduals(current_.free, false, &objective_.shooting(),
                           &left_over.residuals, nullptr)) {
      left_over.residuals.clear();
    }
    annealing_.Begin(first_free_, &left_over, &current_);
  }
  solver_.ResetRadius();
}

bool Fit::CloseGaps(bool last, bool* settled) {
  MultipleShooting& shooting = objective_.shooting();
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
  // Longer segments may let trajectories diverge at once: the stage is compared
  // with the best one before it.
  double first_cost =
      summary_.stages.empty() ? kInfinity : std::max(1.0, best_.cost);
  for (int round = 0; round < solve.max_rounds && context_.IterationsLeft();
       ++round) {
    bool converged = false;
    if (!solver_.Solve(limits, &current_, &converged)) return false;
    if (log_.interrupted()) break;
    // A firmer penalty makes the cost grow, but not as much as this: the
    // trajectories diverge, and no further round reunites them.
    if (round == 0) {
      first_cost = std::min(first_cost, std::max(1.0, current_.cost));
    }
    if (!(current_.cost <= solve.diverged * first_cost)) break;
    // The multipliers belong to the present noise levels: close gaps first.
    if (shooting.LargestGap() < gaps.closed && (converged || !last)) {
      *settled = converged;
      break;
    }
    shooting.UpdateMultipliers();
    reweighting_.Update(converged, &current_);
    const double before = shooting.gap_penalty();
    firmness = std::min(gaps.most_firmness, gaps.growth * firmness);
    CondensedSystem system;
    if (!objective_.Linearize(current_.free, &system)) break;
    const double after = std::max(
        before, firmness * std::max(1.0, shooting.state().data_curvature()));
    shooting.SetGapPenalty(after);
  }
  return true;
}

bool Fit::SettleSingle(bool* settled) {
  const SolveTuning& solve = context_.tuning().solve;
  const EvidenceTuning& evidence = context_.tuning().evidence;
  const bool networks = context_.HasNetworks();
  const double residual = networks ? solve.smallest_residual : 0.0;
  const double asked = context_.options.function_tolerance;
  // In the first rounds noise levels and decay settle, and they end early. The
  // last round runs to the tolerance asked for.
  const bool cost_only =
      context_.options.covariance == IdentificationOptions::Covariance::kNone;
  bool fine = cost_only;
  // Costs of ambient records are large negative log-likelihoods, and models
  // that are wrong for them have valleys.
  const IdentificationProblem& problem = context_.problem;
  const bool has_valleys = !problem.ambient.empty() && problem.modal.empty() &&
                           problem.frfs.empty() &&
                           problem.num_train_records() == 0 && !networks;
  const double valley = has_valleys ? Valley::kShare : 0.0;
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
      tolerance = std::clamp(solve.smallest_change / current_.cost, asked,
                             solve.most_network_tolerance);
      iterations =
          fine ? solve.fine_network_iterations : solve.network_round_iterations;
    }
    if (!solver_.Solve({iterations, tolerance, residual, 0.0, valley},
                       &current_, &converged)) {
      return false;
    }
    if (log_.interrupted() || solver_.is_in_valley()) break;
    if (networks && fine && converged &&
        (quiet || evidence_rounds >= 2 * evidence.rounds ||
         solver_.IsBelow(residual, current_.free))) {
      *settled = true;
      break;
    }
    const Reweighting::Outcome outcome =
        reweighting_.Update(converged, &current_);
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
      if (quiet && cost_only) break;
      if (quiet && !networks) return solver_.Polish(&current_);
    }
    fine = fine || quiet || evidence_rounds >= evidence.rounds ||
           round + 1 >= solve.max_rounds / 2;
  }
  return true;
}

bool Fit::BeginSegments(Eigen::Index samples, StageRecord* record) {
  MultipleShooting& shooting = objective_.shooting();
  if (!SetSegmentsAlong(samples, current_.trajectories, &shooting)) {
    log_.SetMessage("the trajectory is not finite");
    return false;
  }
  shooting.SetSigmas(current_.sigmas);
  objective_.priors().SetDecays(current_.decays);
  std::vector<Vector> scales;
  record->segment_samples = samples;
  for (size_t t = 0; t < current_.trajectories.records.size(); ++t) {
    scales.push_back(StateScalesOf(
        context_.problem, current_.trajectories.records[t].mean_squares));
    record->num_segments += shooting.record(t).num_segments();
  }
  shooting.SetStateScales(scales);
  CondensedSystem system;
  shooting.SetGapPenalty(1.0);
  if (!objective_.Linearize(current_.free, &system)) {
    log_.SetMessage(objective_.Failure());
    return false;
  }
  return true;
}

bool Fit::SolveStage(Eigen::Index samples, bool last, StageRecord* record,
                     bool* settled) {
  *settled = false;
  const int iterations_before = summary_.num_iterations;
  if (!BeginSegments(samples, record)) return false;
  MultipleShooting& shooting = objective_.shooting();
  MeasureFreeRun(current_.free);
  const bool single = IsSingleShooting(shooting);
  if (!(single ? SettleSingle(settled) : CloseGaps(last, settled))) {
    return false;
  }
  record->iterations = summary_.num_iterations - iterations_before;
  record->largest_gap = shooting.LargestGap();
  record->free_run_error = current_.free_run_error =
      MeasureFreeRun(current_.free);
  TrajectoryOutlines trajectories;
  if (OutlineTrajectories(shooting, current_.free, &trajectories)) {
    current_.trajectories = std::move(trajectories);
  }
  shooting.KeepRows(false);
  log_.SetSegments(record->largest_gap, single);
  return true;
}

bool Fit::RunStage(Eigen::Index samples, bool last) {
  StageRecord record;
  bool settled = false;
  if (!SolveStage(samples, last, &record, &settled)) return false;
  if (last) converged_ = settled;
  // If no simulation stays finite, the result of the segments is kept. A
  // simulation so many times larger than the measurement has diverged: the
  // record ended before it overflowed.
  constexpr double kBlownUp = 1e6;
  const bool blown_up = last && !summary_.stages.empty() &&
                        !context_.HasNetworks() &&
                        !(current_.free_run_error < kBlownUp);
  record.rolled_back = blown_up || IsWorseThanBest(current_);
  log_.AddStage(record);
  if (record.rolled_back) {
    current_ = best_;
  } else {
    best_ = current_;
  }
  return true;
}

bool Fit::Run(const Vector& parameters, const IdentifiedModel* initial) {
  // Networks with memory are none here. Their device is stable from the first
  // weights on, so that the first stage needs no shorter segments. Their decay
  // is fixed, so that there is nothing to anneal.
  const bool networks = context_.HasNetworks();
  const std::vector<Eigen::Index> lengths =
      StageLengths(context_.problem, options_, networks);
  const int num_stages = static_cast<int>(lengths.size());
  // An interrupted fit continues in its stage. With networks it begins at the
  // first stage, from the learned weights, since annealing needs the residuals
  // of the first fit. The results of an earlier fit are not drawn again.
  const bool cut_off = initial != nullptr && initial->resume_stage > 0;
  const bool anneal = networks && (initial == nullptr || cut_off);
  const int first =
      cut_off && !networks ? std::min(initial->resume_stage, num_stages) : 1;
  if (!Prepare(parameters, lengths[static_cast<size_t>(first) - 1], initial)) {
    return false;
  }
  const GapTuning& gaps = context_.tuning().gaps;
  bool gaps_closed = false;
  for (int s = first; s <= num_stages; ++s) {
    const Eigen::Index samples = lengths[static_cast<size_t>(s) - 1];
    const bool last = s == num_stages;
    // With closed gaps the trajectory is already one piece: merging a few
    // segments would change nothing.
    if (!last && gaps_closed) continue;
    stage_ = s;
    log_.BeginStage(s, num_stages, samples);
    const FitState before = current_;
    if (last && anneal) BeginAnnealing();
    if (!RunStage(samples, last)) {
      // The whole record may not run freely: the result of the segments is
      // kept.
      if (summary_.stages.empty()) return false;
      VLOG(1) << "stage " << s << " abandoned: " << summary_.message;
      current_ = before;
      break;
    }
    const StageRecord& record = summary_.stages.back();
    gaps_closed = record.largest_gap < gaps.nearly_closed * gaps.closed &&
                  !record.rolled_back;
    if (interrupted() || !context_.IterationsLeft()) break;
  }
  if (converged_ && !interrupted()) FitInputNoise();
  return true;
}

void Fit::FitInputNoise() {
  if (!summary_.single_shooting ||
      options_.covariance != IdentificationOptions::Covariance::kAuto ||
      !CanFitWithInputNoise(context_.problem, options_.loss)) {
    return;
  }
  InputNoiseFit fit;
  fit.free = best_.free;
  fit.sigmas = best_.sigmas;
  std::string error = "there is no finite trajectory";
  const double largest_gap = objective_.shooting().LargestGap();
  if (RunTrajectories(objective_.shooting(), best_.trajectories,
                      &fit.trajectories) &&
      FitWithInputNoise(
          context_.problem, layout_, shooting_options_, best_.decays,
          [&](const Vector& free, double cost) {
            return log_.GoOn(free, cost, largest_gap);
          },
          &fit, &error)) {
    best_.free = fit.free;
    best_.sigmas = fit.sigmas;
    best_.cost = fit.cost;
    input_noise_ = std::move(fit);
  } else if (!interrupted()) {
    LOG(WARNING) << "The noise of the excitation enters only the intervals. "
                    "The fit with its errors as unknowns failed: "
                 << error;
  }
}

}  // namespace pinode
