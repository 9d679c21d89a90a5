#include "pinode/study/explanations/explain.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/strings.h"
#include "pinode/dynamics/memory_network.h"
#include "pinode/estimate/fit/fit_checks.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/study/explanations/block_estimates.h"
#include "pinode/study/explanations/close_numbers.h"
#include "pinode/study/explanations/confusions.h"
#include "pinode/study/explanations/modes_search.h"
#include "pinode/study/explanations/refit_search.h"
#include "pinode/study/explanations/unknown_forces.h"
#include "pinode/study/terms/term_worth.h"

namespace pinode {
namespace {

// Number of explanations to report.
constexpr size_t kMostReported = 5;

// Describes the outcome of a search in words and numbers.
class Report {
 public:
  Report(const IdentificationProblem& problem, const FitSummary& fit,
         const std::vector<Suspect>& suspects, const SuspectScores& scores,
         const std::vector<Refit>& refits)
      : problem_(problem),
        fit_(fit),
        suspects_(suspects),
        scores_(scores),
        refits_(refits) {}

  Explained Make() {
    Explained result;
    AddConfusion(&result.findings);
    AddExplanations(&result);
    AddFinding(&result);
    Widen(&result);
    return result;
  }

 private:
  // Damping that is fixed, while what is free can do the same.
  void AddConfusion(std::vector<Finding>* findings) const {
    // Damping that is free itself takes over what the factor does, and so does
    // a network.
    if (HasFreeDamping() || !problem_.dynamics->networks().empty() ||
        HasMemoryNetwork(*problem_.dynamics)) {
      return;
    }
    for (const Confusion& confusion : FindConfusions(suspects_, scores_)) {
      if (suspects_[confusion.suspect].kind != Suspect::Kind::kDamping ||
          confusion.names.size() < 2) {
        continue;
      }
      findings->push_back(
          {"told_apart_by_damping",
           "'" + Join(confusion.names, "' and '") + "'" +
               " depend on the given damping: a damping that is wrong by a "
               "tenth changes all of them, and the records do not show it",
           confusion.deviation, suspects_[confusion.suspect].usual,
           "give one of them, or measure the force", Grade::kWithCare});
      return;
    }
  }

  bool IsDamping(const std::string& name) const {
    const std::vector<GroupTerm>& groups = problem_.dynamics->groups();
    return std::any_of(
        groups.begin(), groups.end(), [&name](const GroupTerm& term) {
          return term.alpha.free && term.alpha.name == name &&
                 term.group.target == MatrixGroup::Target::kDamping;
        });
  }

  bool HasFreeDamping() const {
    return std::any_of(fit_.parameters.begin(), fit_.parameters.end(),
                       [this](const ParameterEstimate& estimate) {
                         return IsDamping(estimate.name);
                       });
  }

  void AddExplanations(Explained* result) const {
    // The fit as it is has the odds 1.
    double sum = 1.0;
    const double most =
        refits_.empty() ? 0.0 : std::max(0.0, refits_.front().log_odds);
    sum = std::exp(-most);
    for (const Refit& refit : refits_) {
      sum += std::exp(refit.log_odds - most);
    }
    for (const Refit& refit : refits_) {
      if (!(refit.log_odds > 0.0) ||
          result->explanations.size() == kMostReported) {
        break;
      }
      result->explanations.push_back(Describe(refit));
      result->explanations.back().probability =
          std::exp(refit.log_odds - most) / sum;
    }
  }

  void AddFinding(Explained* result) const {
    for (size_t i = 0; i < result->explanations.size(); ++i) {
      const Explanation& explanation = result->explanations[i];
      // Explanations with about the odds of the best cannot be told from it.
      if (explanation.log_odds < limits::kLogOdds ||
          explanation.log_odds <
              result->explanations.front().log_odds - limits::kLogOdds) {
        break;
      }
      if (!(explanation.shift > limits::kShiftByExplanation)) continue;
      result->findings.push_back(
          {"another_explanation",
           explanation.what + " would describe the " + DataName() +
               " better, with " + MovedValue(explanation, refits_[i]),
           explanation.shift, limits::kShiftByExplanation,
           "check it, or leave it free in the model", Grade::kWithCare});
      break;
    }
  }

