#include "pinode/estimate/fit/ways.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/dynamics/elements.h"
#include "pinode/estimate/shooting/score.h"

namespace pinode {
namespace {

using Shooting = IdentificationOptions::Shooting;

bool AnyFree(const ParameterBlock& block) {
  return std::any_of(block.parameters.begin(), block.parameters.end(),
                     [](const Parameter& parameter) { return parameter.free; });
}

void FixAll(ParameterBlock* block) {
  for (Parameter& parameter : block->parameters) parameter.free = false;
}

bool HasFreeLaws(const StructuralDynamics& dynamics) {
  const auto laws = dynamics.laws();
  return std::any_of(laws.begin(), laws.end(), [](const LawTerm& term) {
    return AnyFree(term.parameters);
  });
}

bool HasFreeNetworks(const StructuralDynamics& dynamics) {
  const auto networks = dynamics.networks();
  return std::any_of(
      networks.begin(), networks.end(),
      [](const NetworkTerm& term) { return AnyFree(term.weights); });
}

// A law without force. It replaces a law whose coefficients are all zero and
// stay so, to save its evaluation.
class NoForce final : public Law {
 public:
  explicit NoForce(const Law& law)
      : num_features_(law.num_features()),
        num_parameters_(law.num_parameters()),
        num_outputs_(law.num_outputs()) {}

  int num_features() const override { return num_features_; }
  int num_internal() const override { return 0; }
  int num_parameters() const override { return num_parameters_; }
  int num_outputs() const override { return num_outputs_; }
  bool IsIdle() const override { return true; }
  void Evaluate(const double* /*features*/, const double* /*internal*/,
                const double* /*parameters*/, double* result) const override {
    std::fill_n(result, num_outputs_, 0.0);
  }
  void Evaluate(const WideJet* /*features*/, const WideJet* /*internal*/,
                const WideJet* /*parameters*/, WideJet* result) const override {
    std::fill_n(result, num_outputs_, WideJet(0.0));
  }
  void Linearize(const double* features, const double* internal,
                 const double* parameters, double* result,
                 double* jacobian) const override {
    Evaluate(features, internal, parameters, result);
    std::fill_n(jacobian, num_outputs_ * num_arguments(), 0.0);
  }

 private:
  int num_features_, num_parameters_, num_outputs_;
};

// True if the law has no force: laws are linear in parameters that are
// coefficients or have the dimension of a force.
bool IsWithoutForce(const LawTerm& term) {
  const Vector values = term.parameters.Values();
  if (term.type == "library") return values.isZero(0.0);
  std::string unused;
  if (term.law->num_internal() > 0 ||
      CreateElement(term.type, &unused) == nullptr) {
    return false;
  }
  const std::vector<ElementParameterInfo> infos = ElementParameters(term.type);
  for (size_t k = 0; k < infos.size(); ++k) {
    if (infos[k].force_power != 0.0 &&
        values[static_cast<Eigen::Index>(k)] != 0.0) {
      return false;
    }
  }
  return true;
}

// Returns nullptr if a term cannot be removed together with its free
// parameters.
std::shared_ptr<const StructuralDynamics> LinearDynamicsOf(
    const StructuralDynamics& dynamics) {
  auto linear =
      std::make_shared<StructuralDynamics>(dynamics.model(), dynamics.inputs());
  std::string unused;
  size_t law = 0;
  size_t network = 0;
  for (int t = 0; t < dynamics.num_terms(); ++t) {
    bool added = false;
    if (dynamics.term(t).kind() == TermKind::kLaw) {
      LawTerm term = dynamics.laws()[law++];
      FixAll(&term.parameters);
      if (IsWithoutForce(term)) {
        term.law = std::make_shared<NoForce>(*term.law);
      }
      added = linear->AddLaw(std::move(term), &unused);
    } else if (dynamics.term(t).kind() == TermKind::kNetwork) {
      NetworkTerm term = dynamics.networks()[network++];
      FixAll(&term.weights);
      term.outputs.setZero();
      added = linear->AddNetwork(std::move(term), &unused);
    } else {
      added = linear->AddTerm(dynamics.term(t).Clone(), &unused);
    }
    if (!added) return nullptr;
  }
  return linear;
}

// One route, ended early after a given amount of work.
class Way {
 public:
  Way(const IdentificationProblem& problem,
      const IdentificationOptions& options, int64_t most_work)
      : fit_(std::make_unique<Fit>(problem, WithLimit(options, most_work))) {}

