#include "pinode/estimate/fit/outcome.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/communicator.h"
#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/dynamics/memory_network.h"
#include "pinode/estimate/ambient/ambient_evidence.h"
#include "pinode/estimate/ambient/ambient_score.h"
#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/certainty/force_bands.h"
#include "pinode/estimate/certainty/holdout_noise.h"
#include "pinode/estimate/certainty/null_space.h"
#include "pinode/estimate/certainty/prediction_band.h"
#include "pinode/estimate/fit/modal_outcome.h"
#include "pinode/estimate/frf/frf_score.h"
#include "pinode/estimate/objective/bent_cost.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/estimate/shooting/trajectory_outline.h"
#include "pinode/estimate/start/free_run_start.h"
#include "pinode/estimate/start/signs.h"
#include "pinode/estimate/start/time_scale.h"
#include "pinode/problem/assumed_noise.h"
#include "pinode/problem/verdict_limits.h"

namespace pinode {
namespace {

// True for a fit of which nothing but its cost is asked.
bool IsCostOnly(const IdentificationOptions& options) {
  return options.covariance == IdentificationOptions::Covariance::kNone;
}

// Says how far the fit is from a minimum. Feed-forward networks have valleys
// without end, along which something could be saved for ever; the end of their
// training is in Fit. Networks with memory are judged as laws are: their prior
// is fixed and bounds each valley, so a fit that stopped in one has stalled.
void ReportOptimality(const Fit& fit, bool with_records, FitSummary* summary) {
  if (!fit.converged()) return;
  const FitState& best = fit.best();
  summary->gradient_cosine = best.optimality.cosine;
  summary->promised_share = best.optimality.promise;
  // Error below which a simulation, or a mode, is limited by rounding alone. A
  // last stage that was undone ended elsewhere.
  constexpr double kExact = 1e-6;
  const bool undone =
      !summary->stages.empty() && summary->stages.back().rolled_back;
  const bool exact = with_records ? best.free_run_error < kExact
                                  : std::abs(best.cost) < kExact * kExact;
  const double first_cost =
      summary->iterations.empty() ? 0.0 : summary->iterations.front().cost;
  summary->stalled = !fit.layout().HasNetworkDecay() && !undone && !exact &&
                     best.optimality.IsStalled(best.cost, first_cost);
}

void SetTermination(const Fit& fit, FitSummary* summary) {
  if (fit.interrupted()) {
    summary->termination = Termination::kInterrupted;
    summary->message = "interrupted; this is the best result so far";
  } else if (summary->stalled) {
    summary->termination = Termination::kNoConvergence;
    summary->message = "stopped before a minimum";
  } else if (fit.converged()) {
    summary->termination = Termination::kConverged;
    summary->message = "converged";
  } else {
    summary->termination = Termination::kNoConvergence;
    summary->message = "not converged";
  }
}

// Makes the estimate of one parameter.
ParameterEstimate MakeEstimate(const Parameter& parameter, double value,
                               double sigma, double quantile) {
  ParameterEstimate estimate;
  estimate.name = parameter.name;
  estimate.unit = parameter.unit;
  estimate.initial = parameter.value;
  estimate.value = value;
  estimate.free = parameter.free;
  if (parameter.IsTied()) {
    estimate.tie = parameter.tie;
    estimate.tie_factor = parameter.tie_factor;
  }
  estimate.sigma = parameter.free ? sigma : 0.0;
  estimate.half_width95 = quantile * estimate.sigma;
  estimate.lower95 = value - estimate.half_width95;
  estimate.upper95 = value + estimate.half_width95;
  const double span = 1e-9 * std::max(1.0, std::abs(value));
  estimate.at_bound = parameter.free && (value <= parameter.lower + span ||
                                         value >= parameter.upper - span);
  return estimate;
}

// Certainty at the fit's best point: covariance of the parameters, and the
// starts of the training records. It is not computed for a fit that was
// stopped.
struct Certainty {
  // True if the covariance gives intervals; and, if it does not, true if it is
  // at least the curvature of a minimum.
  bool known = false;
  bool is_curved = false;
  CovarianceEstimate covariance;
  std::vector<Matrix> starts;  // per training record
};

Certainty MeasureCertainty(const IdentificationProblem& problem,
                           const IdentificationOptions& options, Fit* fit) {
  const FitState& best = fit->best();
  const FitSummary& summary = fit->summary();
  Objective& objective = fit->objective();
  MultipleShooting& shooting = objective.shooting();
  // The objective at the solution, in single segments if that runs.
  shooting.SetSigmas(best.sigmas);
  objective.priors().SetDecays(best.decays);
  Certainty certainty;
  const bool placed = SetSegmentsAlong(
      summary.single_shooting ? 0 : summary.stages.back().segment_samples,
      best.trajectories, &shooting);
  const Vector band_decays = BandDecays(problem, fit->layout(), best.decays,
                                        options.tuning.force_bands);
  if (fit->input_noise().has_value()) {
    InputNoiseFit with_noise = *fit->input_noise();
    certainty.starts = with_noise.starts;
    certainty.known =
        problem.dynamics->unknown_forces().empty() || fit->interrupted() ||
        InputNoiseCovariance(problem, fit->layout(), fit->shooting_options(),
                             band_decays, &with_noise);
    certainty.covariance = with_noise.covariance;
  } else {
    double cost = 0.0;
    const bool evaluated = placed && objective.Evaluate(best.free, &cost);
    certainty.starts = shooting.starts();
    objective.priors().SetDecays(band_decays);
    certainty.known =
        evaluated && !fit->interrupted() && !IsCostOnly(options) &&
        EstimateCovariance(problem, fit->layout(), options.covariance,
                           best.free, best.sigmas, &objective,
                           &certainty.covariance);
  }
  return certainty;
}

// Scores of a record's channels that nobody simulated.
std::vector<ChannelScore> NotScored(const IdentificationRecord& record) {
  std::vector<ChannelScore> scores(record.channels.size());
  for (size_t c = 0; c < scores.size(); ++c) {
    scores[c].name = record.channels[c].observation.name;
    scores[c].fitted = record.channels[c].fit;
    scores[c].rmse = scores[c].nrmse = scores[c].prior_nrmse = kNaN;
  }
  return scores;
}

// Scores the simulations of all records, by the initial and the fitted model.
void ScoreRecords(const IdentificationProblem& problem,
                  const IdentificationOptions& options,
                  const Vector& prior_parameters,
                  const std::vector<Matrix>& starts, FitSummary* summary,
                  IdentifiedModel* model) {
  size_t t = 0;
  for (size_t r = 0; r < problem.records.size(); ++r) {
    const int index = static_cast<int>(r);
    const Vector& sigmas = model->sigmas[r];
    const bool is_training =
        problem.records[r].role == IdentificationRecord::Role::kTrain;
    RecordScore prior, score;
    Vector start;
    Eigen::Index first = 0;
    if (IsCostOnly(options)) {
      prior.nrmse = kNaN;
      prior.channels = NotScored(problem.records[r]);
    } else {
      first = FreeRunStart(problem, index, prior_parameters, sigmas, &start);
      ScoreRecord(problem, index, prior_parameters, start, first, &prior,
                  Keep::kChannels, options.num_threads);
    }
    if (IsCostOnly(options) && !is_training) {
      score.role = problem.records[r].role;
      score.name = problem.records[r].name;
      score.finite = true;
      score.nrmse = score.prior_nrmse = kNaN;
      score.channels = NotScored(problem.records[r]);
      summary->records.push_back(std::move(score));
      model->starts.push_back(start);
      continue;
    }
    if (is_training) {
      start = starts[t++].col(0);
      first = 0;
    } else {
      first = FreeRunStart(problem, index, model->parameters, sigmas, &start);
    }
    prior.prediction.resize(0, 0);
    ScoreRecord(problem, index, model->parameters, start, first, &score,
                options.keep_states ? Keep::kAll : Keep::kMeanSquares,
                options.num_threads);
    score.prior_nrmse = prior.nrmse;
    for (size_t c = 0; c < score.channels.size(); ++c) {
      score.channels[c].prior_nrmse = prior.channels[c].nrmse;
      score.channels[c].sigma = sigmas[static_cast<int>(c)];
    }
    summary->records.push_back(std::move(score));
    model->starts.push_back(start);
  }
}

// Returns a sentence for each sensor of a training record whose residuals are
// mostly constant, if its offset is not free.
std::vector<std::string> OffsetRemarks(const IdentificationProblem& problem,
                                       const FitSummary& summary) {
  // Shares of the residuals' RMS and of the record's RMS.
  constexpr double kMostly = 0.7;
  constexpr double kSome = 0.02;
  std::vector<std::string> remarks;
  for (size_t r = 0; r < summary.records.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    const RecordScore& score = summary.records[r];
    if (record.role != IdentificationRecord::Role::kTrain || !score.finite ||
        score.prediction.cols() != record.num_samples()) {
      continue;
    }
    for (size_t c = 0; c < record.channels.size(); ++c) {
      const MeasuredChannel& channel = record.channels[c];
      if (!channel.fit || channel.offset >= 0) continue;
      const Vector residuals =
          channel.values -
          score.prediction.row(static_cast<Eigen::Index>(c)).transpose();
      const double mean = MeanOfPresent(
          residuals.tail(residuals.size() - score.first_scored_sample));
      const ChannelScore& of = score.channels[c];
      if (std::abs(mean) < kMostly * of.rmse || of.nrmse < kSome) continue;
      remarks.push_back(
          "Record '" + score.name + "': the difference between sensor '" +
          of.name + "' and the model is mostly a constant (" +
          FormatNumber(mean, 3) + "). Consider leaving its 'offset' free.");
    }
  }
  return remarks;
}

// True on the rank that keeps histories, channels x samples.
bool KeepsHistories(const IdentificationOptions& options) {
  return CommunicatorOrSingle(options.communicator).rank() == 0;
}

// Sets the bands of measurements about the predictions, and counts the
// measurements within them.
void BandPredictions(const IdentificationProblem& problem,
                     const IdentificationOptions& options,
                     const TrainedSensors& trained, const Certainty& certainty,
                     const IdentifiedModel& model, FitSummary* summary) {
  if (!certainty.known || !options.prediction_bands) return;
  const CovarianceEstimate& covariance = certainty.covariance;
  for (size_t r = 0; r < summary->records.size(); ++r) {
    RecordScore& score = summary->records[r];
    const Vector sigmas = HoldoutNoise(problem, trained, static_cast<int>(r),
                                       model.sigmas, summary->records);
    score.deviations = PredictionDeviations(
        problem, static_cast<int>(r), model.parameters, covariance.covariance,
        sigmas, score, options.num_threads);
    const std::string remark =
        HoldoutNoiseRemark(problem.records[r], model.sigmas[r], sigmas);
    if (!remark.empty()) summary->remarks.push_back(remark);
    for (size_t c = 0; c < score.channels.size(); ++c) {
      const MeasuredChannel& channel = problem.records[r].channels[c];
      score.channels[c].sigma = sigmas[static_cast<int>(c)];
      // Noise that is assumed for other sensors gives no band.
      if (!(channel.sigma > 0.0) && !trained[r][c].has_value()) {
        if (score.deviations.size() > 0) {
          score.deviations.row(static_cast<int>(c)).setConstant(kNaN);
        }
        continue;
      }
      score.channels[c].band_coverage = BandCoverage(
          problem.records[r], score, static_cast<int>(c), covariance.quantile);
    }
    if (!KeepsHistories(options)) score.deviations.resize(0, 0);
  }
}

// Describes the groups that the record does not determine because the loads are
// unknown; empty: it determines all.
std::string WhatLoadsHide(const AmbientScore& score) {
  std::vector<std::string> hidden;
  for (size_t g = 0; g < score.groups.size(); ++g) {
    if (score.information_left[static_cast<Eigen::Index>(g)] <
        limits::kAnyInformationLeft) {
      hidden.push_back("'" + score.groups[g] + "'");
    }
  }
  if (hidden.empty()) return "";
  return "Ambient record '" + score.name + "' does not determine " +
         Join(hidden, ", ") + ": less than " +
         FormatNumber(100.0 * limits::kAnyInformationLeft, 2) +
         " % of the information with known loads is left. Other loads explain "
         "it as well.";
}

void ReportAmbient(const Vector& free, const Objective& objective,
                   FitSummary* summary) {
  for (const auto& record : objective.ambient()) {
    AmbientScore score;
    if (ScoreAmbient(free, record.get(), &score)) {
      score.evidence = JudgeLoads(free, record.get());
    } else {
      score.probability = 0.0;
    }
    const std::string hidden = WhatLoadsHide(score);
    if (!hidden.empty()) summary->remarks.push_back(hidden);
    summary->ambient.push_back(std::move(score));
  }
}

// Scores FRFs by the initial and the fitted model.
void ReportFrfs(const Vector& initial, const Vector& free,
                const Objective& objective, FitSummary* summary) {
  for (const auto& record : objective.frfs()) {
    FrfScore score;
    double unused = 0.0;
    Vector prior;
    if (record->Evaluate(initial, &unused)) prior = FrfErrors(*record);
    if (ScoreFrfs(free, record.get(), &score)) {
      score.prior_errors =
          prior.size() > 0
              ? prior
              : Vector(Vector::Constant(score.errors.size(), kInfinity));
    } else {
      score.probability = 0.0;
      score.log_likelihood = -kInfinity;
    }
    summary->frfs.push_back(std::move(score));
  }
}

void ReportParameters(const IdentificationProblem& problem,
                      const ParameterLayout& layout, const Vector& parameters,
                      const Certainty& certainty, FitSummary* summary) {
  const CovarianceEstimate& covariance = certainty.covariance;
  std::vector<int> named;
  for (int i = 0; i < layout.num_parameters(); ++i) {
    if (!layout.IsNamed(i)) continue;
    const int j = layout.FreeIndex(i);
    const double sigma =
        j >= 0 && certainty.known
            ? std::sqrt(std::max(0.0, covariance.covariance(j, j)))
            : (j >= 0 ? kInfinity : 0.0);
    summary->parameters.push_back(MakeEstimate(
        layout.parameter(i), parameters[i], sigma, covariance.quantile));
    if (j >= 0) {
      named.push_back(j);
      summary->covariance_names.push_back(layout.parameter(i).name);
    }
  }
  FollowSources(&summary->parameters);
  if (certainty.is_curved) {
    summary->undetermined = DescribeNullSpace(
        layout, WithUnseenGroups(problem, layout, layout.Free(parameters),
                                 covariance.covariance, covariance.null_space));
  }
  if (!certainty.known) return;
  summary->covariance_method = covariance.method;
  summary->covariance = covariance.covariance(named, named);
}

}  // namespace

void ReportOutcome(const IdentificationProblem& problem,
                   const IdentificationOptions& options, Fit* fit,
                   FitSummary* summary, IdentifiedModel* model) {
  const FitState& best = fit->best();
  const ParameterLayout& layout = fit->layout();
  ReportOptimality(*fit, problem.num_train_records() > 0, summary);
  SetTermination(*fit, summary);
  model->parameters = fit->BestParameters();
  model->decays = best.decays;
  const TrainedSensors trained = FindTrainedSensors(problem);
  model->sigmas =
      NoiseOfAllRecords(problem, trained, best.sigmas, options.tuning.noise);
  model->resume_stage = fit->converged() ? 0 : fit->stage();
  summary->decays.assign(best.decays.begin(), best.decays.end());
  if (!summary->iterations.empty()) {
    summary->initial_cost = summary->iterations.front().cost;
  }
  summary->final_cost = best.cost;

  summary->initial_damping = LeastDamping(problem, layout.InitialValues());
  summary->final_damping = LeastDamping(problem, model->parameters);
  summary->negative_damping_allowed = DampingsAreBounded(*problem.dynamics);
  summary->learns_force = HasNetworksOfState(problem, layout) ||
                          HasFreeMemoryNetwork(*problem.dynamics);

  Certainty certainty = MeasureCertainty(problem, options, fit);
  // Intervals exist only at a minimum.
  if (summary->termination == Termination::kNoConvergence ||
      summary->termination == Termination::kInterrupted) {
    certainty.known = false;
  }
  certainty.is_curved = certainty.known;
  ScoreRecords(problem, options, layout.InitialValues(), certainty.starts,
               summary, model);
  summary->remarks = TimeScaleRemarks(problem);
  for (std::string& remark : SignRemarks(problem, model->parameters)) {
    summary->remarks.push_back(std::move(remark));
  }
  for (std::string& remark : OffsetRemarks(problem, *summary)) {
    summary->remarks.push_back(std::move(remark));
  }
  if (!problem.modal.empty()) {
    ReportModes(problem, layout, model->parameters, fit->objective().modes(),
                &certainty.known, &certainty.covariance, summary);
  }
  BandPredictions(problem, options, trained, certainty, *model, summary);
  // The noise of hold-outs needed the predictions of all records.
  for (RecordScore& score : summary->records) {
    if (!KeepsHistories(options)) score.prediction.resize(0, 0);
  }
  const Vector free = layout.Free(model->parameters);
  ReportAmbient(free, fit->objective(), summary);
  ReportFrfs(layout.Free(layout.InitialValues()), free, fit->objective(),
             summary);
  ReportParameters(problem, layout, model->parameters, certainty, summary);
  summary->forces = EstimateForces(
      problem, layout, model->parameters,
      certainty.known ? certainty.covariance.covariance : Matrix(),
      certainty.covariance.quantile);
  if (std::any_of(summary->records.begin(), summary->records.end(),
                  [](const RecordScore& score) { return !score.finite; })) {
    ReportGrowingMotion(problem, model->parameters, summary);
  }
}

}  // namespace pinode
