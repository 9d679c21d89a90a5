#include "pinode/study/laws/refit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/discover/term_prices.h"
#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/fit/fit_checks.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/identify/identify.h"
#include "pinode/study/laws/discovered_terms.h"
#include "pinode/study/laws/score_without_fit.h"
#include "pinode/study/laws/term_rivals.h"
#include "pinode/study/problem/growth.h"
#include "pinode/study/problem/inner_fit.h"
#include "pinode/study/terms/discovered_problem.h"
#include "pinode/study/terms/segment_proposal.h"
#include "pinode/study/terms/term_proposal.h"
#include "pinode/study/terms/term_worth.h"

namespace pinode {
namespace {

constexpr int kLargestRefitFactor = 32;
// Each search that is kept lowers the criterion; more than a few are none.
constexpr int kMaxSearches = 20;

// One fit after the other, each beginning where the one before has ended.
class Refitter {
 public:
  Refitter(const IdentificationProblem& problem, const IdentifiedModel& model,
           const DiscoveryOptions& options,
           const IdentificationOptions& identification,
           IdentificationWatch* watch, Discovery* discovery, std::string* error)
      : problem_(problem),
        model_(model),
        options_(options),
        identification_(identification),
        announcing_(watch, this),
        inner_(&announcing_),
        rival_fits_(watch),
        discovery_(*discovery),
        error_(error),
        last_model_(model) {}

  bool Run(const std::vector<DiscoveredEquation>& equations,
           const std::vector<DiscoveredEquation>& begin) {
    discovery_.equations = begin;
    compared_ = begin;
    prices_ = TermPrices(NumFittedValues(problem_), equations);
    exact_ = false;
    if (!FirstSteps() || !Begin()) return false;
    if (discovery_.summary.termination != Termination::kInterrupted &&
        !CompareWithNoTerms()) {
      return false;
    }
    if (!Search() || !Prune(1) || !CompareWithRivalTerms(1)) return false;
    exact_ = true;
    for (int factor = 2; factor <= kLargestRefitFactor && Good() && Left();
         factor *= 2) {
      const std::vector<DiscoveredEquation> before = discovery_.equations;
      const Discovery coarse = discovery_;
      if (!Fit(factor)) return false;
      if (!Good()) {
        // What the coarser steps found stands.
        if (discovery_.summary.termination != Termination::kInterrupted) {
          discovery_ = coarse;
        }
        break;
      }
      // Terms that made up for the integrator are not missed by a better one.
      if (!Prune(factor)) return false;
      // Probabilities are of these terms.
      if (!SameTerms(compared_, discovery_.equations) &&
          !CompareWithRivalTerms(factor)) {
        return false;
      }
      if (SameTerms(before, discovery_.equations) && Agree(before)) break;
    }
    // The last fit is of a term that is not worth its place.
    if (!Left()) discovery_.refitted = false;
    if (discovery_.refitted) Judge();
    discovery_.dropped = Difference(equations, discovery_.equations);
    discovery_.added = Difference(discovery_.equations, equations);
    return true;
  }

 private:
  bool Good() const {
    return discovery_.summary.termination == Termination::kConverged ||
           discovery_.summary.termination == Termination::kNoConvergence;
  }
  bool Left() const { return CountTerms(discovery_.equations) > 0; }

  // Drops terms one by one, each followed by a fit of the others.
  bool Prune(int factor) {
    while (Good() && DropWeakest(options_, discovery_.summary, prices_,
                                 &discovery_.equations)) {
      if (!Left()) return true;
      if (!Fit(factor)) return false;
    }
    return true;
  }

  // Fits the terms to begin with: those that were regressed, or those chosen
  // from segments of the records, whichever have the smaller criterion. A
  // regression on noisy derivatives takes too few terms, and fits with these
  // are far from the records.
  bool Begin() {
    std::vector<DiscoveredEquation> proposed;
    const bool from_records = std::all_of(
        discovery_.equations.begin(), discovery_.equations.end(),
        [](const DiscoveredEquation& equation) {
          return equation.source == DiscoveryOptions::Source::kDerivatives;
        });
    if (options_.search && from_records &&
        !ProposeFromSegments(problem_, model_, discovery_.equations, options_,
                             prices_, identification_.num_threads, &proposed,
                             error_)) {
      return false;
    }
    if (CountTerms(proposed) == 0 ||
        SameTerms(proposed, discovery_.equations)) {
      return Fit(1);
    }
    const Discovery regressed = discovery_;
    discovery_.equations = proposed;
    if (!FirstSteps() || !Fit(1)) return false;
    if (LeavesNoise() ||
        discovery_.summary.termination == Termination::kInterrupted) {
      return true;
    }
    const bool good = Good();
    const double criterion = good ? Criterion() : kInfinity;
    const Discovery from_segments = discovery_;
    const IdentifiedModel model = last_model_;
    const std::vector<int> substeps = substeps_;
    discovery_ = regressed;
    last_model_ = model_;
    const bool fitted = FirstSteps() && Fit(1);
    if (!good) return fitted;
    if (fitted && Good() && !(criterion < Criterion())) return true;
    const bool interrupted =
        fitted && discovery_.summary.termination == Termination::kInterrupted;
    error_->clear();
    discovery_ = from_segments;
    last_model_ = model;
    substeps_ = substeps;
    if (interrupted) {
      discovery_.summary.termination = Termination::kInterrupted;
      discovery_.summary.message = "interrupted before the search for terms";
    }
    return true;
  }

