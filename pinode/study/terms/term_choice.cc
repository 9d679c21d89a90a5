#include "pinode/study/terms/term_choice.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/stopwatch.h"
#include "pinode/discover/term_prices.h"
#include "pinode/estimate/certainty/fitted_cost.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/terms/term_proposal.h"
#include "pinode/study/terms/term_worth.h"

namespace pinode {
namespace {

bool IsTrainingRecord(const IdentificationRecord& record) {
  return record.role == IdentificationRecord::Role::kTrain;
}

// Hold-out records take no part in a choice, and cost time.
IdentificationProblem TrainingPart(const IdentificationProblem& problem) {
  IdentificationProblem part = problem;
  part.records.clear();
  for (const IdentificationRecord& record : problem.records) {
    if (IsTrainingRecord(record)) part.records.push_back(record);
  }
  return part;
}

IdentifiedModel TrainingPart(const IdentificationProblem& problem,
                             const IdentifiedModel& model) {
  IdentifiedModel part = model;
  part.sigmas.clear();
  part.starts.clear();
  for (size_t r = 0; r < problem.records.size(); ++r) {
    if (!IsTrainingRecord(problem.records[r])) continue;
    if (r < model.sigmas.size()) part.sigmas.push_back(model.sigmas[r]);
    if (r < model.starts.size()) part.starts.push_back(model.starts[r]);
  }
  return part;
}

// Noise and starts of the training records in the places that they have among
// all of `problem`; nothing is said of the others.
IdentifiedModel WithAllRecords(const IdentificationProblem& problem,
                               const IdentifiedModel& part) {
  IdentifiedModel model = part;
  model.sigmas.assign(problem.records.size(), Vector());
  model.starts.assign(problem.records.size(), Vector());
  size_t next = 0;
  for (size_t r = 0; r < problem.records.size(); ++r) {
    if (!IsTrainingRecord(problem.records[r])) continue;
    if (next < part.sigmas.size()) model.sigmas[r] = part.sigmas[next];
    if (next < part.starts.size()) model.starts[r] = part.starts[next];
    ++next;
  }
  return model;
}

class Chooser {
 public:
  Chooser(const IdentificationProblem& all,
          const std::vector<ModelCandidate>& candidates,
          const IdentificationOptions& options, InnerFit* inner,
          std::string* error)
      : all_(all),
        training_(TrainingPart(all)),
        candidates_(candidates),
        options_(options),
        inner_(*inner),
        error_(error),
        out_(candidates.size(), false) {}

  bool Run(TermFit* fit) {
    const auto begin = std::chrono::steady_clock::now();
    const double seconds_before = fit->summary.seconds;
    choice_ = fit->choice;
    if (!Begin(*fit)) return false;
    // Where the cost is as quadratic as it looks, it has left out the terms of
    // libraries already.
    const bool settled = interrupted_ || Propose();
    if (!interrupted_) Eliminate(!settled);
    if (!interrupted_) Propose();
    TermFit result;
    if (!Finish(*fit, &result)) return false;
    choice_.complete = !interrupted_;
    result.choice = choice_;
    result.summary.seconds = seconds_before + SecondsSince(begin);
    *fit = std::move(result);
    return true;
  }

 private:
  // The training part of the fit at hand. Where it has corrected its inputs, or
  // was cut off, it is done again as those that are compared with it.
  bool Begin(const TermFit& fit) {
    for (size_t i = 0; i < candidates_.size(); ++i) {
      out_[i] = std::count(choice_.left_out.begin(), choice_.left_out.end(),
                           candidates_[i].name) > 0;
    }
    choice_.candidates.clear();
    for (const ModelCandidate& candidate : candidates_) {
      choice_.candidates.push_back(candidate.name);
    }
    fit_.problem = TrainingPart(fit.problem);
    fit_.model = TrainingPart(fit.problem, fit.model);
    fit_.summary = fit.summary;
    fit_.summary.records.clear();
    bool again = fit.summary.termination == Termination::kInterrupted;
    for (size_t r = 0; r < fit.problem.records.size(); ++r) {
      const IdentificationRecord& record = fit.problem.records[r];
      if (!IsTrainingRecord(record)) continue;
      fit_.summary.records.push_back(fit.summary.records[r]);
      again = again || !record.NoisyInputs().empty();
    }
    if (again) {
      const TermFit from = fit_;
      if (!Fit(out_, from, "all candidates", &fit_)) return false;
      if (interrupted_) return true;
    }
    if (!IsGood(fit_)) {
      *error_ = "the fit with all candidates failed: " + fit_.summary.message;
      return false;
    }
    if (choice_.steps.empty()) {
      FittedCost around;
      if (!Linearize(fit_, &around)) {
        *error_ = "the cost of the fit with all candidates is not finite";
        return false;
      }
      choice_.memory = around.memory;
    }
    return true;
  }