  // Returns false without a finite result, or after too much work.
  bool Run(const Vector& parameters, const IdentifiedModel* initial) {
    finite_ = fit_->Run(parameters, initial);
    ok_ = finite_ && !exhausted_;
    return ok_;
  }

  bool ok() const { return ok_; }
  bool exhausted() const { return exhausted_; }
  bool converged() const { return ok_ && fit_->converged(); }
  int64_t Work() const { return fit_->objective().shooting().sweep().work(); }
  bool interrupted() const { return fit_->interrupted() && !exhausted_; }
  Fit& fit() { return *fit_; }
  // Returns the fit; nullptr without a finite result. *outcome is the fit's
  // summary, except for its entries on routes.
  std::unique_ptr<Fit> Take(FitSummary* outcome) {
    const double linear_error = outcome->linear_error;
    std::string way = std::move(outcome->way);
    *outcome = fit_->summary();
    outcome->way = std::move(way);
    outcome->linear_error = linear_error;
    return finite_ ? std::move(fit_) : nullptr;
  }
  // RecordScore::nrmse of the training records together.
  double error() const { return ok_ ? fit_->best().free_run_error : kInfinity; }
  // The same for a route that was abandoned.
  double best_error() const { return fit_->best().free_run_error; }
  double expected_error() const {
    return ok_ ? fit_->best().ExpectedError() : kInfinity;
  }

 private:
  IdentificationOptions WithLimit(const IdentificationOptions& options,
                                  int64_t most_work) {
    if (most_work <= 0) return options;
    IdentificationOptions limited = options;
    limited.callback = [this, most_work, tell = options.callback](
                           const IdentificationProgress& progress) {
      exhausted_ = Work() > most_work;
      return !exhausted_ && (!tell || tell(progress));
    };
    return limited;
  }

