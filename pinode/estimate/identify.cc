#include "pinode/estimate/identify.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/estimate/condensed_cost.h"
#include "pinode/estimate/covariance.h"
#include "pinode/estimate/initial_states.h"
#include "pinode/estimate/input_noise_fit.h"
#include "pinode/estimate/modal_residual.h"
#include "pinode/estimate/multiple_shooting.h"
#include "pinode/estimate/null_space.h"
#include "pinode/estimate/parameter_layout.h"
#include "pinode/estimate/pulse_scan.h"
#include "pinode/estimate/score.h"
#include "pinode/network/initialize_weights.h"
#include "pinode/record/prepare.h"

namespace pinode {
namespace {

double Seconds(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin)
      .count();
}

// Networks that depend on time alone and act as a force are forces that nobody
// measured.
bool IsForceOfTime(const NetworkTerm& term) {
  return term.acts_as == ActsAs::kForce &&
         std::all_of(term.features.begin(), term.features.end(),
                     [](const Feature& feature) {
                       return feature.kind == Feature::Kind::kTime;
                     });
}

// Everything that a stage changes, to be kept or rolled back.
struct Solution {
  Vector free;
  std::vector<Vector> sigmas;  // per training record
  Vector decays;
  std::vector<Matrix> trajectories;  // per training record
  double free_run_error = kInfinity;
  // Of the samples, what the fit has not used up.
  double share_left = 1.0;
  double cost = kInfinity;

  // The error to be expected of other samples of the same records, by
  // generalised cross-validation (P. Craven, G. Wahba, Numerische Mathematik 31
  // (1979) 377): a fit that follows the noise has a smaller error than the
  // truth.
  double ExpectedError() const { return free_run_error / share_left; }
};

// One start of an identification.
class Trainer {
 public:
  Trainer(const IdentificationProblem& problem,
          const IdentificationOptions& options, IdentificationSummary* summary)
      : problem_(problem),
        options_(options),
        tuning_(options.tuning),
        summary_(summary),
        layout_(problem),
        begin_(std::chrono::steady_clock::now()) {
    shooting_options_.derivatives = options.derivatives;
    shooting_options_.loss = options.loss;
    shooting_options_.loss_scale = options.loss_scale;
    shooting_options_.num_threads = options.num_threads;
    shooting_options_.starts = options.tuning.starts;
    shooting_ =
        std::make_unique<MultipleShooting>(problem, layout_, shooting_options_);
  }

  // Runs all stages from the values given. False, with the summary's message,
  // where nothing finite came out.
  bool Run(const Vector& parameters, const IdentifiedModel* initial);

  // Set where the fit ended with the excitation's errors as unknowns.
  const std::optional<InputNoiseFit>& input_noise() const {
    return input_noise_;
  }

  const Solution& best() const { return best_; }
  int stage() const { return stage_; }
  bool interrupted() const { return interrupted_; }
  const ParameterLayout& layout() const { return layout_; }
  MultipleShooting* shooting() { return shooting_.get(); }
  const MultipleShooting::Options& shooting_options() const {
    return shooting_options_;
  }
  bool converged() const { return converged_; }
  // Whether this start is better than another: by what predicts, or, without
  // records, by the cost.
  bool IsBetterThan(const Trainer& other) const {
    return shooting_->train_records().empty()
               ? best_.cost < other.best_.cost
               : best_.ExpectedError() < other.best_.ExpectedError();
  }
  Vector Parameters(const Vector& free) const {
    Vector all = layout_.InitialValues();
    layout_.SetFree(free, &all);
    return all;
  }

 private:
  class Callback;

  // Tells the caller where the fit is; false where it is to stop.
  bool GoOn(const Vector& free, double cost);
  // The last step of a fit with a noisy excitation, where it is possible.
  void FitInputNoise();
  double SmallestNoise(const MeasuredChannel& channel) const;
  void SetInitialNoise(const IdentifiedModel* initial);
  // What a fit goes on with, without starts: these values, or, while annealed
  // networks have not caught up, what the stages before have found.
  IdentifiedModel ModelToKeep(const Vector& free);
  // Below the misfit that networks are allowed, the simpler one counts as the
  // better.
  bool IsWorseThanBest(const Solution& solution) const {
    if (HasNetworks() &&
        solution.free_run_error <= tuning_.noise.smallest_misfit) {
      return false;
    }
    return !(solution.ExpectedError() <=
             (1.0 + tuning_.stages.worse_share) * best_.ExpectedError());
  }
  std::vector<int> StageLengths() const;
  bool RunStage(int samples, bool last);
  // Where annealed noise comes down to: what the first fit has left over
  // without a memory. The rest may be there to be learned, and is what the
  // noise does not exceed afterwards. Without a first fit as far as it may, and
  // no limit.
  void MeasureNoise();
  // Draws the networks anew and raises the noise, see AnnealingTuning.
  void BeginAnnealing();
  bool HasNetworks() const { return layout_.HasNetworkDecay(); }
  // The hidden units of a network of time hardly move: its first step is that
  // of a linear fit.
  double FirstRadius() const {
    const auto& networks = problem_.dynamics->networks();
    return !HasNetworks() ||
                   std::all_of(networks.begin(), networks.end(), IsForceOfTime)
               ? tuning_.solve.first_radius
               : tuning_.solve.first_network_radius;
  }
  bool SolveRound(int max_iterations, double function_tolerance,
                  bool* converged);
  // True where neither moves any more. The noise grows only where the fit has
  // converged: before, the residuals tell of the way that is left.
  bool UpdateNoiseAndDecay(bool converged);
  // What the user set for a decay group; negative: the evidence chooses.
  double GivenDecay(int group) const {
    return layout_.decay_groups()[static_cast<size_t>(group)].given;
  }
  double ScoreFreeRuns(const Vector& free);
  std::string DescribeDivergence(const Divergence& divergence) const;
  bool IterationsLeft() const {
    return summary_->num_iterations < options_.max_num_iterations;
  }

  const IdentificationProblem& problem_;
  const IdentificationOptions& options_;
  const Tuning& tuning_;
  IdentificationSummary* summary_;
  ParameterLayout layout_;
  MultipleShooting::Options shooting_options_;
  std::unique_ptr<MultipleShooting> shooting_;
  std::chrono::steady_clock::time_point begin_;
  Vector first_free_;  // as the run began
  // What annealed noise comes down to, infinity once it has been there, and
  // what it does not exceed afterwards, per training record. Empty before the
  // annealing.
  std::vector<Vector> annealed_to_;
  std::vector<Vector> ceilings_;
  Solution current_;
  Solution best_;
  std::optional<InputNoiseFit> input_noise_;
  bool noise_is_quiet_ = false;
  bool interrupted_ = false;
  bool converged_ = false;
  int stage_ = 0;
  int num_stages_ = 0;
  int stage_samples_ = 0;
  double radius_ = 0.0;
  double free_run_error_ = kInfinity;  // the newest one measured
};

class Trainer::Callback final : public ceres::IterationCallback {
 public:
  Callback(Trainer* trainer, const Vector* free, int first_iteration)
      : trainer_(trainer), free_(free), first_iteration_(first_iteration) {}

