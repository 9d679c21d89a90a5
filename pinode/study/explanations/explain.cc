#include "pinode/study/explanations/explain.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/study/explanations/score_test.h"
#include "pinode/study/explanations/suspect.h"
#include "pinode/study/problem/growth.h"

namespace pinode {
namespace {

// Number of refits: of single suspects, of exchanges, and of suspects added to
// the best. Each costs a fraction of the fit, from whose end it begins.
constexpr size_t kMostSingles = 4;
constexpr size_t kMostExchanges = 2;
constexpr size_t kMostAdded = 2;
// Enough to compare refits: a step that changes the cost by less moves no odds,
// and an explanation that is the right one is met within a few steps. Wrong
// ones have long valleys.
constexpr double kTolerance = 1e-6;
constexpr int kMostIterations = 15;
// Number of suspects together: more faults at once than these are another
// model.
constexpr size_t kMostTogether = 3;
// Number of explanations to report.
constexpr size_t kMostReported = 5;

bool IsTraining(const RecordScore& score) {
  return score.role == IdentificationRecord::Role::kTrain;
}

bool CanExplain(const IdentificationProblem& problem,
                const IdentificationOptions& options) {
  return problem.num_train_records() > 0 &&
         problem.dynamics->networks().empty() &&
         problem.dynamics->unknown_forces().empty() &&
         problem.modal.modes.empty() && problem.ambient.empty() &&
         CommunicatorOrSingle(options.communicator).size() == 1;
}

double SquaredError(const FitSummary& fit) {
  double sum = 0.0;
  for (const RecordScore& score : fit.records) {
    if (IsTraining(score)) sum += std::pow(score.nrmse, 2);
  }
  return sum;
}

double MostUnexplained(const FitSummary& fit) {
  double most = 0.0;
  for (const RecordScore& score : fit.records) {
    if (IsTraining(score)) most = std::max(most, StructuredError(score));
  }
  return most;
}

// Mean autocorrelation time of the residuals of fitted channels, at least 1.
double MemoryOf(const IdentificationProblem& problem, const FitSummary& fit) {
  double sum = 0.0;
  int count = 0;
  for (size_t r = 0; r < fit.records.size(); ++r) {
    const RecordScore& score = fit.records[r];
    const IdentificationRecord& record = problem.records[r];
    if (!IsTraining(score) || score.prediction.cols() != record.num_samples()) {
      continue;
    }
    for (size_t c = 0; c < record.channels.size(); ++c) {
      if (!record.channels[c].fit) continue;
      Vector residuals =
          record.channels[c].values -
          score.prediction.row(static_cast<Eigen::Index>(c)).transpose();
      residuals = residuals.array().isNaN().select(0.0, residuals);
      sum += AutocorrelationTime(residuals);
      ++count;
    }
  }
  return std::max(1.0, sum / std::max(count, 1));
}

// A fit with suspects among its unknowns.
struct Refit {
  std::vector<size_t> suspects;
  IdentificationProblem problem;
  FitSummary fit;
  IdentifiedModel model;
  double log_odds = -kInfinity;
};

class Search {
 public:
  Search(const IdentificationProblem& problem,
         const IdentificationOptions& options, const FitSummary& fit,
         const IdentifiedModel& model, InnerFit* inner)
      : problem_(problem),
        options_(options),
        fit_(fit),
        model_(model),
        inner_(*inner),
        suspects_(MakeSuspects(problem, model)) {
    BeginNearTheEnd(&options_);
    options_.function_tolerance =
        std::max(options_.function_tolerance, kTolerance);
    options_.max_num_iterations =
        std::min(options_.max_num_iterations, kMostIterations);
    options_.keep_states = false;
    options_.num_starts = 0;
    for (const IdentificationRecord& record : problem.records) {
      if (record.role != IdentificationRecord::Role::kTrain) continue;
      for (const MeasuredChannel& channel : record.channels) {
        if (channel.fit) {
          num_samples_ += static_cast<double>(CountPresent(channel.values));
        }
      }
    }
  }

  Explained Run() {
    Explained result;
    Refit own;
    own.problem = problem_;
    own.fit = fit_;
    own.model = model_;
    own.log_odds = 0.0;
    std::string unused;
    SuspectScores scores;
    if (!ScoreSuspects(problem_, fit_, model_, suspects_, options_.num_threads,
                       &scores, &unused)) {
      return result;
    }
    FindConfusions(scores, &result.findings);
    // A bound that a fit has reached is a suspect whatever the score says.
    for (size_t i = 0; i < suspects_.size(); ++i) {
      if (suspects_[i].kind == Suspect::Kind::kBound && IsHeld(suspects_[i])) {
        Try(own, {i}, /*cold=*/false);
      }
    }
    for (const size_t i : Promising(scores, kMostSingles, {})) {
      Try(own, {i}, /*cold=*/false);
    }
    if (MostUnexplained(fit_) > limits::kLittleUnexplained) {
      for (const size_t i : LikelyExchanges()) Try(own, {i}, /*cold=*/true);
    }
    for (size_t together = 2; together <= kMostTogether; ++together) {
      if (!AddToBest()) break;
    }
    Report(&result);
    return result;
  }

