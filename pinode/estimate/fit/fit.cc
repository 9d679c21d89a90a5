#include "pinode/estimate/fit/fit.h"

#include <algorithm>
#include <string>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/estimate/objective/evidence.h"
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

IdentifiedModel Fit::ModelToKeep(const Vector& free) {
  bool earlier = false;
  if (annealing_.HasBegun()) {
    current_.free_run_error =
        FreeRunError(context_.problem, layout_, objective_.shooting(), free);
    log_.SetFreeRunError(current_.free_run_error);
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
  current_.sigmas = reweighting_.noise().First(known);
  current_.decays = FirstDecays(layout_, context_.tuning().evidence, known);
  solver_.ResetRadius();
  objective_.shooting().SetSigmas(current_.sigmas);
  objective_.priors().SetDecays(current_.decays);
  if (!InitialTrajectories(context_.problem, segment_samples, current_.free,
                           context_.tuning().stages, &objective_.shooting(),
                           &current_.trajectories)) {
    log_.SetMessage(objective_.Failure());
    return false;
  }
  best_ = current_;
  return true;
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

bool Fit::RunStage(Eigen::Index samples, bool last) {
  StageRecord record;
  bool settled = false;
  Stage stage(context_, &log_, &solver_, &reweighting_);
  if (!stage.Run(samples, last, &current_, &record, &settled)) return false;
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