  double Criterion() const {
    return Deviance(problem_, discovery_.summary) +
           prices_.Sum(discovery_.equations);
  }

  // True if the fit leaves no more than the noise that the smoothed records
  // show, with some room for their own error.
  bool LeavesNoise() const {
    constexpr double kLargestRatio = 1.3;
    if (!Good()) return false;
    for (size_t r = 0; r < problem_.records.size(); ++r) {
      const IdentificationRecord& record = problem_.records[r];
      if (record.role != IdentificationRecord::Role::kTrain) continue;
      for (size_t c = 0; c < record.channels.size(); ++c) {
        if (record.channels[c].fit &&
            !(discovery_.summary.records[r].channels[c].rmse <
              kLargestRatio * model_.sigmas[r][static_cast<int>(c)])) {
          return false;
        }
      }
    }
    return true;
  }

  // Where the terms that were regressed cannot be fitted, or are not worth
  // their price even together, as those of a network that follows the noise,
  // whose trajectories diverge: back to the model with none of them, from which
  // the search can begin as well. What that model leaves over without a memory
  // is the noise. All stays as it is where its trajectories are not finite
  // either.
  bool CompareWithNoTerms() {
    if (!options_.search) return true;
    std::vector<DiscoveredEquation> equations = discovery_.equations;
    for (DiscoveredEquation& equation : equations) {
      equation.terms.erase(
          std::remove_if(
              equation.terms.begin(), equation.terms.end(),
              [](const DiscoveredTerm& term) { return !term.given; }),
          equation.terms.end());
    }
    // A problem has something to find.
    const std::vector<DiscoveredEquation> wide = WithAllCandidates(equations);
    if (CountTerms(wide) == CountTerms(equations)) return true;
    IdentificationProblem problem;
    IdentifiedModel initial;
    if (!MakeDiscoveredProblem(problem_, model_, wide, {}, &problem, &initial,
                               error_)) {
      return false;
    }
    FitSummary summary;
    summary.termination = Termination::kConverged;
    if (!ScoreWithoutFit(problem, &initial, &summary.records)) return true;
    if (Good() &&
        Criterion() < Deviance(problem_, summary) + prices_.Sum(equations)) {
      return true;
    }
    discovery_.equations = std::move(equations);
    substeps_ = FinerSteps(problem);
    discovery_.problem = std::move(problem);
    discovery_.summary = IdentificationSummary(std::move(summary));
    last_model_ = std::move(initial);
    unfitted_ = true;
    return true;
  }

  // Takes in and leaves out what the residuals of the trajectories ask for, as
  // long as the extended BIC of the fits becomes smaller.
  bool Search() {
    if (!options_.search) return true;
    for (int search = 0;
         search < kMaxSearches && Good() && (Left() || unfitted_); ++search) {
      const Discovery before = discovery_;
      const IdentifiedModel model_before = last_model_;
      double memory = 1.0;
      const FittedEquations fitted{before.problem, before.summary.records,
                                   model_before, substeps_, before.equations};
      if (!ProposeTerms(fitted, options_, prices_, identification_.num_threads,
                        &discovery_.equations, &memory, error_)) {
        return false;
      }
      if (!Left()) discovery_.equations = before.equations;
      if (SameTerms(before.equations, discovery_.equations)) return true;
      if (!Fit(1) || !Prune(1)) return false;
      if (discovery_.summary.termination == Termination::kInterrupted) break;
      if (!IsBetterThan(before, memory)) {
        discovery_ = before;
        last_model_ = model_before;
        return true;
      }
    }
    return true;
  }

  // True if the fit is usable and its extended BIC the smaller one. `memory` is
  // the autocorrelation time of the residuals.
  bool IsBetterThan(const Discovery& before, double memory) const {
    return Good() && Left() &&
           (Deviance(problem_, before.summary) -
            Deviance(problem_, discovery_.summary)) /
                   memory >
               prices_.Sum(discovery_.equations) -
                   prices_.Sum(before.equations);
  }

  // Both belong to the terms that were compared last.
  void ForgetRivals() {
    discovery_.rivals.clear();
    incomplete_ = kNaN;
  }