  void Eliminate(bool library_terms_too) {
    std::vector<bool> tried = out_;
    for (size_t i = 0; i < candidates_.size() && !library_terms_too; ++i) {
      tried[i] = tried[i] || candidates_[i].is_library_term;
    }
    for (int next = Weakest(tried); next >= 0 && !interrupted_;
         next = Weakest(tried)) {
      tried[Index(next)] = true;
      std::vector<bool> out = out_;
      out[Index(next)] = true;
      Try(out);
    }
  }

  // Leaves out and takes in the terms of libraries that the cost asks for, as
  // long as the criterion becomes smaller. False where a fit did not confirm
  // what the cost promised.
  bool Propose() {
    // Each that is kept makes the criterion smaller; more than a few are none.
    constexpr int kMaxProposals = 10;
    for (int proposal = 0; proposal < kMaxProposals; ++proposal) {
      const std::vector<bool> out = Proposed();
      if (out == out_) return true;
      if (!Try(out)) return false;
    }
    return true;
  }

  // What the cost, quadratic near the fit in the coefficients of all libraries,
  // asks for. Elements stay as they are: without a force nothing says what
  // their other unknowns are.
  std::vector<bool> Proposed() const {
    std::vector<bool> wide = out_;
    bool any = false;
    for (size_t i = 0; i < candidates_.size(); ++i) {
      if (!candidates_[i].is_library_term || !MayBeZero(candidates_[i])) {
        continue;
      }
      wide[i] = false;
      any = true;
    }
    TermFit with;
    if (!any || !LeaveOutThose(training_, wide, &with.problem)) return out_;
    with.model = ModelOfOther(fit_.problem, fit_.model, with.problem);
    with.summary.records = fit_.summary.records;
    SetNewToZero(fit_.problem, with.problem, &with.model);
    FittedCost around;
    if (!Linearize(with, &around)) return out_;
    const ParameterLayout layout(with.problem);
    const Vector free = layout.Free(with.model.parameters);
    StepwiseOptions options;
    options.prices = Vector::Zero(layout.num_free());
    options.smallest = Vector::Zero(layout.num_free());
    options.optional.assign(Index(layout.num_free()), false);
    options.signs.assign(Index(layout.num_free()), 0);
    Vector from_zero = Vector::Zero(layout.num_free());
    std::vector<int> start;
    std::vector<std::pair<size_t, int>> entries;  // of each term
    for (size_t i = 0; i < candidates_.size(); ++i) {
      const int entry = layout.FreeIndex(candidates_[i].parameters[0]);
      if (!candidates_[i].is_library_term || wide[i] || entry < 0) continue;
      entries.emplace_back(i, entry);
      options.prices[entry] = PriceOf(candidates_[i]);
      options.optional[Index(entry)] = true;
      from_zero[entry] = free[entry];
      if (!out_[i]) start.push_back(entry);
    }
    const std::vector<int> support =
        SupportNearFit(around, choice_.memory, from_zero, options, start);
    std::vector<bool> out = out_;
    for (const auto& [candidate, entry] : entries) {
      out[candidate] =
          !std::binary_search(support.begin(), support.end(), entry);
    }
    return out;
  }