  ceres::CallbackReturnType operator()(
      const ceres::IterationSummary& iteration) override {
    IdentificationSummary* summary = trainer_->summary_;
    IterationRecord record;
    record.stage = trainer_->stage_;
    record.segment_samples = trainer_->stage_samples_;
    record.iteration = first_iteration_ + iteration.iteration;
    record.cost = iteration.cost;
    record.gradient_norm = iteration.gradient_norm;
    record.step_norm = iteration.step_norm;
    record.trust_region_radius = iteration.trust_region_radius;
    record.largest_gap = trainer_->shooting_->LargestGap();
    record.accepted = iteration.step_is_successful;
    record.seconds = Seconds(trainer_->begin_);
    if (iteration.iteration > 0) {
      summary->num_iterations = record.iteration;
      if (!iteration.step_is_successful) ++summary->rejected_steps;
    }
    trainer_->radius_ = iteration.trust_region_radius;
    summary->iterations.push_back(record);
    VLOG(1) << "stage " << record.stage << " iteration " << record.iteration
            << " cost " << record.cost << " gap " << record.largest_gap
            << " radius " << record.trust_region_radius
            << (record.accepted ? "" : " rejected");
    return trainer_->GoOn(*free_, record.cost) ? ceres::SOLVER_CONTINUE
                                               : ceres::SOLVER_ABORT;
  }