 private:
  // Suspects of which the scores promise the most, and enough for refits.
  std::vector<size_t> Promising(const SuspectScores& scores, size_t most,
                                const std::vector<size_t>& taken) const {
    std::vector<std::pair<double, size_t>> ranked;
    for (size_t i = 0; i < scores.suspects.size(); ++i) {
      const SuspectScore& score = scores.suspects[i];
      if (score.num_unknowns == 0 ||
          std::find(taken.begin(), taken.end(), i) != taken.end()) {
        continue;
      }
      const double promise = score.gain - Penalty(score.num_unknowns, 1.0);
      if (promise > limits::kLogOdds) ranked.emplace_back(-promise, i);
    }
    std::sort(ranked.begin(), ranked.end());
    std::vector<size_t> best;
    for (const auto& [unused, i] : ranked) {
      if (best.size() < most) best.push_back(i);
    }
    return best;
  }

  double Penalty(int num_unknowns, double memory) const {
    return 0.5 * num_unknowns * std::log(std::max(num_samples_ / memory, 2.0)) +
           std::log(static_cast<double>(suspects_.size()));
  }

  // Exchanges after which measured and predicted channels agree better.
  std::vector<size_t> LikelyExchanges() const {
    std::vector<std::pair<double, size_t>> ranked;
    for (size_t i = 0; i < suspects_.size(); ++i) {
      if (suspects_[i].exchanged.empty()) continue;
      double better = 0.0;
      for (const auto& [one, two] : suspects_[i].exchanged) {
        better += Agreement(one, two.second) + Agreement(two, one.second) -
                  Agreement(one, one.second) - Agreement(two, two.second);
      }
      ranked.emplace_back(-better, i);
    }
    std::sort(ranked.begin(), ranked.end());
    std::vector<size_t> best;
    for (const auto& [unused, i] : ranked) {
      if (best.size() < kMostExchanges) best.push_back(i);
    }
    return best;
  }

  // Correlation of a measured channel with what another one should measure.
  double Agreement(const std::pair<int, int>& at, int predicted) const {
    const size_t r = static_cast<size_t>(at.first);
    const Matrix& prediction = fit_.records[r].prediction;
    const Vector& values =
        problem_.records[r].channels[static_cast<size_t>(at.second)].values;
    if (prediction.cols() != values.size()) return 0.0;
    const Vector other = prediction.row(predicted).transpose();
    const auto present = values.array().isFinite();
    const Vector y = present.select(values, 0.0);
    const Vector p = present.select(other, 0.0);
    const double size = y.norm() * p.norm();
    return size > 0.0 ? y.dot(p) / size : 0.0;
  }

  bool IsHeld(const Suspect& suspect) const {
    return std::any_of(suspect.freed.begin(), suspect.freed.end(),
                       [&](const std::string& name) {
                         const ParameterEstimate* estimate = Find(fit_, name);
                         return estimate != nullptr && estimate->at_bound;
                       });
  }

  // Refits with `suspects`, beginning with the values of `from`. `cold`: from
  // the problem's own initial values, where the fit has adapted to the fault.
  bool Try(const Refit& from, std::vector<size_t> suspects, bool cold) {
    Refit refit;
    refit.suspects = std::move(suspects);
    std::set<size_t> key(refit.suspects.begin(), refit.suspects.end());
    if (interrupted_ || !tried_.insert(key).second) return false;
    std::string unused;
    refit.problem = problem_;
    std::vector<Suspect> added;
    for (const size_t i : refit.suspects) added.push_back(suspects_[i]);
    if (!AddSuspects(added, &refit.problem, &unused)) return false;
    IdentifiedModel begin = BeginFrom(
        ParametersByName(from.problem, from.model), from.model, refit.problem);
    begin.decays = from.model.decays;
    IdentificationOptions options = options_;
    if (cold) options.shooting = IdentificationOptions().shooting;
    inner_.Run("another explanation", refit.problem, options,
               cold ? nullptr : &begin, &refit.fit, &refit.model);
    if (refit.fit.termination == Termination::kInterrupted) {
      interrupted_ = true;
      return false;
    }
    if (refit.fit.termination == Termination::kFailure) return false;
    refit.log_odds = LogOdds(refit);
    if (!std::isfinite(refit.log_odds)) return false;
    refits_.push_back(std::move(refit));
    return true;
  }