  bool IsOfFrfs() const {
    return !problem_.frfs.empty() && problem_.records.empty() &&
           problem_.ambient.empty() && problem_.modal.modes.empty();
  }

  std::string DataName() const {
    if (IsOfFrfs()) return "frequency responses";
    if (problem_.modal.modes.empty()) return "records";
    return HasModesAlone(problem_) ? "modes" : "records and modes";
  }

  // "'k1' at -0.102 instead of -0.0519", of the parameter that it moves most,
  // or "the peak of 'shaker' at 2060 instead of 2750".
  std::string MovedValue(const Explanation& explanation,
                         const Refit& refit) const {
    const MovedForce force = MostMovedForce(fit_.forces, refit.fit.forces);
    if (force.name == explanation.moved && !force.name.empty()) {
      return "the peak of '" + force.name + "' at " +
             FormatNumber(force.other_peak, 3) + " instead of " +
             FormatNumber(force.own_peak, 3);
    }
    return "'" + explanation.moved + "' at " + ValueUnder(explanation);
  }

  std::string ValueUnder(const Explanation& explanation) const {
    const ParameterEstimate* own = FindEstimate(fit_, explanation.moved);
    for (const ExplainedValue& value : explanation.values) {
      if (own == nullptr || value.name != explanation.moved) continue;
      const int digits = DigitsToTellApart({value.value, own->value});
      return FormatNumber(value.value, digits) + " instead of " +
             FormatNumber(own->value, digits);
    }
    return "another value";
  }

  Explanation Describe(const Refit& refit) const {
    Explanation result;
    std::vector<std::string> kinds, places, whats;
    for (const size_t i : refit.suspects) {
      const Suspect& suspect = suspects_[i];
      kinds.push_back(SuspectKindName(suspect.kind));
      places.push_back(suspect.place);
      whats.push_back(WhatOf(suspect, refit.fit) +
                      ValueText(suspect, refit.fit));
    }
    result.kind = Join(kinds, "+");
    result.place = places.size() == 1 ? places[0] : Join(places, "+");
    result.what = Join(whats, ", and ");
    const Interval first =
        IntervalOf(suspects_[refit.suspects.front()], refit.fit);
    result.value = first.value;
    result.lower95 = first.lower;
    result.upper95 = first.upper;
    result.log_odds = refit.log_odds;
    const double before = ErrorOf(fit_);
    if (before > 0.0) result.removes = 1.0 - ErrorOf(refit.fit) / before;
    result.leaves = LeftBy(refit.fit);
    // Damping that is described in another way takes over from the groups.
    const bool changes_damping = std::any_of(
        refit.suspects.begin(), refit.suspects.end(),
        [&](size_t i) { return suspects_[i].kind == Suspect::Kind::kDamping; });
    for (const ParameterEstimate& own : fit_.parameters) {
      const double width = 0.5 * (own.upper95 - own.lower95);
      const ParameterEstimate* other = FindEstimate(refit.fit, own.name);
      if (!own.free || other == nullptr) continue;
      result.values.push_back(
          {own.name, other->value, other->lower95, other->upper95});
      if (!(width > 0.0) || !std::isfinite(width) ||
          (changes_damping && IsDamping(own.name))) {
        continue;
      }
      const double shift = std::abs(other->value - own.value) / width;
      if (shift > result.shift) {
        result.shift = shift;
        result.moved = own.name;
      }
    }
    const MovedForce force = MostMovedForce(fit_.forces, refit.fit.forces);
    if (force.shift > result.shift) {
      result.shift = force.shift;
      result.moved = force.name;
    }
    return result;
  }

  // Squared error of what is fitted: records, modes in standard deviations, the
  // chi^2 of ambient records, and FRFs as shares of their mean squares.
  static double ErrorOf(const FitSummary& fit) {
    double sum = SquaredError(fit);
    if (std::isfinite(fit.final_modal_cost)) sum += 2.0 * fit.final_modal_cost;
    for (const AmbientScore& score : fit.ambient) sum += score.chi_square;
    for (const FrfScore& score : fit.frfs) {
      sum += static_cast<double>(score.num_lines) * score.errors.squaredNorm();
    }
    return sum;
  }

