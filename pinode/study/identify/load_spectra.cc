#include "pinode/study/identify/load_spectra.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/estimate/fit/fit_checks.h"
#include "pinode/problem/verdict_limits.h"
#include "pinode/study/problem/checkpoint.h"

namespace pinode {
namespace {

// Refinements of the spectra, each with a fit.
constexpr int kMostRounds = 2;

// By the record that is described worst; where no probability can be told from
// zero, by how far the spectra are from it.
bool IsBetter(const FitSummary& one, const FitSummary& other) {
  const auto least = [](const FitSummary& summary) {
    std::pair<double, double> worst{1.0, 0.0};
    for (const AmbientScore& score : summary.ambient) {
      worst = std::min(
          worst,
          {score.probability,
           -score.chi_square / static_cast<double>(score.degrees_of_freedom)});
    }
    return worst;
  };
  return least(one) > least(other);
}

// "7 knots (probability 3e-18)" of each record that is refined.
std::string Describe(const std::vector<int>& given, const FitSummary& summary) {
  std::vector<std::string> texts;
  for (size_t i = 0; i < summary.ambient.size(); ++i) {
    if (given[i] > 0) continue;
    const AmbientScore& score = summary.ambient[i];
    texts.push_back("'" + score.name + "' with " +
                    std::to_string(score.num_knots) + " knots (probability " +
                    FormatNumber(score.probability, 2) + ")");
  }
  return Join(texts, ", ");
}

// Loads and noise were first found at a model that was further away: the powers
// of their spectra, and what their covariances are held to, are of that one.
bool MayHaveBetterLoads(const FitSummary& summary) {
  return summary.termination == Termination::kConverged &&
         std::any_of(summary.ambient.begin(), summary.ambient.end(),
                     [](const AmbientScore& score) {
                       return score.probability < kDoubtfulAmbientProbability;
                     });
}

// What tells a problem with finer spectra from the one that was given, so that
// long records need no copy.
struct SpectraOfLoads {
  std::vector<int> knots;  // of each ambient record
  std::string known_as;

  static SpectraOfLoads Of(const IdentificationProblem& problem) {
    SpectraOfLoads spectra;
    for (const AmbientRecord& record : problem.ambient) {
      spectra.knots.push_back(record.knots);
    }
    spectra.known_as = problem.description.known_as;
    return spectra;
  }
  void Set(IdentificationProblem* problem) const {
    for (size_t i = 0; i < knots.size(); ++i) {
      problem->ambient[i].knots = knots[i];
    }
    problem->description.known_as = known_as;
  }
};

// By how much the likelihood of the ambient records is larger in one fit than
// in another, and what the evidence takes off for that.
struct Comparison {
  double gain = 0.0;
  double price = 0.0;
};
Comparison Compare(const FitSummary& one, const FitSummary& other) {
  Comparison comparison;
  for (size_t i = 0; i < one.ambient.size(); ++i) {
    const LoadEvidence& first = one.ambient[i].evidence;
    const LoadEvidence& second = other.ambient[i].evidence;
    comparison.gain += first.log_likelihood - second.log_likelihood;
    comparison.price += first.price - second.price;
  }
  return comparison;
}

// "'wind' 13 instead of 7".
std::string DescribeFiner(const FitSummary& finer, const FitSummary& coarser) {
  std::vector<std::string> texts;
  for (size_t i = 0; i < finer.ambient.size(); ++i) {
    const int knots = finer.ambient[i].num_knots;
    const int before = coarser.ambient[i].num_knots;
    if (knots == before) continue;
    texts.push_back("'" + finer.ambient[i].name + "' " + std::to_string(knots) +
                    " instead of " + std::to_string(before));
  }
  return Join(texts, ", ");
}

// From a fit to the one that stands.
class LoadSettling {
 public:
  LoadSettling(InnerFit* fit, const IdentificationOptions& options,
               IdentificationProblem* problem, FitSummary* summary,
               IdentifiedModel* model)
      : fit_(*fit),
        near_(options),
        history_(FitHistory::Of(*summary)),
        given_(SpectraOfLoads::Of(*problem)),
        identity_(ProblemIdentity(*problem)),
        problem_(problem),
        summary_(summary),
        model_(model),
        best_(given_) {
    BeginNearTheEnd(&near_);
  }

  void Settle() {
    LookAnew();
    RefineUntilDescribed();
    RefineWhileEvidenceGrows();
    best_.Set(problem_);
    if (summary_->termination == Termination::kInterrupted) return;
    if (num_fits_ > 0) Finish();
  }

 private:
  // False where it was interrupted, which ends everything.
  bool Run(const std::string& what, const IdentifiedModel& begin,
           FitSummary* next, IdentifiedModel* found) {
    fit_.Run(what, *problem_, near_, &begin, next, found);
    ++num_fits_;
    history_.seconds += next->seconds;
    if (next->termination != Termination::kInterrupted) return true;
    summary_->termination = Termination::kInterrupted;
    summary_->message = "interrupted while the loads' spectra were refined";
    return false;
  }

  void Take(FitSummary next, IdentifiedModel found) {
    *summary_ = std::move(next);
    *model_ = std::move(found);
    best_ = SpectraOfLoads::Of(*problem_);
  }

  bool IsSound(const FitSummary& summary) const {
    return CheckFit(near_.tuning.gaps, summary).empty();
  }