  // Compares the terms with others, and takes over better ones as long as there
  // are any. A rival whose fit and pruning do not lower the criterion leaves
  // all as it was. `factor` refines the steps.
  bool CompareWithRivalTerms(int factor) {
    ForgetRivals();
    if (!options_.search) return true;
    std::vector<int> substeps = substeps_;
    for (int& count : substeps) count *= factor;
    // The first memory serves all sets, so that none of them comes back.
    double memory = 1.0;
    for (int k = 0; Good() && Left(); ++k) {
      RivalComparison comparison;
      if (!CompareWithRivals({problem_, discovery_.problem, discovery_.summary,
                              last_model_, substeps, discovery_.equations},
                             options_, prices_, identification_, &rival_fits_,
                             &discovery_.equations, &comparison, error_)) {
        return false;
      }
      if (comparison.interrupted) {
        ForgetRivals();
        InterruptComparison();
        return true;
      }
      discovery_.rivals = std::move(comparison.rivals);
      incomplete_ = comparison.incomplete;
      compared_ = discovery_.equations;
      // The rivals and probabilities must be those of the terms that stay.
      if (comparison.better.empty() || k == kMaxSearches) return true;
      if (k == 0) memory = comparison.memory;
      const Discovery before = discovery_;
      const IdentifiedModel model_before = last_model_;
      discovery_.equations = std::move(comparison.better);
      discovery_.problem = std::move(comparison.better_problem);
      last_model_ = std::move(comparison.better_model);
      if (!Fit(factor) || !Prune(factor)) return false;
      if (IsBetterThan(before, memory)) continue;
      const bool interrupted =
          discovery_.summary.termination == Termination::kInterrupted;
      discovery_ = before;
      last_model_ = model_before;
      if (interrupted) InterruptComparison();
      return true;
    }
    return true;
  }

  void InterruptComparison() {
    discovery_.summary.termination = Termination::kInterrupted;
    discovery_.summary.message =
        "interrupted during the comparison with other terms";
  }

  bool FirstSteps() {
    IdentificationProblem first;
    IdentifiedModel initial;
    if (!MakeDiscoveredProblem(problem_, last_model_, discovery_.equations, {},
                               &first, &initial, error_)) {
      return false;
    }
    substeps_ = FinerSteps(first);
    return true;
  }

  // The finer of the steps of the network's fit and of those that the equations
  // in `problem` ask for.
  std::vector<int> FinerSteps(const IdentificationProblem& problem) const {
    std::vector<int> substeps;
    for (size_t r = 0; r < problem_.records.size(); ++r) {
      substeps.push_back(
          std::max(problem_.records[r].substeps, problem.records[r].substeps));
    }
    return substeps;
  }

  bool Fit(int factor) {
    std::vector<int> substeps = substeps_;
    for (int& count : substeps) count *= factor;
    IdentifiedModel initial;
    if (!MakeDiscoveredProblem(
            discovery_.refitted ? discovery_.problem : problem_, last_model_,
            discovery_.equations, substeps, &discovery_.problem, &initial,
            error_)) {
      return false;
    }
    ++num_fits_;
    unfitted_ = false;
    discovery_.refitted = true;
    discovery_.step_refinement = factor;
    FitSummary summary;
    inner_.Run("refit", discovery_.problem, Options(), &initial, &summary,
               &discovery_.model);
    discovery_.summary = IdentificationSummary(std::move(summary));
    if (discovery_.model.parameters.size() == initial.parameters.size()) {
      last_model_ = discovery_.model;
      TakeOver(discovery_.summary, &discovery_.equations);
    }
    return true;
  }

  // The main job on the equations that are left, from where the last fit ended.
  // An interrupted refit stays as it is.
  void Judge() {
    if (!Good()) {
      discovery_.summary.verdict =
          Verdict(CheckFit(identification_.tuning.gaps, discovery_.summary));
      return;
    }
    IdentificationOptions options = Options();
    BeginNearTheEnd(&options);
    IdentificationExtras extras;
    extras.start = &last_model_;
    extras.findings = CheckTerms(discovery_.equations, discovery_.rivals,
                                 incomplete_, options_.search);
    Identification found =
        Identify(discovery_.problem, options, extras, &announcing_);
    discovery_.problem = std::move(found.problem);
    discovery_.summary = std::move(found.summary);
    discovery_.model = std::move(found.model);
    TakeOver(discovery_.summary, &discovery_.equations);
  }

  IdentificationOptions Options() const {
    IdentificationOptions options = identification_;
    if (!exact_) DecideQuickly(&options);
    return options;
  }