 private:
  Trainer* trainer_;
  const Vector* free_;
  int first_iteration_;
};

bool Trainer::GoOn(const Vector& free, double cost) {
  if (!options_.callback) return true;
  const IdentifiedModel model = ModelToKeep(free);
  IdentificationProgress progress;
  progress.model = &model;
  progress.stage = stage_;
  progress.num_stages = num_stages_;
  progress.segment_samples = stage_samples_;
  progress.iteration =
      summary_->iterations.empty() ? 0 : summary_->iterations.back().iteration;
  progress.cost = cost;
  progress.largest_gap = shooting_->LargestGap();
  progress.free_run_error = free_run_error_;
  progress.elapsed_seconds = Seconds(begin_);
  if (progress.iteration > 0) {
    progress.expected_seconds = progress.elapsed_seconds *
                                options_.max_num_iterations /
                                progress.iteration;
  }
  interrupted_ = interrupted_ || !options_.callback(progress);
  return !interrupted_;
}

double Trainer::SmallestNoise(const MeasuredChannel& channel) const {
  const double floor =
      tuning_.noise.smallest * std::max(RmsOfPresent(channel.values), 1e-290);
  return HasNetworks() ? std::max(floor, tuning_.noise.smallest_misfit *
                                             Spread(channel.values))
                       : floor;
}

void Trainer::SetInitialNoise(const IdentifiedModel* initial) {
  current_.sigmas.clear();
  for (int r : shooting_->train_records()) {
    const IdentificationRecord& record =
        problem_.records[static_cast<size_t>(r)];
    Vector sigma(static_cast<int>(record.channels.size()));
    for (int c = 0; c < sigma.size(); ++c) {
      const MeasuredChannel& channel = record.channels[static_cast<size_t>(c)];
      const double share = HasNetworks() ? tuning_.noise.smallest_misfit
                                         : tuning_.noise.first_share;
      sigma[c] = channel.sigma > 0.0 ? channel.sigma
                                     : std::max(share * Spread(channel.values),
                                                SmallestNoise(channel));
    }
    const size_t index = static_cast<size_t>(r);
    if (initial != nullptr && index < initial->sigmas.size() &&
        initial->sigmas[index].size() == sigma.size() &&
        initial->sigmas[index].minCoeff() > 0.0) {
      sigma = initial->sigmas[index];
    }
    current_.sigmas.push_back(sigma);
  }
  current_.decays.resize(layout_.num_decay_groups());
  for (int g = 0; g < layout_.num_decay_groups(); ++g) {
    const double given = GivenDecay(g);
    current_.decays[g] = given >= 0.0 ? given : tuning_.evidence.first_decay;
  }
  if (initial != nullptr && initial->decays.size() == current_.decays.size()) {
    current_.decays = initial->decays;
  }
}

void Trainer::MeasureNoise() {
  std::vector<Vector> lowest, ceilings;
  for (const Vector& sigma : current_.sigmas) {
    lowest.push_back(Vector::Zero(sigma.size()));
    ceilings.push_back(Vector::Constant(sigma.size(), kInfinity));
  }
  if (!summary_->stages.empty()) {
    // Decays found on the way are of no use.
    const Vector decays = current_.decays;
    // Noise grows tenfold at most at once.
    for (int i = 0; i < tuning_.annealing.measuring_rounds; ++i)
      UpdateNoiseAndDecay(true);
    current_.decays = decays;
    ceilings = current_.sigmas;
    std::vector<Matrix> residuals;
    if (shooting_->WeightedResiduals(current_.free, false, &residuals,
                                     nullptr)) {
      for (size_t r = 0; r < residuals.size(); ++r) {
        for (Eigen::Index c = 0; c < residuals[r].rows(); ++c) {
          lowest[r][c] = current_.sigmas[r][c] *
                         std::sqrt(MemorylessMeanSquare(residuals[r].row(c)) /
                                   current_.share_left);
        }
      }
    }
  }
  annealed_to_ = std::move(lowest);
  ceilings_ = std::move(ceilings);
}

void Trainer::BeginAnnealing() {
  bool evidence = false;
  for (int g = 0; g < layout_.num_decay_groups(); ++g) {
    const auto& group = layout_.decay_groups()[static_cast<size_t>(g)];
    if (group.given >= 0.0 || group.network < 0) continue;
    evidence = true;
    const bool output =
        group.kind == ParameterLayout::DecayGroup::Kind::kOutput;
    current_.decays[g] = (output ? tuning_.annealing.output_decay : 1.0) *
                         tuning_.evidence.first_decay;
  }
  if (!evidence) return;
  MeasureNoise();
  for (int j = 0; j < layout_.num_free(); ++j) {
    const int g = layout_.DecayGroupOf(layout_.free()[static_cast<size_t>(j)]);
    if (g < 0 || GivenDecay(g) >= 0.0) continue;
    const auto& group = layout_.decay_groups()[static_cast<size_t>(g)];
    if (!problem_.dynamics->networks()[static_cast<size_t>(group.network)]
             .drawn) {
      continue;
    }
    const bool output =
        group.kind == ParameterLayout::DecayGroup::Kind::kOutput;
    current_.free[j] =
        (output ? 1.0 : tuning_.annealing.weights) * first_free_[j];
  }
  for (size_t r = 0; r < current_.sigmas.size(); ++r) {
    const IdentificationRecord& record =
        problem_.records[static_cast<size_t>(shooting_->train_records()[r])];
    for (int c = 0; c < current_.sigmas[r].size(); ++c) {
      const MeasuredChannel& channel = record.channels[static_cast<size_t>(c)];
      if (channel.sigma > 0.0) continue;
      double& sigma = current_.sigmas[r][c];
      sigma = std::max(sigma, tuning_.annealing.noise * Spread(channel.values));
    }
  }
  radius_ = FirstRadius();
}

std::vector<int> Trainer::StageLengths() const {
  if (options_.shooting == IdentificationOptions::Shooting::kSingle) {
    return {0};
  }
  int longest = 0;
  for (int r : shooting_->train_records()) {
    longest = std::max(longest,
                       problem_.records[static_cast<size_t>(r)].num_samples());
  }
  std::vector<int> lengths;
  int first = options_.segment_samples;
  if (first == 0) {
    first = FirstSegmentSamples(problem_, tuning_.stages);
    // A model that lacks its nonlinear part goes astray sooner.
    if (HasNetworks())
      first = std::max(tuning_.stages.least_first_samples,
                       first / tuning_.stages.network_divisor);
  }
  for (int length = first; 2 * length < longest;
       length *= tuning_.stages.growth) {
    lengths.push_back(length);
  }
  lengths.push_back(0);
  return lengths;
}

IdentifiedModel Trainer::ModelToKeep(const Vector& free) {
  bool earlier = false;
  if (!annealed_to_.empty()) {
    current_.free_run_error = free_run_error_ = ScoreFreeRuns(free);
    earlier = IsWorseThanBest(current_);
  }
  const Solution& solution = earlier ? best_ : current_;
  IdentifiedModel model;
  model.parameters = Parameters(earlier ? best_.free : free);
  model.decays = solution.decays;
  model.sigmas.resize(problem_.records.size());
  for (size_t r = 0; r < solution.sigmas.size(); ++r) {
    const int record = shooting_->train_records()[r];
    model.sigmas[static_cast<size_t>(record)] = solution.sigmas[r];
  }
  model.stage = stage_;
  return model;
}

std::string Trainer::DescribeDivergence(const Divergence& divergence) const {
  if (!shooting_->modal_error().empty()) return shooting_->modal_error();
  if (!divergence.Happened()) return "the trajectory is not finite";
  const IdentificationRecord& record =
      problem_.records[static_cast<size_t>(divergence.record)];
  std::ostringstream text;
  text << "the trajectory of record '" << record.name
       << "' is not finite in segment " << divergence.segment + 1
       << " at t = " << record.excitation->time(divergence.sample)
       << " s, state "
       << problem_.dynamics->StateNames()[static_cast<size_t>(
              std::max(0, divergence.state))];
  return text.str();
}

double Trainer::ScoreFreeRuns(const Vector& free) {
  const Vector parameters = Parameters(free);
  double sum = 0.0;
  const std::vector<int>& train = shooting_->train_records();
  if (train.empty()) return 0.0;
  for (size_t t = 0; t < train.size(); ++t) {
    RecordScore score;
    ScoreRecord(problem_, train[t], parameters, shooting_->starts()[t].col(0),
                0, &score);
    if (!score.finite) return kInfinity;
    sum += score.nrmse * score.nrmse;
  }
  return std::sqrt(sum / static_cast<double>(train.size()));
}

bool Trainer::SolveRound(int max_iterations, double function_tolerance,
                         bool* converged) {
  *converged = false;
  const int n = layout_.num_free();
  Vector x = current_.free;
  auto* cost = new CondensedCost(shooting_.get(), n);
  ceres::Problem ceres_problem;
  ceres_problem.AddResidualBlock(cost, nullptr, x.data());
  for (int j = 0; j < n; ++j) {
    const Parameter& parameter =
        layout_.parameter(layout_.free()[static_cast<size_t>(j)]);
    if (std::isfinite(parameter.lower)) {
      ceres_problem.SetParameterLowerBound(x.data(), j, parameter.lower);
    }
    if (std::isfinite(parameter.upper)) {
      ceres_problem.SetParameterUpperBound(x.data(), j, parameter.upper);
    }
  }
  ceres::Solver::Options options;
  options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
  options.linear_solver_type =
      n <= 100 ? ceres::DENSE_QR : ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = std::min(
      max_iterations, options_.max_num_iterations - summary_->num_iterations);
  options.function_tolerance = function_tolerance;
  options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 0.0;
  options.initial_trust_region_radius = std::clamp(
      radius_, tuning_.solve.least_radius, tuning_.solve.most_radius);
  options.max_num_consecutive_invalid_steps = 50;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.update_state_every_iteration = true;
  if (HasNetworks()) {
    options.use_nonmonotonic_steps = true;
    options.max_consecutive_nonmonotonic_steps = tuning_.solve.uphill_steps;
  }
  Callback callback(this, &x, summary_->num_iterations);
  options.callbacks.push_back(&callback);
  if (options.max_num_iterations <= 0) return true;

  ceres::Solver::Summary ceres_summary;
  ceres::Solve(options, &ceres_problem, &ceres_summary);
  summary_->jacobian_seconds += cost->jacobian_seconds();
  summary_->linear_solver_seconds +=
      ceres_summary.linear_solver_time_in_seconds;
  summary_->failed_evaluations += cost->failed_evaluations();
  VLOG(2) << ceres_summary.FullReport();
  if (ceres_summary.termination_type == ceres::FAILURE &&
      ceres_summary.iterations.size() <= 1) {
    summary_->message = DescribeDivergence(shooting_->divergence());
    return false;
  }
  current_.free = x;
  *converged = ceres_summary.termination_type == ceres::CONVERGENCE;
  // Leave the shooting object linearised at the solution.
  CondensedSystem system;
  if (!shooting_->Linearize(current_.free, &system)) {
    summary_->message = DescribeDivergence(shooting_->divergence());
    return false;
  }
  current_.cost = system.cost;
  return true;
}

bool Trainer::UpdateNoiseAndDecay(bool converged) {
  CondensedSystem system;
  std::vector<Matrix> residuals, jacobians;
  Matrix root;
  // A force acts on some channels directly and can follow their noise: what it
  // has used up of each channel must be counted for that channel.
  const bool by_channel = !problem_.dynamics->unknown_forces().empty();
  if (!shooting_->Linearize(current_.free, &system) ||
      !shooting_->WeightedResiduals(current_.free, by_channel, &residuals,
                                    &jacobians) ||
      !SquareRoot(system.hessian, &root)) {
    return false;
  }
  const int n = layout_.num_free();
  const double effective_before = summary_->effective_parameters;

  // Diagonal of H^-1: how well the data and the priors determine each entry.
  const Matrix inverse_root =
      root.triangularView<Eigen::Upper>().solve(Matrix::Identity(n, n));
  const Vector variance = inverse_root.rowwise().squaredNorm();

  // MacKay's rule (Neural Computation 4 (1992) 415-447) with the Gauss-Newton
  // Hessian (F. D. Foresee and M. T. Hagan, ICNN 1997), per decay group. For
  // combinations of parameters it holds as CombinationPrior says.
  double effective = n;
  Vector determined = Vector::Zero(current_.decays.size());
  Vector squares = Vector::Zero(current_.decays.size());
  for (int j = 0; j < n; ++j) {
    const int index = layout_.free()[static_cast<size_t>(j)];
    const Parameter& parameter = layout_.parameter(index);
    if (!parameter.HasPrior()) continue;
    const double precision =
        1.0 / (parameter.prior_sigma * parameter.prior_sigma);
    effective -= std::min(1.0, precision * variance[j]);
  }
  for (const ParameterLayout::DecayRow& row : layout_.decay_rows()) {
    const double known =
        current_.decays[row.group] *
        (inverse_root.middleRows(row.first, row.weights.size()).transpose() *
         row.weights)
            .squaredNorm();
    const double value = row.Value(current_.free);
    determined[row.group] += 1.0 - std::min(1.0, known);
    squares[row.group] += value * value;
    effective -= std::min(1.0, known);
  }
  summary_->effective_parameters = effective;
  for (int g = 0; g < current_.decays.size(); ++g) {
    if (GivenDecay(g) >= 0.0) continue;
    const double wanted =
        std::max(determined[g], tuning_.evidence.least_determined) /
        std::max(squares[g], tuning_.evidence.least_squares);
    current_.decays[g] = std::clamp(
        wanted, 1.0 / tuning_.evidence.most_change * current_.decays[g],
        std::min(tuning_.evidence.most_decay,
                 tuning_.evidence.most_change * current_.decays[g]));
  }
  shooting_->SetDecays(current_.decays);

  // Noise per channel with the degrees of freedom that the fit has used up.
  double samples = 0.0;
  double used = effective;
  if (shooting_->modal() != nullptr) {
    // The modes' part, which the channels need not pay for.
    used -= (inverse_root.transpose() * shooting_->ModalInformation() *
             inverse_root)
                .trace();
  }
  summary_->followed_channel.clear();
  for (size_t r = 0; r < residuals.size(); ++r) {
    const IdentificationRecord& record =
        problem_.records[static_cast<size_t>(shooting_->train_records()[r])];
    for (const MeasuredChannel& channel : record.channels) {
      if (channel.fit) samples += CountPresent(channel.values);
    }
    // Closed gaps leave the first start alone.
    if (record.start == IdentificationRecord::Start::kFree) {
      used += problem_.dynamics->num_states();
    }
  }
  const double share = std::clamp(1.0 - used / std::max(1.0, samples),
                                  tuning_.noise.least_share_left, 1.0);
  current_.share_left = share;
  double noise_change = 0.0;
  for (size_t r = 0; r < residuals.size(); ++r) {
    const IdentificationRecord& record =
        problem_.records[static_cast<size_t>(shooting_->train_records()[r])];
    const int channels = static_cast<int>(residuals[r].rows());
    Vector leverages;  // of each residual, channels fastest
    if (by_channel) {
      leverages = (jacobians[r] * inverse_root).rowwise().squaredNorm();
    }
    for (int c = 0; c < channels; ++c) {
      const MeasuredChannel& channel = record.channels[static_cast<size_t>(c)];
      if (channel.sigma > 0.0 || !channel.fit) continue;
      const int present = CountPresent(channel.values);
      double left = share;
      if (by_channel) {
        double leverage = 0.0;
        for (Eigen::Index i = c; i < leverages.size(); i += channels) {
          leverage += leverages[i];
        }
        left = std::max(tuning_.noise.least_channel_left,
                        1.0 - leverage / std::max(1, present));
        if (left < tuning_.noise.followed &&
            summary_->followed_channel.empty()) {
          summary_->followed_channel =
              record.channels[static_cast<size_t>(c)].observation.name;
          summary_->followed_record = record.name;
        }
      }
      double mean_square =
          residuals[r].row(c).squaredNorm() / std::max(1, present) / left;
      // What a network leaves over is misfit with a memory. Weighed as
      // independent samples it would buy weights that fit it; it counts as
      // one sample per autocorrelation time.
      if (HasNetworks()) {
        mean_square *= AutocorrelationTime(residuals[r].row(c));
      }
      const double floor = SmallestNoise(channel);
      double& sigma = current_.sigmas[r][c];
      // Never much at once: early residuals mislead, and a network needs time
      // to find out what it can do without.
      const double shrink = HasNetworks()
                                ? 1.0 - tuning_.noise.network_step_down
                                : tuning_.noise.shrink;
      const double growth =
          HasNetworks() && !converged ? 1.0 : tuning_.noise.growth;
      double wanted = std::max(floor, sigma * std::sqrt(mean_square));
      if (!annealed_to_.empty()) {
        double& target = annealed_to_[r][c];
        const double lowest = std::max(floor, target);
        if (sigma <= lowest) target = kInfinity;
        wanted = std::max(
            floor,
            std::min(wanted, target == kInfinity ? ceilings_[r][c] : lowest));
      }
      noise_change = std::max(noise_change, std::abs(wanted / sigma - 1.0));
      sigma = std::clamp(wanted, std::max(floor, shrink * sigma),
                         std::max(floor, growth * sigma));
    }
  }
  shooting_->SetSigmas(current_.sigmas);
  VLOG(1) << "noise to change by " << noise_change << ", well-determined "
          << "parameters " << effective_before << " -> " << effective;
  noise_is_quiet_ = noise_change < tuning_.noise.quiet;
  return noise_is_quiet_ && std::abs(effective - effective_before) <
                                tuning_.evidence.quiet_share * n +
                                    tuning_.evidence.quiet_parameters;
}

bool Trainer::RunStage(int samples, bool last) {
  shooting_->SetSegments(samples, current_.trajectories);
  shooting_->SetSigmas(current_.sigmas);
  shooting_->SetDecays(current_.decays);
  std::vector<Vector> scales;
  for (const Matrix& states : current_.trajectories) {
    scales.push_back(StateScales(problem_, states));
  }
  shooting_->SetStateScales(scales);
  const bool single = shooting_->IsSingleShooting();
  stage_samples_ = samples;

  StageRecord record;
  record.segment_samples = samples;
  for (size_t r = 0; r < current_.trajectories.size(); ++r) {
    record.num_segments += shooting_->num_segments(static_cast<int>(r));
  }
  const int iterations_before = summary_->num_iterations;

  CondensedSystem system;
  shooting_->SetGapPenalty(1.0);
  if (!shooting_->Linearize(current_.free, &system)) {
    summary_->message = DescribeDivergence(shooting_->divergence());
    return false;
  }
  free_run_error_ = ScoreFreeRuns(current_.free);
  // Gaps begin softer than the data hold the starts, and end much firmer.
  const bool networks = HasNetworks();
  double firmness = single     ? 0.0
                    : networks ? tuning_.gaps.first_network_firmness
                               : tuning_.gaps.first_firmness;
  if (!single) {
    shooting_->SetGapPenalty(
        std::max(1.0, firmness * shooting_->DataCurvature()));
  }
  const int round_iterations = networks ? tuning_.solve.network_round_iterations
                                        : tuning_.solve.round_iterations;
  bool settled = false;
  // The first rounds are for noise levels, decay and multipliers to find their
  // place, and end early; the last one runs to the tolerance asked for.
  bool fine = false;
  int evidence_rounds = 0;
  bool quiet = false;  // noise and decay, as of the last round
  int quiet_rounds = 0;
  for (int round = 0; round < tuning_.solve.max_rounds && IterationsLeft();
       ++round) {
    bool converged = false;
    double tolerance =
        fine ? options_.function_tolerance : tuning_.solve.round_tolerance;
    if (networks && single) {
      // The cost is a negative logarithm of likelihood. Networks have valleys
      // without end; what changes it by less than this cannot be seen. Nor may
      // the rounds before end any sooner: a network that lies on a plateau
      // would stay there while the noise comes down.
      tolerance = std::clamp(tuning_.solve.smallest_change / current_.cost,
                             options_.function_tolerance,
                             tuning_.solve.most_network_tolerance);
    }
    const int fine_iterations = networks ? tuning_.solve.fine_network_iterations
                                         : options_.max_num_iterations;
    if (!SolveRound(fine ? fine_iterations : round_iterations, tolerance,
                    &converged)) {
      return false;
    }
    if (interrupted_) break;
    if (single) {
      if (networks && fine && converged &&
          (quiet || evidence_rounds >= 2 * tuning_.evidence.rounds)) {
        settled = true;
        break;
      }
      const double effective = summary_->effective_parameters;
      quiet = UpdateNoiseAndDecay(converged);
      if (networks) {
        const double change =
            std::abs(summary_->effective_parameters / effective - 1.0);
        quiet_rounds = noise_is_quiet_ && change < tuning_.evidence.quiet
                           ? quiet_rounds + 1
                           : 0;
        quiet = quiet_rounds >= tuning_.evidence.quiet_rounds;
        if (fine && change > tuning_.evidence.new_evidence) {
          fine = false;
          evidence_rounds = 0;
          continue;
        }
      }
      // Idle inputs go on fading long after that matters.
      evidence_rounds += noise_is_quiet_ ? 1 : 0;
      if (fine && converged) {
        settled = true;
        if (quiet && !networks) break;
      }
      fine = fine || quiet || evidence_rounds >= tuning_.evidence.rounds ||
             round + 1 >= tuning_.solve.max_rounds / 2;
      continue;
    }
    // The multipliers belong to the noise levels at hand: close gaps first.
    if (shooting_->LargestGap() < tuning_.gaps.closed && (converged || !last)) {
      settled = converged;
      break;
    }
    shooting_->UpdateMultipliers();
    UpdateNoiseAndDecay(converged);
    const double before = shooting_->gap_penalty();
    firmness =
        std::min(tuning_.gaps.most_firmness, tuning_.gaps.growth * firmness);
    CondensedSystem updated;
    if (!shooting_->Linearize(current_.free, &updated)) break;
    const double after =
        std::max(before, firmness * std::max(1.0, shooting_->DataCurvature()));
    shooting_->SetGapPenalty(after);
    shooting_->RescaleMultipliers(before / after);
  }
  record.iterations = summary_->num_iterations - iterations_before;
  record.largest_gap = shooting_->LargestGap();
  current_.free_run_error = ScoreFreeRuns(current_.free);
  record.free_run_error = current_.free_run_error;
  free_run_error_ = current_.free_run_error;
  std::vector<Matrix> trajectories;
  if (shooting_->Trajectories(current_.free, &trajectories)) {
    current_.trajectories = trajectories;
  }
  if (last) converged_ = settled;
  summary_->largest_gap = record.largest_gap;
  summary_->single_shooting = single;

  // A stage that makes the free run worse is undone.
  record.rolled_back = IsWorseThanBest(current_);
  summary_->stages.push_back(record);
  if (record.rolled_back) {
    current_ = best_;
  } else {
    best_ = current_;
  }
  return true;
}

bool Trainer::Run(const Vector& parameters, const IdentifiedModel* initial) {
  current_ = Solution();
  best_ = Solution();
  current_.free = layout_.Free(parameters);
  first_free_ = initial == nullptr ? current_.free
                                   : layout_.Free(layout_.InitialValues());
  radius_ = FirstRadius();
  SetInitialNoise(HasNetworks() && initial != nullptr && initial->stage > 0
                      ? nullptr
                      : initial);
  shooting_->SetSigmas(current_.sigmas);
  shooting_->SetDecays(current_.decays);
  const std::vector<int> lengths = StageLengths();
  num_stages_ = static_cast<int>(lengths.size());
  // A fit that was cut off goes on in its stage. With networks it begins at the
  // first one, from what was learned, since annealing needs to know what the
  // first fit leaves over. The results of an earlier fit are not drawn anew.
  const bool cut_off = initial != nullptr && initial->stage > 0;
  const size_t first =
      cut_off && !HasNetworks()
          ? static_cast<size_t>(std::min(initial->stage, num_stages_)) - 1
          : 0;
  const bool anneal = HasNetworks() && (initial == nullptr || cut_off);
  if (!InitialTrajectories(problem_, lengths[first], current_.free,
                           tuning_.stages, shooting_.get(),
                           &current_.trajectories)) {
    summary_->message = DescribeDivergence(shooting_->divergence());
    return false;
  }
  best_ = current_;
  bool gaps_closed = false;
  for (size_t s = first; s < lengths.size(); ++s) {
    const bool last = s + 1 == lengths.size();
    // With closed gaps the trajectory is already one piece: merging a few
    // segments would change nothing.
    if (!last && gaps_closed) continue;
    stage_ = static_cast<int>(s) + 1;
    const Solution before = current_;
    if (last && anneal) BeginAnnealing();
    if (!RunStage(lengths[s], last)) {
      // The whole record may not run freely: what the segments gave stands.
      if (summary_->stages.empty()) return false;
      VLOG(1) << "stage " << stage_ << " abandoned: " << summary_->message;
      current_ = before;
      break;
    }
    gaps_closed = summary_->stages.back().largest_gap <
                      tuning_.gaps.nearly_closed * tuning_.gaps.closed &&
                  !summary_->stages.back().rolled_back;
    if (interrupted_ || !IterationsLeft()) break;
  }
  if (converged_ && !interrupted_) FitInputNoise();
  return true;
}

void Trainer::FitInputNoise() {
  if (!summary_->single_shooting ||
      options_.covariance != IdentificationOptions::Covariance::kAuto ||
      !CanFitWithInputNoise(problem_, options_.loss)) {
    return;
  }
  InputNoiseFit fit;
  fit.free = best_.free;
  fit.sigmas = best_.sigmas;
  fit.trajectories = best_.trajectories;
  std::string error;
  if (FitWithInputNoise(
          problem_, layout_, shooting_options_, best_.decays,
          [this](const Vector& free, double cost) { return GoOn(free, cost); },
          &fit, &error)) {
    best_.free = fit.free;
    best_.sigmas = fit.sigmas;
    best_.trajectories = fit.trajectories;
    best_.cost = fit.cost;
    input_noise_ = std::move(fit);
  } else if (!interrupted_) {
    LOG(WARNING) << "the noise of the excitation enters the intervals alone: "
                    "with the excitation's errors as unknowns, "
                 << error;
  }
}

// What the estimate says about one parameter.
ParameterEstimate MakeEstimate(const Parameter& parameter, double value,
                               double sigma, double quantile) {
  ParameterEstimate estimate;
  estimate.name = parameter.name;
  estimate.unit = parameter.unit;
  estimate.initial = parameter.value;
  estimate.value = value;
  estimate.free = parameter.free;
  estimate.sigma = parameter.free ? sigma : 0.0;
  estimate.lower95 = value - quantile * estimate.sigma;
  estimate.upper95 = value + quantile * estimate.sigma;
  const double span = 1e-9 * std::max(1.0, std::abs(value));
  estimate.at_bound = parameter.free && (value <= parameter.lower + span ||
                                         value >= parameter.upper - span);
  return estimate;
}

// The record in which an unknown force acts.
int RecordOf(const IdentificationProblem& problem, const UnknownForceTerm& term,
             const std::vector<int>& train) {
  if (term.input < 0) return train.front();
  for (size_t r = 0; r < problem.records.size(); ++r) {
    if (problem.records[r].excitation->samples()(term.input, 0) != 0.0) {
      return static_cast<int>(r);
    }
  }
  return train.front();
}

// Precisions for the bands of forces with a smoothness of its own for each
// neighbourhood of knots. The evidence takes each second difference as known to
// be about as large as it came out, and many as none at all: a band from that
// is far too narrow where a force strikes, between the samples above all. So
// there every variance is the mean of those within
// ForceBandTuning::pooled_samples.
Vector BandDecays(const IdentificationProblem& problem,
                  const ParameterLayout& layout, const std::vector<int>& train,
                  const Vector& decays, const ForceBandTuning& tuning) {
  Vector pooled = decays;
  int first = 0;
  for (const UnknownForceTerm& term : problem.dynamics->unknown_forces()) {
    if (term.prior.combinations.empty() ||
        !term.parameters.parameters[0].free) {
      continue;
    }
    while (layout.decay_groups()[static_cast<size_t>(first)].kind !=
           ParameterLayout::DecayGroup::Kind::kForce) {
      ++first;
    }
    const int groups = term.prior.num_groups();
    const auto* spline = dynamic_cast<const SplineForce*>(term.history.get());
    if (spline != nullptr && term.prior.ShareToBeChosen() == 1.0) {
      const double width = spline->options().spacing *
                           static_cast<double>(term.prior.combinations.size()) /
                           groups;
      const double step =
          problem.records[static_cast<size_t>(RecordOf(problem, term, train))]
              .sampling_step();
      const int reach = static_cast<int>(
          std::ceil(tuning.pooled_samples * step / width - 1e-9));
      for (int g = 0; g < groups; ++g) {
        const int from = std::max(0, g - reach);
        const int to = std::min(groups - 1, g + reach);
        pooled[first + g] = 1.0 / decays.segment(first + from, to - from + 1)
                                      .cwiseMax(1e-300)
                                      .cwiseInverse()
                                      .mean();
      }
    }
    first += groups;
  }
  return pooled;
}

// A force of time alone: its value and its derivatives by the parameters from
// index `first` on.
struct ForceAt {
  double value = 0.0;
  int first = 0;
  Vector derivatives;
};

// `covariance` of all free parameters; empty: there is none.
ForceEstimate EstimateForce(const std::string& name,
                            const IdentificationProblem& problem,
                            const ParameterLayout& layout, int record,
                            const Matrix& covariance, double quantile,
                            const std::function<ForceAt(double)>& force) {
  const IdentificationRecord& data =
      problem.records[static_cast<size_t>(record)];
  ForceEstimate estimate;
  estimate.name = name;
  estimate.record = record;
  const int count = (data.num_samples() - 1) * data.substeps + 1;
  estimate.times.resize(count);
  estimate.value.resize(count);
  estimate.sigma = Vector::Zero(count);
  for (int i = 0; i < count; ++i) {
    estimate.times[i] =
        data.excitation->time(0) + i * data.sampling_step() / data.substeps;
    const ForceAt at = force(estimate.times[i]);
    estimate.value[i] = at.value;
    std::vector<int> indices;
    std::vector<double> slopes;
    for (int a = 0; a < at.derivatives.size(); ++a) {
      const int index = layout.FreeIndex(at.first + a);
      if (index < 0) continue;
      indices.push_back(index);
      slopes.push_back(at.derivatives[a]);
    }
    if (indices.empty()) continue;
    if (covariance.size() == 0) {
      estimate.sigma[i] = kInfinity;
      continue;
    }
    const Eigen::Map<const Vector> slope(slopes.data(),
                                         static_cast<int>(slopes.size()));
    const double variance = slope.dot(covariance(indices, indices) * slope);
    estimate.sigma[i] =
        std::isnan(variance) ? kInfinity : std::sqrt(std::max(0.0, variance));
  }
  estimate.lower95 = estimate.value - quantile * estimate.sigma;
  estimate.upper95 = estimate.value + quantile * estimate.sigma;
  return estimate;
}

std::vector<ForceEstimate> EstimateForces(const IdentificationProblem& problem,
                                          const ParameterLayout& layout,
                                          const std::vector<int>& train,
                                          const Vector& parameters,
                                          const Matrix& covariance,
                                          double quantile) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  std::vector<ForceEstimate> forces;
  if (train.empty()) return forces;
  for (size_t j = 0; j < dynamics.unknown_forces().size(); ++j) {
    const UnknownForceTerm& term = dynamics.unknown_forces()[j];
    const int offset = dynamics.block_offset(
        dynamics.unknown_force_block(static_cast<int>(j)));
    forces.push_back(EstimateForce(
        term.name, problem, layout, RecordOf(problem, term, train), covariance,
        quantile, [&](double time) {
          const ForceHistory::Local local =
              term.history->Evaluate(time, parameters.data() + offset);
          return ForceAt{
              local.value, offset + local.first,
              Eigen::Map<const Vector>(local.derivatives, local.count)};
        }));
  }
  for (size_t j = 0; j < dynamics.networks().size(); ++j) {
    const NetworkTerm& term = dynamics.networks()[j];
    if (!IsForceOfTime(term)) continue;
    const int offset =
        dynamics.block_offset(dynamics.network_block(static_cast<int>(j)));
    const Network& network = *term.network;
    NetworkTangent tangent(network);
    for (int o = 0; o < network.num_outputs(); ++o) {
      const std::string name = network.num_outputs() == 1
                                   ? term.name
                                   : term.name + "_" + std::to_string(o + 1);
      forces.push_back(EstimateForce(
          name, problem, layout, train.front(), covariance, quantile,
          [&](double time) {
            const Vector q = Vector::Constant(network.num_inputs(), time);
            network.Linearize(q.data(), parameters.data() + offset, &tangent);
            // A network resists; the force pushes.
            return ForceAt{-tangent.value()[o], offset,
                           -network.WeightJacobian(tangent).row(o)};
          }));
    }
  }
  return forces;
}