  // Unexplained motion, as Explanation::leaves.
  static double LeftBy(const FitSummary& fit) {
    double largest = 0.0;
    for (const RecordScore& score : fit.records) {
      if (score.role != IdentificationRecord::Role::kTrain) continue;
      largest = std::max(largest, StructuredError(score));
    }
    return largest;
  }

  struct Interval {
    double value = kNaN, lower = kNaN, upper = kNaN;
    std::string unit;  // "%" for fractions, of which the numbers are such
  };

  // The first unknown of a suspect, as Explanation::value.
  static Interval IntervalOf(const Suspect& suspect, const FitSummary& fit) {
    const std::vector<std::string> unknowns = suspect.Unknowns();
    Interval result;
    const ParameterEstimate* estimate =
        unknowns.empty() ? nullptr : FindEstimate(fit, unknowns[0]);
    if (estimate == nullptr) return result;
    result = {estimate->value, estimate->lower95, estimate->upper95,
              estimate->unit == "1" ? "" : estimate->unit};
    if (suspect.kind == Suspect::Kind::kClockRate) {
      // Stiffness is that of the true time over the rate squared.
      const auto rate = [](double factor) {
        return 1.0 / std::sqrt(std::max(1.0 + factor, 1e-6)) - 1.0;
      };
      result = {rate(result.value), rate(result.upper), rate(result.lower),
                "%"};
    } else if (suspect.sensors.empty() && suspect.forces.empty()) {
      result.unit = "%";
    }
    return result;
  }

  // In words. A spring that hardens by less than nothing softens.
  static std::string WhatOf(const Suspect& suspect, const FitSummary& fit) {
    const std::string hardening = "hardening";
    if (suspect.kind == Suspect::Kind::kNonlinear &&
        suspect.what.compare(0, hardening.size(), hardening) == 0 &&
        IntervalOf(suspect, fit).value < 0.0) {
      return "softening" + suspect.what.substr(hardening.size());
    }
    return suspect.what;
  }

  // ", +31 (29 to 33) %"; empty for several unknowns or none.
  static std::string ValueText(const Suspect& suspect, const FitSummary& fit) {
    const Interval interval = IntervalOf(suspect, fit);
    if (std::isnan(interval.value) ||
        (suspect.Unknowns().size() != 1 &&
         suspect.kind != Suspect::Kind::kClockRate)) {
      return "";
    }
    const bool is_share = interval.unit == "%";
    const bool is_bounded = std::isfinite(interval.upper - interval.lower);
    const int digits = is_bounded
                           ? DigitsToTellApart({interval.lower, interval.value,
                                                interval.upper})
                           : 3;
    const auto text = [&](double value) {
      return FormatNumber(is_share ? 100.0 * value : value, digits);
    };
    std::string result = ", ";
    if (is_share && interval.value > 0.0) result += "+";
    result += text(interval.value);
    if (is_bounded) {
      result +=
          " (" + text(interval.lower) + " to " + text(interval.upper) + ")";
    }
    return interval.unit.empty() ? result : result + " " + interval.unit;
  }

  // Intervals that hold what the best explanation makes of each parameter, and
  // what all suspects of usual size together would.
  void Widen(Explained* result) const {
    for (const ParameterEstimate& own : fit_.parameters) {
      if (!own.free) continue;
      ExplainedValue wide{own.name, own.value, own.lower95, own.upper95};
      const auto include = [&wide](double lower, double upper) {
        if (std::isfinite(lower)) wide.lower95 = std::min(wide.lower95, lower);
        if (std::isfinite(upper)) wide.upper95 = std::max(wide.upper95, upper);
      };
      for (size_t j = 0; j < scores_.names.size(); ++j) {
        if (scores_.names[j] != own.name) continue;
        const Eigen::Index i = static_cast<Eigen::Index>(j);
        if (i >= scores_.usual_shifts.size()) continue;
        const double moved = own.value + scores_.usual_shifts[i];
        const double half = 1.96 * scores_.usual_deviations[i];
        include(moved - half, moved + half);
      }
      for (const Explanation& explanation : result->explanations) {
        if (!IsAllowedFor(explanation, result->explanations[0])) break;
        for (const ExplainedValue& value : explanation.values) {
          if (value.name == own.name) include(value.lower95, value.upper95);
        }
      }
      result->intervals.push_back(std::move(wide));
    }
    result->forces = fit_.forces;
    if (!result->explanations.empty() &&
        result->explanations[0].log_odds > limits::kLogOdds) {
      WidenForces(refits_[0].fit.forces, &result->forces);
    }
  }