  void LookAnew() {
    if (!MayHaveBetterLoads(*summary_)) return;
    FitSummary next;
    IdentifiedModel found;
    if (!Run("loads at the model found", *model_, &next, &found)) return;
    if (next.termination == Termination::kConverged &&
        next.final_cost < summary_->final_cost) {
      Take(std::move(next), std::move(found));
    }
  }

  void RefineUntilDescribed() {
    FitSummary last = *summary_;
    IdentifiedModel begin = *model_;
    std::vector<std::string> tried;
    for (; num_rounds_ < kMostRounds; ++num_rounds_) {
      if (last.termination != Termination::kConverged ||
          !RefineLoadSpectra(given_.knots, last, problem_)) {
        break;
      }
      if (tried.empty()) tried.push_back(Describe(given_.knots, last));
      problem_->description.known_as = identity_;
      FitSummary next;
      IdentifiedModel found;
      if (!Run("finer spectra of the loads", begin, &next, &found)) return;
      tried.push_back(Describe(given_.knots, next));
      last = next;
      begin = found;
      if (next.termination == Termination::kConverged &&
          IsBetter(next, *summary_)) {
        Take(std::move(next), std::move(found));
      }
    }
    if (tried.empty()) return;
    remarks_.push_back(
        "The spectra of the loads did not describe the ambient records and "
        "were refined: " +
        Join(tried, "; then ") + ". The result has " +
        Describe(given_.knots, *summary_) + ".");
  }

  void RefineWhileEvidenceGrows() {
    for (; num_rounds_ < kMostRounds; ++num_rounds_) {
      best_.Set(problem_);
      if (!IsSound(*summary_) ||
          summary_->termination != Termination::kConverged ||
          !RefineByEvidence(given_.knots, *summary_, problem_)) {
        return;
      }
      problem_->description.known_as = identity_;
      FitSummary next;
      IdentifiedModel found;
      if (!Run("spectra of the loads by the evidence", *model_, &next,
               &found) ||
          next.termination != Termination::kConverged) {
        return;
      }
      const Comparison more = Compare(next, *summary_);
      const bool has_evidence = more.gain > more.price;
      remarks_.push_back(Sentence(next, more));
      if (!has_evidence || !IsSound(next)) return;
      Take(std::move(next), std::move(found));
    }
  }

  // What the evidence has chosen.
  std::string Sentence(const FitSummary& next, const Comparison& more) const {
    const std::string outcome =
        more.gain <= more.price
            ? "The evidence chose no more knots of the loads' spectra: "
        : IsSound(next)
            ? "The evidence chose more knots of the loads' spectra: "
            : "The evidence would choose more knots of the loads' spectra, but "
              "they give no usable fit: ";
    return outcome + DescribeFiner(next, *summary_) + ". They add " +
           FormatNumber(more.gain, 3) +
           " to the logarithm of the likelihood and cost " +
           FormatNumber(more.price, 3) + " of evidence.";
  }

  // Of all that came before, the fit that stands knows nothing.
  void Finish() {
    summary_->seconds = 0.0;
    history_.Enter(summary_);
    std::vector<std::string>& remarks = summary_->remarks;
    remarks.insert(remarks.end(), remarks_.begin(), remarks_.end());
  }

  InnerFit& fit_;
  IdentificationOptions near_;
  FitHistory history_;
  const SpectraOfLoads given_;
  // To whoever wrote the case, one with finer spectra is the same problem.
  const std::string identity_;
  IdentificationProblem* const problem_;
  FitSummary* const summary_;  // of what stands
  IdentifiedModel* const model_;
  SpectraOfLoads best_;
  int num_fits_ = 0;
  int num_rounds_ = 0;  // of finer spectra
  std::vector<std::string> remarks_;
};

// Records for which `asks` is true get a knot between any two.
template <typename Asks>
bool Refine(const std::vector<int>& given, const FitSummary& summary,
            const Asks& asks, IdentificationProblem* problem) {
  bool refined = false;
  for (size_t i = 0; i < summary.ambient.size(); ++i) {
    const AmbientScore& score = summary.ambient[i];
    if (given[i] > 0 || score.num_knots < 2 ||
        score.coherence_probability < limits::kSpectrumProbability ||
        !asks(score)) {
      continue;
    }
    problem->ambient[i].knots = 2 * score.num_knots - 1;
    refined = true;
  }
  return refined;
}

}  // namespace

bool RefineLoadSpectra(const std::vector<int>& given, const FitSummary& summary,
                       IdentificationProblem* problem) {
  return Refine(
      given, summary,
      [](const AmbientScore& score) {
        return score.probability < limits::kSpectrumProbability;
      },
      problem);
}

bool RefineByEvidence(const std::vector<int>& given, const FitSummary& summary,
                      IdentificationProblem* problem) {
  return Refine(
      given, summary,
      [](const AmbientScore& score) {
        return score.probability >= limits::kSpectrumProbability &&
               score.evidence.PromisesMore();
      },
      problem);
}

void SettleLoadSpectra(const IdentificationOptions& options, InnerFit* fit,
                       IdentificationProblem* problem, FitSummary* summary,
                       IdentifiedModel* model) {
  if (problem->ambient.empty()) return;
  LoadSettling(fit, options, problem, summary, model).Settle();
}

}  // namespace pinode