void ScoreEverything(const IdentificationProblem& problem,
                     const Vector& prior_parameters, const Vector& parameters,
                     const std::vector<int>& train,
                     const std::vector<Matrix>& starts,
                     const std::vector<Vector>& train_sigmas,
                     const NoiseTuning& tuning, IdentificationSummary* summary,
                     IdentifiedModel* model) {
  summary->records.assign(problem.records.size(), RecordScore());
  model->starts.assign(problem.records.size(), Vector());
  model->sigmas.assign(problem.records.size(), Vector());
  for (size_t r = 0; r < problem.records.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    const int index = static_cast<int>(r);
    const auto position = std::find(train.begin(), train.end(), index);
    const bool is_train = position != train.end();
    const size_t t = static_cast<size_t>(position - train.begin());
    Vector sigmas(static_cast<int>(record.channels.size()));
    for (int c = 0; c < sigmas.size(); ++c) {
      const MeasuredChannel& channel = record.channels[static_cast<size_t>(c)];
      sigmas[c] =
          channel.sigma > 0.0
              ? channel.sigma
              : std::max(tuning.first_share * Spread(channel.values), 1e-290);
    }
    if (is_train) {
      sigmas = train_sigmas[t];
    } else {
      // A sensor of a training record is the same sensor here.
      for (int c = 0; c < sigmas.size(); ++c) {
        const MeasuredChannel& channel =
            record.channels[static_cast<size_t>(c)];
        if (channel.sigma > 0.0) continue;
        for (size_t k = 0; k < train.size(); ++k) {
          const auto& others =
              problem.records[static_cast<size_t>(train[k])].channels;
          for (size_t o = 0; o < others.size(); ++o) {
            if (others[o].fit &&
                others[o].observation.name == channel.observation.name) {
              sigmas[c] = train_sigmas[k][static_cast<int>(o)];
            }
          }
        }
      }
    }
    model->sigmas[r] = sigmas;

    RecordScore prior;
    Vector start;
    int first = FreeRunStart(problem, index, prior_parameters, sigmas, &start);
    ScoreRecord(problem, index, prior_parameters, start, first, &prior);

    RecordScore& score = summary->records[r];
    if (is_train) {
      start = starts[t].col(0);
      first = 0;
    } else {
      first = FreeRunStart(problem, index, parameters, sigmas, &start);
    }
    ScoreRecord(problem, index, parameters, start, first, &score);
    model->starts[r] = start;
    score.prior_nrmse = prior.nrmse;
    for (size_t c = 0; c < score.channels.size(); ++c) {
      score.channels[c].prior_nrmse = prior.channels[c].nrmse;
      score.channels[c].sigma = sigmas[static_cast<int>(c)];
    }
  }
}