  bool exhausted_ = false;
  bool finite_ = false;  // the result is finite, complete or not
  bool ok_ = false;
  std::unique_ptr<Fit> fit_;
};

// Returns the least share of noise in the residuals of any fitted channel of
// the training records.
double LeastNoiseShare(const IdentificationProblem& problem, const Fit& fit) {
  double least = 1.0;
  size_t t = 0;
  for (size_t r = 0; r < problem.records.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    if (record.role != IdentificationRecord::Role::kTrain) continue;
    RecordScore score;
    ScoreRecord(problem, static_cast<int>(r), fit.BestParameters(),
                fit.best().trajectories.records[t++].starts.col(0), 0, &score,
                Keep::kChannels, fit.shooting_options().num_threads);
    if (!score.finite) return 0.0;
    for (size_t c = 0; c < record.channels.size(); ++c) {
      const double share = score.channels[c].noise_share;
      // A channel without a share has no residual at all.
      if (record.channels[c].fit && std::isfinite(share)) {
        least = std::min(least, share);
      }
    }
  }
  return least;
}

std::string Percent(double error) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g %%", 100.0 * error);
  return text;
}

// Limits of a good fit: noise makes up at least this share of its residuals, or
// these are almost zero. Another minimum could not be much better.
constexpr double kNoise = 0.8;
constexpr double kNothing = 0.01;

// True if another route cannot improve the result.
bool LeavesOnlyNoise(const IdentificationProblem& problem, Way* way) {
  return way->ok() && way->fit().converged() &&
         (way->error() < kNothing ||
          LeastNoiseShare(problem, way->fit()) >= kNoise);
}

constexpr char kWholeRecords[] = "whole records at once";
constexpr char kStages[] = "stages of multiple shooting";
constexpr char kInOrder[] = "linear terms first, then all on whole records";
constexpr char kByStages[] = "all terms at once by stages of multiple shooting";

// Returns the better of two routes, and describes the choice.
std::unique_ptr<Fit> Better(Way* one, const std::string& one_name, Way* other,
                            const std::string& other_name,
                            FitSummary* outcome) {
  const bool swap =
      !one->ok() || other->expected_error() < one->expected_error();
  Way* best = swap ? other : one;
  Way* rest = swap ? one : other;
  outcome->way =
      (swap ? other_name : one_name) + " (error " + Percent(best->error()) +
      "); " + (swap ? one_name : other_name) +
      (rest->exhausted()
           ? ": stopped because it took too long"
           : (std::isfinite(rest->error()) ? ": error " + Percent(rest->error())
                                           : std::string(": nothing finite")));
  return best->Take(outcome);
}

// Fits terms in order, then, if needed, all at once.
std::unique_ptr<Fit> RunLaws(const IdentificationProblem& problem,
                             const IdentificationProblem& linear,
                             const IdentificationOptions& options,
                             const Vector& parameters, FitSummary* outcome) {
  // Multiple of the other route's work after which a route is abandoned.
  constexpr int64_t kMostWork = 3;
  // Error below which a linear model is near the solution.
  constexpr double kNear = 0.7;
  // Multiple of the linear model's work that the following fit on whole records
  // may take before it counts as lost.
  constexpr int64_t kMostWorkOfAll = 10;

  IdentificationOptions single = options;
  single.shooting = Shooting::kSingle;
  Way first(linear, single, 0);
  first.Run(parameters, nullptr);
  int64_t work = first.Work();
  Vector begin = first.ok() ? first.fit().BestParameters() : parameters;
  outcome->linear_error = first.error();
  if (!first.interrupted() && !(first.error() < kNear)) {
    Way by_stages(linear, options, 0);
    by_stages.Run(parameters, nullptr);
    work += by_stages.Work();
    if (by_stages.error() < first.error()) {
      begin = by_stages.fit().BestParameters();
      outcome->linear_error = by_stages.error();
    }
  }
  Way ordered(problem, single, kMostWorkOfAll * work);
  ordered.Run(begin, nullptr);
  work += ordered.Work();
  if (ordered.interrupted() || LeavesOnlyNoise(problem, &ordered)) {
    outcome->way = kInOrder;
    return ordered.Take(outcome);
  }
  Way staged(problem, options, ordered.ok() ? kMostWork * work : 0);
  staged.Run(parameters, nullptr);
  if (ordered.exhausted() && !staged.interrupted() &&
      !(staged.error() < ordered.best_error())) {
    // The abandoned route was the better one after all.
    Way longer(problem, single, 0);
    longer.Run(ordered.fit().BestParameters(), nullptr);
    return Better(&longer, kInOrder, &staged, kByStages, outcome);
  }
  if (staged.interrupted() &&
      (ordered.ok() ||
       (ordered.exhausted() && ordered.best_error() < staged.error()))) {
    outcome->way = std::string(kInOrder) + "; " + kByStages + ": interrupted";
    return ordered.Take(outcome);
  }
  return Better(&ordered, kInOrder, &staged, kByStages, outcome);
}

// Fits groups only: on whole records, where an iteration costs least. Then by
// the stages if the residuals contain more that a linear model might explain.
std::unique_ptr<Fit> RunLinear(const IdentificationProblem& problem,
                               const IdentificationOptions& options,
                               const Vector& parameters, FitSummary* outcome) {
  IdentificationOptions single = options;
  single.shooting = Shooting::kSingle;
  Way whole(problem, single, 0);
  whole.Run(parameters, nullptr);
  if (whole.interrupted() || LeavesOnlyNoise(problem, &whole)) {
    outcome->way = kWholeRecords;
    return whole.Take(outcome);
  }
  Way staged(problem, options, 0);
  staged.Run(parameters, nullptr);
  if (staged.interrupted() && whole.ok()) {
    outcome->way =
        std::string(kWholeRecords) + "; " + kStages + ": interrupted";
    return whole.Take(outcome);
  }
  return Better(&whole, kWholeRecords, &staged, kStages, outcome);
}

// Goes on from values near the end, such as those of a baseline: on whole
// records first. Ten steps are enough from such a start; a start that needs
// more than three times as many is left to the stages.
std::unique_ptr<Fit> RunFromStart(const IdentificationProblem& problem,
                                  const IdentificationOptions& options,
                                  const IdentifiedModel& start,
                                  FitSummary* outcome) {
  constexpr int kMostSteps = 30;

  IdentificationOptions single = options;
  single.shooting = Shooting::kSingle;
  single.max_num_iterations = std::min(options.max_num_iterations, kMostSteps);
  Way whole(problem, single, 0);
  whole.Run(start.parameters, &start);
  if (whole.interrupted() || LeavesOnlyNoise(problem, &whole)) {
    outcome->way = kWholeRecords;
    return whole.Take(outcome);
  }
  Way staged(problem, options, 0);
  staged.Run(start.parameters, &start);
  if (staged.interrupted() && whole.ok()) {
    outcome->way =
        std::string(kWholeRecords) + "; " + kStages + ": interrupted";
    return whole.Take(outcome);
  }
  // The limit of steps is not the user's.
  if (!whole.converged() && staged.converged()) {
    outcome->way = kStages;
    return staged.Take(outcome);
  }
  return Better(&whole, kWholeRecords, &staged, kStages, outcome);
}

// True if a start's values may be tried on whole records. An interrupted fit
// goes on in its stage, and networks are annealed in theirs.
bool MayStartOnWholeRecords(const IdentificationProblem& problem,
                            const IdentificationOptions& options,
                            const IdentifiedModel& start) {
  return start.resume_stage == 0 && options.shooting != Shooting::kSingle &&
         problem.num_train_records() > 0 && problem.ambient.empty() &&
         problem.dynamics->networks().empty();
}

// Trains networks, and again from the linear part if that is better.
std::unique_ptr<Fit> RunNetworks(const IdentificationProblem& problem,
                                 const IdentificationProblem& linear,
                                 const IdentificationOptions& options,
                                 const Vector& parameters,
                                 FitSummary* outcome) {
  // Error of the training records above which the result is poor.
  constexpr double kPoor = 0.5;

  Way staged(problem, options, 0);
  staged.Run(parameters, nullptr);
  if (staged.interrupted() || staged.error() < kPoor)
    return staged.Take(outcome);
  // Checkpoints are for the whole problem only.
  IdentificationOptions quiet = options;
  quiet.callback = [&options](const IdentificationProgress& progress) {
    IdentificationProgress without_model = progress;
    without_model.model = nullptr;
    return !options.callback || options.callback(without_model);
  };
  Way first(linear, quiet, 0);
  const bool began = first.Run(parameters, nullptr);
  outcome->linear_error = first.error();
  if (!began || first.interrupted() || staged.error() <= first.error()) {
    return staged.Take(outcome);
  }
  Way again(problem, options, 0);
  again.Run(first.fit().BestParameters(), nullptr);
  return Better(&again, "training that starts from the linear terms alone",
                &staged, "training from the beginning", outcome);
}

std::unique_ptr<Fit> RunDirectly(const IdentificationProblem& problem,
                                 const IdentificationOptions& options,
                                 const Vector& parameters,
                                 const IdentifiedModel* initial,
                                 FitSummary* outcome) {
  Way way(problem, options, 0);
  way.Run(parameters, initial);
  return way.Take(outcome);
}

}  // namespace