  // Fits without `out`, and keeps that where the criterion becomes smaller.
  bool Try(const std::vector<bool>& out) {
    ModelChoice::Step step;
    for (size_t i = 0; i < candidates_.size(); ++i) {
      if (out[i] == out_[i]) continue;
      (out[i] ? step.left_out : step.taken_in).push_back(candidates_[i].name);
      step.price += (out[i] ? -1.0 : 1.0) * PriceOf(candidates_[i]);
    }
    TermFit trial;
    const int left =
        static_cast<int>(std::count(out.begin(), out.end(), false));
    const bool began =
        Fit(out, fit_, std::to_string(left) + " candidates", &trial);
    if (interrupted_) return false;
    step.fitted = began && IsGood(trial);
    if (step.fitted) {
      step.deviance = (DevianceOf(trial) - DevianceOf(fit_)) / choice_.memory;
      step.accepted = step.criterion() < 0.0;
    }
    choice_.steps.push_back(step);
    if (step.accepted) {
      out_ = out;
      fit_ = std::move(trial);
      NoteLeftOut();
    }
    Report();
    return step.accepted;
  }

  void Report() const {
    if (inner_.watch() == nullptr) return;
    Checkpoint checkpoint;
    checkpoint.iteration = fit_.summary.num_iterations;
    checkpoint.cost = fit_.summary.final_cost;
    checkpoint.model = WithAllRecords(all_, fit_.model);
    checkpoint.choice = choice_;
    inner_.watch()->OnChoice(all_, checkpoint);
  }

  // The fit of all records without what is out. Where nothing is, that is the
  // one from which the choice began.
  bool Finish(const TermFit& first, TermFit* result) {
    if (choice_.left_out == first.choice.left_out) {
      *result = first;
      if (interrupted_) {
        result->summary.termination = Termination::kInterrupted;
        result->summary.message = "interrupted during the choice of terms";
      }
      return true;
    }
    if (!LeaveOutThose(all_, out_, &result->problem)) return false;
    const IdentifiedModel begin = ModelOfOther(
        fit_.problem, WithAllRecords(all_, fit_.model), result->problem);
    IdentificationOptions options = options_;
    BeginNearTheEnd(&options);
    options.num_starts = 1;
    inner_.Run("what is left", result->problem, options, &begin,
               &result->summary, &result->model);
    if (result->summary.termination == Termination::kFailure) {
      *error_ = "the fit without the dropped terms: " + result->summary.message;
      return false;
    }
    if (result->summary.termination == Termination::kInterrupted) {
      interrupted_ = true;
    }
    return true;
  }

  bool Fit(const std::vector<bool>& out, const TermFit& from,
           const std::string& what, TermFit* result) {
    if (!LeaveOutThose(training_, out, &result->problem)) return false;
    IdentifiedModel begin =
        ModelOfOther(from.problem, from.model, result->problem);
    SetNewToZero(from.problem, result->problem, &begin);
    IdentificationOptions options = options_;
    BeginNearTheEnd(&options);
    DecideQuickly(&options);
    options.num_starts = 1;
    // Wald values are to be those of the fit that takes inputs as exact, and of
    // residuals with whatever memory they have.
    options.covariance = IdentificationOptions::Covariance::kSandwich;
    options.prediction_bands = false;
    inner_.Run(what, result->problem, options, &begin, &result->summary,
               &result->model);
    interrupted_ = interrupted_ ||
                   result->summary.termination == Termination::kInterrupted;
    return true;
  }

  static bool IsGood(const TermFit& fit) {
    return (fit.summary.termination == Termination::kConverged ||
            fit.summary.termination == Termination::kNoConvergence) &&
           std::isfinite(DevianceOf(fit));
  }

  static double DevianceOf(const TermFit& fit) {
    return Deviance(fit.problem, fit.summary) +
           2.0 * fit.summary.final_modal_cost;
  }

  bool Linearize(const TermFit& fit, FittedCost* around) const {
    return LinearizeAtFit(fit.problem, ParameterLayout(fit.problem), fit.model,
                          fit.summary.records, options_.num_threads, around);
  }

  double PriceOf(const ModelCandidate& candidate) const {
    const ParameterLayout layout(all_);
    int free = 0;
    for (const std::string& name : candidate.parameters) {
      free += layout.FreeIndex(name) >= 0;
    }
    return ExtendedBicPrice(NumFittedValues(training_), free,
                            static_cast<double>(candidates_.size()));
  }