// Measured modes beside those of the models before and after.
void ScoreModes(const IdentificationProblem& problem,
                const Vector& prior_parameters, const Vector& parameters,
                IdentificationSummary* summary) {
  if (problem.modal.empty()) return;
  const StructuralDynamics& dynamics = *problem.dynamics;
  std::vector<ModeMatch> initial, updated;
  std::string error;
  if (!MatchModes(problem.modal,
                  dynamics.CorrectedModel(
                      prior_parameters.head(dynamics.num_parameters())),
                  &initial, &error) ||
      !MatchModes(
          problem.modal,
          dynamics.CorrectedModel(parameters.head(dynamics.num_parameters())),
          &updated, &error)) {
    return;
  }
  for (size_t i = 0; i < problem.modal.modes.size(); ++i) {
    const MeasuredMode& mode = problem.modal.modes[i];
    summary->modes.push_back(
        {mode.name, mode.frequency, initial[i], updated[i]});
  }
}

// Half the sum of squares of the modal residuals; infinite where there are
// none to be had.
double ModalCost(const IdentificationProblem& problem,
                 const ParameterLayout& layout, const Vector& parameters) {
  if (problem.modal.empty()) return 0.0;
  const StructuralDynamics& dynamics = *problem.dynamics;
  StructuralDynamics::Prepared prepared;
  std::string error;
  Vector residuals;
  if (!dynamics.Prepare(parameters.head(dynamics.num_parameters()), &prepared,
                        &error) ||
      !ModalResidual(problem.modal, dynamics, layout)
           .Evaluate(prepared, &residuals, nullptr, &error)) {
    return kInfinity;
  }
  return 0.5 * residuals.squaredNorm();
}