std::unique_ptr<IdentificationProblem> LinearPart(
    const IdentificationProblem& problem) {
  const StructuralDynamics& dynamics = *problem.dynamics;
  if (!HasFreeLaws(dynamics) && !HasFreeNetworks(dynamics)) return nullptr;
  auto linear = std::make_unique<IdentificationProblem>(problem);
  linear->dynamics = LinearDynamicsOf(dynamics);
  if (linear->dynamics == nullptr || ParameterLayout(*linear).num_free() == 0) {
    return nullptr;
  }
  return linear;
}

std::unique_ptr<Fit> RunWays(const IdentificationProblem& problem,
                             const IdentificationOptions& options,
                             const Vector& parameters,
                             const IdentifiedModel* initial,
                             FitSummary* summary) {
  if (initial != nullptr &&
      MayStartOnWholeRecords(problem, options, *initial)) {
    *summary = FitSummary();
    return RunFromStart(problem, options, *initial, summary);
  }
  const bool chosen = initial != nullptr ||
                      options.shooting == Shooting::kSingle ||
                      problem.num_train_records() == 0;
  const std::unique_ptr<IdentificationProblem> linear =
      chosen ? nullptr : LinearPart(problem);
  *summary = FitSummary();
  if (linear == nullptr) {
    return !chosen && problem.dynamics->IsLinear()
               ? RunLinear(problem, options, parameters, summary)
               : RunDirectly(problem, options, parameters, initial, summary);
  }
  return HasFreeNetworks(*problem.dynamics)
             ? RunNetworks(problem, *linear, options, parameters, summary)
             : RunLaws(problem, *linear, options, parameters, summary);
}

}  // namespace pinode