  // The one of those that were not tried whose Wald value is the smallest; -1
  // where none is left.
  int Weakest(const std::vector<bool>& tried) const {
    int weakest = -1;
    double smallest = kInfinity;
    for (size_t i = 0; i < candidates_.size(); ++i) {
      if (tried[i]) continue;
      const double wald = WaldValue(candidates_[i]);
      if (wald < smallest || weakest < 0) {
        weakest = static_cast<int>(i);
        smallest = wald;
      }
    }
    return weakest;
  }

  // Of the amplitudes that are free; 0 where nothing determines them.
  double WaldValue(const ModelCandidate& candidate) const {
    const FitSummary& summary = fit_.summary;
    std::vector<int> rows;
    std::vector<double> values;
    for (const std::string& name : candidate.amplitudes) {
      const auto row = std::find(summary.covariance_names.begin(),
                                 summary.covariance_names.end(), name);
      const ParameterEstimate* estimate = FindEstimate(summary, name);
      if (row == summary.covariance_names.end() || estimate == nullptr) {
        continue;
      }
      rows.push_back(static_cast<int>(row - summary.covariance_names.begin()));
      values.push_back(estimate->value);
    }
    if (rows.empty() ||
        summary.covariance.rows() !=
            static_cast<Eigen::Index>(summary.covariance_names.size())) {
      return 0.0;
    }
    const Matrix covariance = summary.covariance(rows, rows);
    const Vector theta = Eigen::Map<const Vector>(
        values.data(), static_cast<Eigen::Index>(values.size()));
    if (!covariance.allFinite()) return 0.0;
    const double wald = theta.dot(covariance.ldlt().solve(theta));
    return std::isfinite(wald) ? std::max(wald, 0.0) : 0.0;
  }

  bool MayBeZero(const ModelCandidate& candidate) const {
    const ParameterLayout layout(all_);
    const int entry = layout.FreeIndex(candidate.parameters[0]);
    return entry >= 0 && layout.free_parameter(entry).lower <= 0.0 &&
           layout.free_parameter(entry).upper >= 0.0;
  }

  // Terms that `from` did not have begin without a force.
  static void SetNewToZero(const IdentificationProblem& from,
                           const IdentificationProblem& problem,
                           IdentifiedModel* model) {
    const ParameterLayout before(from);
    const ParameterLayout layout(problem);
    for (int i = 0; i < layout.num_parameters(); ++i) {
      if (layout.FreeIndex(i) >= 0 &&
          before.FreeIndex(layout.parameter(i).name) < 0) {
        model->parameters[i] = 0.0;
      }
    }
  }

  bool LeaveOutThose(const IdentificationProblem& problem,
                     const std::vector<bool>& out,
                     IdentificationProblem* result) const {
    std::vector<ModelCandidate> gone;
    for (size_t i = 0; i < candidates_.size(); ++i) {
      if (out[i]) gone.push_back(candidates_[i]);
    }
    return LeaveOut(problem, gone, result, error_);
  }

  void NoteLeftOut() {
    choice_.left_out.clear();
    choice_.left_out_parameters.clear();
    for (size_t i = 0; i < candidates_.size(); ++i) {
      if (!out_[i]) continue;
      const ModelCandidate& candidate = candidates_[i];
      choice_.left_out.push_back(candidate.name);
      choice_.left_out_parameters.insert(choice_.left_out_parameters.end(),
                                         candidate.parameters.begin(),
                                         candidate.parameters.end());
    }
  }

  static size_t Index(int i) { return static_cast<size_t>(i); }

  const IdentificationProblem& all_;
  const IdentificationProblem training_;
  const std::vector<ModelCandidate>& candidates_;
  const IdentificationOptions& options_;
  InnerFit& inner_;
  std::string* error_;
  std::vector<bool> out_;  // of each candidate
  TermFit fit_;            // of what is left, by training records
  ModelChoice choice_;
  bool interrupted_ = false;
};

}  // namespace

bool ChooseTerms(const IdentificationProblem& all,
                 const std::vector<ModelCandidate>& candidates,
                 const IdentificationOptions& options, InnerFit* inner,
                 TermFit* fit, std::string* error) {
  if (!all.IsValid(error) || !options.IsValid(error) ||
      !AreCandidatesOf(all, candidates, error) ||
      !IsFitOf(fit->problem, fit->summary, fit->model, error)) {
    return false;
  }
  return Chooser(all, candidates, options, inner, error).Run(fit);
}

}  // namespace pinode