// Where modes have weights and no sigma, and nothing else is fitted, what is
// left over says how large their errors are, as it does for channels. Where
// nothing is left there is no covariance.
bool ScaleToResiduals(const ModalResidual& modal, double cost,
                      double effective_parameters,
                      CovarianceEstimate* covariance) {
  const double determined =
      effective_parameters - static_cast<double>(covariance->null_space.cols());
  const double left =
      modal.num_residuals() - modal.num_eliminated() - determined;
  if (left < 0.5) return false;
  covariance->covariance *= 2.0 * cost / left;
  covariance->quantile = StudentQuantile(left);
  return true;
}

// The design's definition of "usable"; says why not.
void Judge(const GapTuning& tuning, IdentificationSummary* summary) {
  std::ostringstream reason;
  summary->usable = false;
  // Both have said why already.
  if (summary->termination == Termination::kFailure ||
      summary->termination == Termination::kInterrupted) {
    return;
  }
  for (const RecordScore& score : summary->records) {
    const bool train = score.role == IdentificationRecord::Role::kTrain;
    if (!score.finite) {
      reason << "the free run of record '" << score.name << "' is not finite";
    } else if (train ? score.nrmse >= score.prior_nrmse
                     : score.nrmse > score.prior_nrmse) {
      reason << "record '" << score.name << "' is not predicted better (nrmse "
             << score.nrmse << ") than by the model before ("
             << score.prior_nrmse << ")";
    } else {
      continue;
    }
    summary->message = reason.str();
    return;
  }
  const bool alone =
      std::none_of(summary->records.begin(), summary->records.end(),
                   [](const RecordScore& score) {
                     return score.role == IdentificationRecord::Role::kTrain;
                   });
  if (!summary->modes.empty() && alone &&
      summary->final_modal_cost >= summary->initial_modal_cost) {
    reason << "the measured modes are not met better (cost "
           << summary->final_modal_cost << ") than by the model before ("
           << summary->initial_modal_cost << ")";
    summary->message = reason.str();
    return;
  }
  if (summary->largest_gap > tuning.closed) {
    reason << "gaps between segments stayed open (" << summary->largest_gap
           << " of the state's RMS)";
    summary->message = reason.str();
    return;
  }
  if (summary->termination == Termination::kNoConvergence) {
    reason << "not converged after " << summary->num_iterations
           << " iterations; raise options.max_iterations";
    summary->message = reason.str();
    return;
  }
  if (!summary->followed_channel.empty()) {
    reason << "an unknown force follows channel '" << summary->followed_channel
           << "' of record '" << summary->followed_record
           << "' nearly sample by sample, so that the channel's noise cannot "
              "be estimated; give its sigma";
    summary->message = reason.str();
    return;
  }
  summary->usable = true;
}