  double LogOdds(const Refit& refit) const {
    const double memory = MemoryOf(refit.problem, refit.fit);
    double gain = 0.0;
    for (size_t r = 0; r < fit_.records.size(); ++r) {
      const RecordScore& before = fit_.records[r];
      const RecordScore& after = refit.fit.records[r];
      if (!IsTraining(before)) continue;
      if (!after.finite) return -kInfinity;
      const IdentificationRecord& record = refit.problem.records[r];
      for (size_t c = 0; c < record.channels.size(); ++c) {
        if (!record.channels[c].fit) continue;
        const double count =
            static_cast<double>(CountPresent(record.channels[c].values));
        gain += count / memory *
                std::log(before.channels[c].rmse /
                         std::max(after.channels[c].rmse, 1e-300));
      }
    }
    int unknowns = 0;
    double candidates = 0.0;
    for (const size_t i : refit.suspects) {
      unknowns += static_cast<int>(suspects_[i].Unknowns().size());
      candidates += std::log(static_cast<double>(suspects_.size()));
    }
    return gain -
           0.5 * unknowns * std::log(std::max(num_samples_ / memory, 2.0)) -
           candidates;
  }

  // Adds a suspect to the best refit; true if that made it better by odds that
  // count.
  bool AddToBest() {
    if (interrupted_ || refits_.empty()) return false;
    const Refit best = *std::max_element(
        refits_.begin(), refits_.end(),
        [](const Refit& a, const Refit& b) { return a.log_odds < b.log_odds; });
    if (best.log_odds < limits::kLogOdds) return false;
    SuspectScores scores;
    std::string unused;
    std::vector<Suspect> rest = suspects_;
    for (const size_t i : best.suspects) rest[i] = Suspect();
    if (!ScoreSuspects(best.problem, best.fit, best.model, rest,
                       options_.num_threads, &scores, &unused)) {
      return false;
    }
    for (const size_t i : Promising(scores, kMostAdded, best.suspects)) {
      std::vector<size_t> more = best.suspects;
      more.push_back(i);
      if (!Try(best, more, /*cold=*/false)) continue;
      // An earlier suspect leaves again if the new one makes it needless.
      const Refit with = refits_.back();
      for (const size_t old : best.suspects) {
        std::vector<size_t> without = more;
        without.erase(std::find(without.begin(), without.end(), old));
        if (HoldsNothing(with, old)) Try(with, without, /*cold=*/false);
      }
    }
    return std::any_of(refits_.begin(), refits_.end(), [&](const Refit& other) {
      return other.suspects.size() > best.suspects.size() &&
             other.log_odds > best.log_odds + limits::kLogOdds;
    });
  }

  // True if the only unknown of suspect `i` is zero within its interval.
  bool HoldsNothing(const Refit& refit, size_t i) const {
    const std::vector<std::string> unknowns = suspects_[i].Unknowns();
    if (unknowns.size() != 1) return false;
    const ParameterEstimate* estimate = Find(refit.fit, unknowns[0]);
    if (estimate == nullptr) return false;
    const double nothing =
        suspects_[i].sensors.empty() ||
                suspects_[i].sensors[0].role != &MeasuredChannel::gain
            ? 0.0
            : 1.0;
    return estimate->lower95 < nothing && nothing < estimate->upper95;
  }