  // The equations with the coefficients of `model`, one of discovery_.problem.
  std::vector<DiscoveredEquation> EquationsAt(
      const IdentifiedModel& model) const {
    std::vector<DiscoveredEquation> equations = discovery_.equations;
    const ParameterLayout layout(discovery_.problem);
    std::map<std::string, double> values;
    for (int i = 0; i < layout.num_parameters(); ++i) {
      values[layout.parameter(i).name] = model.parameters[i];
    }
    for (DiscoveredEquation& equation : equations) {
      for (DiscoveredTerm& term : equation.terms) {
        const auto found = values.find(CoefficientName(equation, term.basis));
        if (found != values.end()) term.coefficient = found->second;
      }
    }
    return equations;
  }

  // Announces the equations as they change.
  class AnnouncingWatch : public ForwardingWatch {
   public:
    AnnouncingWatch(IdentificationWatch* next, const Refitter* refitter)
        : ForwardingWatch(next), refitter_(*refitter) {}
    bool OnIteration(const std::string& what,
                     const IdentificationProblem& problem,
                     const IdentificationProgress& progress) override {
      if (refitter_.options_.on_equations) {
        refitter_.options_.on_equations(refitter_.num_fits_,
                                        refitter_.EquationsAt(*progress.model));
      }
      return ForwardingWatch::OnIteration(what, problem, progress);
    }

   private:
    const Refitter& refitter_;
  };

  bool Agree(const std::vector<DiscoveredEquation>& before) const {
    for (size_t e = 0; e < before.size(); ++e) {
      const DiscoveredEquation& after = discovery_.equations[e];
      for (size_t k = 0; k < after.terms.size(); ++k) {
        const ParameterEstimate* estimate = FindEstimate(
            discovery_.summary, CoefficientName(after, after.terms[k].basis));
        const double sigma =
            estimate != nullptr && std::isfinite(estimate->sigma)
                ? estimate->sigma
                : 0.0;
        const double value = after.terms[k].coefficient;
        const double moved = std::abs(value - before[e].terms[k].coefficient);
        if (moved > std::max(0.1 * sigma, 1e-8 * std::abs(value))) return false;
      }
    }
    return true;
  }

  const IdentificationProblem& problem_;
  const IdentifiedModel& model_;
  const DiscoveryOptions& options_;
  const IdentificationOptions& identification_;
  AnnouncingWatch announcing_;
  InnerFit inner_;
  InnerFit rival_fits_;  // the equations of a rival are not announced
  Discovery& discovery_;
  std::string* error_;
  IdentifiedModel last_model_;
  std::vector<int> substeps_;
  std::vector<DiscoveredEquation> compared_;  // with rivals
  double incomplete_ = kNaN;  // RivalComparison::incomplete of these
  TermPrices prices_;
  int num_fits_ = 0;
  bool unfitted_ = false;  // begun without terms, and without a fit
  bool exact_ = true;
};

}  // namespace

int Discovery::num_terms() const { return CountTerms(equations); }

Verdict Discovery::verdict() const {
  if (num_terms() == 0) {
    return Verdict(std::vector<Finding>{{"no_term", "no term was found"}});
  }
  return refitted ? summary.verdict : Verdict(std::vector<Finding>{});
}

std::string Discovery::Message() const {
  if (num_terms() == 0) return "no term was found";
  return refitted ? summary.message : "regressed, not refitted through the ODE";
}

bool RefitEquations(const IdentificationProblem& problem,
                    const IdentifiedModel& model,
                    const std::vector<DiscoveredEquation>& equations,
                    const DiscoveryOptions& options,
                    const IdentificationOptions& identification,
                    const std::vector<DiscoveredEquation>* resumed,
                    IdentificationWatch* watch, Discovery* discovery,
                    std::string* error) {
  if (!problem.IsValid(error) || !options.IsValid(error) ||
      !identification.IsValid(error) ||
      !AreEquationsOf(problem, equations, error)) {
    return false;
  }
  if (resumed != nullptr) {
    if (resumed->size() != equations.size()) {
      *error =
          "the interrupted refit had other equations; give --overwrite to "
          "begin again";
      return false;
    }
    if (!AreEquationsOf(problem, *resumed, error)) return false;
  }
  Discovery result;
  if (!Refitter(problem, model, options, identification, watch, &result, error)
           .Run(equations, resumed != nullptr ? *resumed : equations)) {
    return false;
  }
  CompleteTerms(problem, equations, &result.summary, &result.equations);
  *discovery = std::move(result);
  return true;
}

Discovery WithoutRefit(const IdentificationProblem& problem,
                       const std::vector<DiscoveredEquation>& equations) {
  Discovery discovery;
  discovery.equations = equations;
  std::string unused;
  if (AreEquationsOf(problem, equations, &unused)) {
    CompleteTerms(problem, equations, nullptr, &discovery.equations);
  }
  return discovery;
}

}  // namespace pinode