// Another start for a multistart: within bounds and priors, networks reseeded.
Vector DrawStart(const IdentificationProblem& problem,
                 const ParameterLayout& layout, const MultistartTuning& tuning,
                 uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&random]() {
    return (static_cast<double>(random() >> 11) + 0.5) * 0x1.0p-53;
  };
  Vector values = layout.InitialValues();
  for (int index : layout.free()) {
    const Parameter& parameter = layout.parameter(index);
    if (!layout.IsNamed(index)) continue;
    double low = parameter.lower;
    double high = parameter.upper;
    if (parameter.HasPrior()) {
      low = std::max(low, parameter.prior_mean -
                              tuning.prior_deviations * parameter.prior_sigma);
      high = std::min(high, parameter.prior_mean + tuning.prior_deviations *
                                                       parameter.prior_sigma);
    }
    if (!std::isfinite(low) || !std::isfinite(high)) continue;
    values[index] = low + (high - low) * uniform();
  }
  const StructuralDynamics& dynamics = *problem.dynamics;
  for (size_t j = 0; j < dynamics.networks().size(); ++j) {
    const int block = dynamics.network_block(static_cast<int>(j));
    const Vector weights = InitializeWeights(
        dynamics.networks()[j].network->architecture(), random(), true);
    for (int i = 0; i < weights.size(); ++i) {
      const int index = dynamics.block_offset(block) + i;
      if (layout.FreeIndex(index) >= 0) values[index] = weights[i];
    }
  }
  return values;
}

}  // namespace