  // Damping that is fixed, while what is free can do the same.
  void FindConfusions(const SuspectScores& scores,
                      std::vector<Finding>* findings) const {
    constexpr double kNothingLeft = 1e-4;
    constexpr double kMuch = 0.1;
    for (size_t i = 0; i < suspects_.size(); ++i) {
      const SuspectScore& score = scores.suspects[i];
      if (suspects_[i].kind != Suspect::Kind::kDamping ||
          score.num_unknowns != 1 || score.information_left > kNothingLeft) {
        continue;
      }
      std::vector<std::string> names;
      for (size_t j = 0; j < scores.names.size(); ++j) {
        if (std::abs(score.slopes[static_cast<Eigen::Index>(j)]) > kMuch) {
          names.push_back("'" + scores.names[j] + "'");
        }
      }
      // Damping that is free itself takes over what the factor does.
      if (names.size() < 2 || HasFreeDamping()) continue;
      findings->push_back(
          {"told_apart_by_damping",
           Join(names, " and ") +
               " are determined by the given damping alone: a damping off by a "
               "tenth changes them all, and the records do not show it",
           score.information_left, kNothingLeft,
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

  void Report(Explained* result) {
    std::sort(
        refits_.begin(), refits_.end(),
        [](const Refit& a, const Refit& b) { return a.log_odds > b.log_odds; });
    for (const Refit& refit : refits_) {
      if (!(refit.log_odds > 0.0) ||
          result->explanations.size() == kMostReported) {
        break;
      }
      result->explanations.push_back(Describe(refit));
    }
    for (const Explanation& explanation : result->explanations) {
      // Explanations with about the odds of the best cannot be told from it.
      if (explanation.log_odds < limits::kLogOdds ||
          explanation.log_odds <
              result->explanations.front().log_odds - limits::kLogOdds) {
        break;
      }
      if (!(explanation.shift > limits::kShiftByExplanation)) continue;
      result->findings.push_back(
          {"another_explanation",
           explanation.what +
               " would describe the records better, and would "
               "move '" +
               explanation.moved + "' by " +
               FormatNumber(explanation.shift, 2) +
               " half-widths of its interval",
           explanation.shift, limits::kShiftByExplanation,
           "check it, or free it", Grade::kWithCare});
      break;
    }
  }

  Explanation Describe(const Refit& refit) const {
    Explanation result;
    std::vector<std::string> kinds, places, whats;
    for (const size_t i : refit.suspects) {
      const Suspect& suspect = suspects_[i];
      kinds.push_back(SuspectKindName(suspect.kind));
      places.push_back(suspect.place);
      whats.push_back(suspect.what + ValueText(suspect, refit.fit));
    }
    result.kind = Join(kinds, "+");
    result.place = places.size() == 1 ? places[0] : Join(places, "+");
    result.what = Join(whats, ", and ");
    const std::vector<std::string> unknowns =
        suspects_[refit.suspects.front()].Unknowns();
    if (!unknowns.empty()) {
      if (const ParameterEstimate* estimate = Find(refit.fit, unknowns[0])) {
        result.value = estimate->value;
        result.lower95 = estimate->lower95;
        result.upper95 = estimate->upper95;
      }
    }
    result.log_odds = refit.log_odds;
    const double before = SquaredError(fit_);
    if (before > 0.0) {
      result.removes = 1.0 - SquaredError(refit.fit) / before;
    }
    // Damping that is described in another way takes over from the groups.
    const bool changes_damping = std::any_of(
        refit.suspects.begin(), refit.suspects.end(),
        [&](size_t i) { return suspects_[i].kind == Suspect::Kind::kDamping; });
    for (const ParameterEstimate& own : fit_.parameters) {
      const double width = 0.5 * (own.upper95 - own.lower95);
      const ParameterEstimate* other = Find(refit.fit, own.name);
      if (!own.free || other == nullptr || !(width > 0.0) ||
          !std::isfinite(width) || (changes_damping && IsDamping(own.name))) {
        continue;
      }
      const double shift = std::abs(other->value - own.value) / width;
      if (shift > result.shift) {
        result.shift = shift;
        result.moved = own.name;
      }
    }
    return result;
  }

  static const ParameterEstimate* Find(const FitSummary& fit,
                                       const std::string& name) {
    for (const ParameterEstimate& estimate : fit.parameters) {
      if (estimate.name == name) return &estimate;
    }
    return nullptr;
  }

  // ", +31 % (29 to 33)"; empty for several unknowns or none.
  static std::string ValueText(const Suspect& suspect, const FitSummary& fit) {
    const std::vector<std::string> unknowns = suspect.Unknowns();
    if (unknowns.size() != 1) return "";
    const ParameterEstimate* estimate = Find(fit, unknowns[0]);
    if (estimate == nullptr) return "";
    const bool is_factor = suspect.sensors.empty();
    const double scale = is_factor ? 100.0 : 1.0;
    const auto text = [&](double value) {
      return FormatNumber(scale * value, 3);
    };
    std::string result = ", ";
    if (is_factor && estimate->value > 0.0) result += "+";
    result += text(estimate->value);
    if (std::isfinite(estimate->upper95 - estimate->lower95)) {
      result += " (" + text(estimate->lower95) + " to " +
                text(estimate->upper95) + ")";
    }
    if (is_factor) return result + " %";
    return estimate->unit == "1" || estimate->unit.empty()
               ? result
               : result + " " + estimate->unit;
  }

  const IdentificationProblem& problem_;
  IdentificationOptions options_;
  const FitSummary& fit_;
  const IdentifiedModel& model_;
  InnerFit& inner_;
  const std::vector<Suspect> suspects_;
  double num_samples_ = 0.0;
  std::vector<Refit> refits_;
  std::set<std::set<size_t>> tried_;
  bool interrupted_ = false;
};

}  // namespace

Explained Explain(const IdentificationProblem& problem,
                  const IdentificationOptions& options, const FitSummary& fit,
                  const IdentifiedModel& model, InnerFit* inner) {
  if (!CanExplain(problem, options)) return {};
  return Search(problem, options, fit, model, inner).Run();
}

}  // namespace pinode