  // True if intervals hold what this explanation makes of them: the best one of
  // records. Measured modes are explained only where something is wrong with
  // them, so that all that cannot be told from the best one count.
  bool IsAllowedFor(const Explanation& explanation,
                    const Explanation& best) const {
    return HasModesAlone(problem_)
               ? explanation.log_odds > best.log_odds - limits::kLogOdds
               : &explanation == &best && best.log_odds > limits::kLogOdds;
  }

  const IdentificationProblem& problem_;
  const FitSummary& fit_;
  const std::vector<Suspect>& suspects_;
  const SuspectScores& scores_;
  const std::vector<Refit>& refits_;
};

}  // namespace

bool CanExplain(const IdentificationProblem& problem,
                const IdentificationOptions& options) {
  return problem.num_train_records() > 0 && problem.modal.modes.empty() &&
         !problem.HasSpectra() &&
         CommunicatorOrSingle(options.communicator).size() == 1;
}

namespace {

Explained ExplainModes(const IdentificationProblem& problem,
                       const IdentificationOptions& options,
                       const FitSummary& fit, const IdentifiedModel& model,
                       InnerFit* inner) {
  ModesSearch search(problem, options, fit, model, inner);
  if (!search.Run()) return {};
  Explained result =
      Report(problem, fit, search.suspects(), {}, search.refits()).Make();
  // Frequencies that are far off say it already.
  if (!search.IsBeyondDeviations() ||
      !CheckMeasuredFrequencies(problem, fit).empty()) {
    return result;
  }
  const double ratio = std::sqrt(search.SquaredErrorLeft());
  result.findings.push_back(
      {"modes_beyond_deviations",
       "the errors of the measured modes are " + FormatNumber(ratio, 3) +
           " times what their standard deviations allow",
       ratio, kNaN,
       "check the modes and their standard deviations, or free what the model "
       "lacks",
       Grade::kWithCare});
  return result;
}

}  // namespace

Explained Explain(const IdentificationProblem& problem,
                  const IdentificationOptions& options, const FitSummary& fit,
                  const IdentifiedModel& model, InnerFit* inner) {
  if (HasModesAlone(problem) &&
      CommunicatorOrSingle(options.communicator).size() == 1) {
    return ExplainModes(problem, options, fit, model, inner);
  }
  const bool has_records = problem.num_train_records() > 0;
  const bool has_modes = !problem.modal.modes.empty();
  // Weights of modes that are no standard deviations have no likelihood.
  if ((!has_records && !problem.HasSpectra()) ||
      (has_modes && !problem.modal.HasSigmasOfAll()) ||
      CommunicatorOrSingle(options.communicator).size() > 1) {
    return {};
  }
  RefitSearch search(problem, options, fit, model, inner);
  if (!search.Run()) return {};
  SuspectScores scores = search.scores();
  // Suspects of usual size together are for residuals in time.
  if (!CanExplain(problem, options)) scores.usual_shifts.resize(0);
  Explained result =
      Report(problem, fit, search.suspects(), scores, search.refits()).Make();
  if (!CanExplain(problem, options)) return result;
  BlockEstimates blocks;
  if (EstimateBlocks(problem, fit, model, options.num_threads, &blocks)) {
    WidenByBlocks(blocks, fit, problem, &result.intervals);
    for (Finding& finding : CheckBlocks(blocks, fit, problem)) {
      result.findings.push_back(std::move(finding));
    }
  }
  return result;
}

}  // namespace pinode