void Identify(const IdentificationProblem& problem,
              const IdentificationOptions& options,
              const IdentifiedModel* initial, IdentificationSummary* summary,
              IdentifiedModel* model) {
  *summary = IdentificationSummary();
  *model = IdentifiedModel();
  std::string error;
  if (!problem.IsValid(&error) || !options.IsValid(&error)) {
    summary->message = error;
    return;
  }
  const auto begin = std::chrono::steady_clock::now();
  std::unique_ptr<Trainer> best;
  IdentificationSummary best_summary;
  int num_starts = 0;
  std::vector<double> costs;  // of the starts that came to an end
  for (int start = 0; start < std::max(1, options.num_starts); ++start) {
    IdentificationSummary attempt;
    ++num_starts;
    auto trainer = std::make_unique<Trainer>(problem, options, &attempt);
    Vector parameters = trainer->layout().InitialValues();
    if (start > 0) {
      parameters =
          DrawStart(problem, trainer->layout(), options.tuning.multistart,
                    options.seed + static_cast<uint64_t>(start));
    } else if (initial != nullptr) {
      CHECK_EQ(initial->parameters.size(), parameters.size())
          << "the initial model belongs to another problem";
      parameters = initial->parameters;
    } else {
      ScanPulses(problem, &parameters);
    }
    const bool ok = trainer->Run(parameters, start == 0 ? initial : nullptr);
    const bool interrupted = trainer->interrupted();
    if (ok) costs.push_back(trainer->best().cost);
    if (!ok) {
      if (best == nullptr) best_summary = attempt;
    } else if (best == nullptr || trainer->IsBetterThan(*best)) {
      best = std::move(trainer);
      best_summary = attempt;
    }
    if (interrupted) break;
  }
  *summary = best_summary;
  if (best == nullptr) {
    summary->termination = Termination::kFailure;
    summary->seconds = Seconds(begin);
    return;
  }

  const Solution& solution = best->best();
  const ParameterLayout& layout = best->layout();
  summary->num_starts = num_starts;
  summary->num_starts_at_best = static_cast<int>(std::count_if(
      costs.begin(), costs.end(),
      [&solution,
       same_cost = options.tuning.multistart.same_cost](double cost) {
        return cost <= solution.cost + same_cost * std::abs(solution.cost);
      }));
  MultipleShooting* shooting = best->shooting();
  model->decays = solution.decays;
  model->stage = best->converged() ? 0 : best->stage();
  summary->decays.assign(solution.decays.data(),
                         solution.decays.data() + solution.decays.size());
  if (!summary->iterations.empty()) {
    summary->initial_cost = summary->iterations.front().cost;
  }
  summary->termination = best->interrupted() ? Termination::kInterrupted
                         : best->converged() ? Termination::kConverged
                                             : Termination::kNoConvergence;
  summary->message = best->interrupted() ? "interrupted; best so far"
                     : best->converged() ? "converged"
                                         : "not converged";

  // The shooting object at the solution: single where that runs.
  shooting->SetSigmas(solution.sigmas);
  shooting->SetDecays(solution.decays);
  shooting->SetSegments(
      summary->single_shooting ? 0 : summary->stages.back().segment_samples,
      solution.trajectories);
  CovarianceEstimate covariance;
  const Vector band_decays =
      BandDecays(problem, layout, shooting->train_records(), solution.decays,
                 options.tuning.force_bands);
  bool has_covariance = false;
  std::vector<Matrix> starts;
  if (best->input_noise().has_value()) {
    InputNoiseFit fit = *best->input_noise();
    starts = fit.starts;
    has_covariance =
        problem.dynamics->unknown_forces().empty() ||
        InputNoiseCovariance(problem, layout, best->shooting_options(),
                             band_decays, &fit);
    covariance = fit.covariance;
  } else {
    double cost = 0.0;
    const bool evaluated = shooting->Evaluate(solution.free, &cost);
    starts = shooting->starts();
    shooting->SetDecays(band_decays);
    has_covariance =
        evaluated &&
        EstimateCovariance(problem, layout, options.covariance, solution.free,
                           solution.sigmas, shooting, &covariance);
  }
  summary->final_cost = solution.cost;
  model->parameters = best->Parameters(solution.free);
  ScoreEverything(problem, layout.InitialValues(), model->parameters,
                  shooting->train_records(), starts, solution.sigmas,
                  options.tuning.noise, summary, model);

  if (!problem.modal.empty()) {
    ScoreModes(problem, layout.InitialValues(), model->parameters, summary);
    summary->initial_modal_cost =
        ModalCost(problem, layout, layout.InitialValues());
    summary->final_modal_cost = ModalCost(problem, layout, model->parameters);
    if (has_covariance && shooting->train_records().empty() &&
        !problem.modal.HasSigmas()) {
      has_covariance =
          ScaleToResiduals(*shooting->modal(), summary->final_modal_cost,
                           summary->effective_parameters, &covariance);
    }
  }

  std::vector<int> named;
  for (int i = 0; i < layout.num_parameters(); ++i) {
    if (!layout.IsNamed(i)) continue;
    const int j = layout.FreeIndex(i);
    const double sigma =
        j >= 0 && has_covariance
            ? std::sqrt(std::max(0.0, covariance.covariance(j, j)))
            : (j >= 0 ? kInfinity : 0.0);
    summary->parameters.push_back(MakeEstimate(
        layout.parameter(i), model->parameters[i], sigma, covariance.quantile));
    if (j >= 0) {
      named.push_back(j);
      summary->covariance_names.push_back(layout.parameter(i).name);
    }
  }
  summary->forces = EstimateForces(
      problem, layout, shooting->train_records(), model->parameters,
      has_covariance ? covariance.covariance : Matrix(), covariance.quantile);
  if (has_covariance) {
    summary->covariance_method = covariance.method;
    const int count = static_cast<int>(named.size());
    summary->covariance.resize(count, count);
    for (int a = 0; a < count; ++a) {
      for (int b = 0; b < count; ++b) {
        summary->covariance(a, b) = covariance.covariance(
            named[static_cast<size_t>(a)], named[static_cast<size_t>(b)]);
      }
    }
    summary->undetermined = DescribeNullSpace(
        layout, WithUnseenGroups(problem, layout, covariance.covariance,
                                 covariance.null_space));
  }
  summary->seconds = Seconds(begin);
  Judge(options.tuning.gaps, summary);
}

}  // namespace pinode
