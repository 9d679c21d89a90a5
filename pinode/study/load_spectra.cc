#include "pinode/study/load_spectra.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/study/checkpoint.h"

namespace pinode {
namespace {

constexpr int kMostRounds = 2;

// By the record that is described worst; where no probability can be told from
// zero, by how far the spectra are from it.
bool IsBetter(const IdentificationSummary& one,
              const IdentificationSummary& other) {
  const auto least = [](const IdentificationSummary& summary) {
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
std::string Describe(const std::vector<int>& given,
                     const IdentificationSummary& summary) {
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
bool MayHaveBetterLoads(const IdentificationSummary& summary) {
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

bool Interrupted(const IdentificationSummary& next,
                 IdentificationSummary* summary) {
  if (next.termination != Termination::kInterrupted) return false;
  summary->termination = Termination::kInterrupted;
  summary->usable = false;
  summary->message = "interrupted while the loads' spectra were refined";
  return true;
}

}  // namespace

bool RefineLoadSpectra(const std::vector<int>& given,
                       const IdentificationSummary& summary,
                       IdentificationProblem* problem) {
  bool refined = false;
  for (size_t i = 0; i < summary.ambient.size(); ++i) {
    const AmbientScore& score = summary.ambient[i];
    if (given[i] > 0 || score.num_knots < 2 ||
        score.probability >= kLeastAmbientProbability ||
        score.coherence_probability < kLeastAmbientProbability) {
      continue;
    }
    problem->ambient[i].knots = 2 * score.num_knots - 1;
    refined = true;
  }
  return refined;
}

void SettleLoadSpectra(const FitFunction& fit,
                       const IdentificationOptions& options,
                       IdentificationProblem* problem,
                       IdentificationSummary* summary, IdentifiedModel* model) {
  if (problem->ambient.empty()) return;
  const SpectraOfLoads given = SpectraOfLoads::Of(*problem);
  SpectraOfLoads best = given;
  const FitFunction run = FitOrIdentify(fit);
  IdentificationOptions near = options;
  BeginNearTheEnd(&near);
  const IdentificationSummary first = *summary;
  bool again = false;
  IdentificationSummary last = first;
  IdentifiedModel begin = *model;
  // To whoever wrote the case, one with finer spectra is the same problem.
  const std::string identity = ProblemIdentity(*problem);
  std::vector<std::string> tried;
  if (MayHaveBetterLoads(first)) {
    IdentificationSummary next;
    IdentifiedModel found;
    run("loads at the model found", *problem, near, &begin, &next, &found);
    if (Interrupted(next, summary)) return;
    last.seconds = next.seconds += first.seconds;
    if (next.termination == Termination::kConverged &&
        next.final_cost < first.final_cost) {
      last = next;
      begin = found;
      *summary = std::move(next);
      *model = std::move(found);
    }
    again = true;
  }
  for (int round = 0; round < kMostRounds; ++round) {
    if (last.termination != Termination::kConverged ||
        !RefineLoadSpectra(given.knots, last, problem)) {
      break;
    }
    if (tried.empty()) tried.push_back(Describe(given.knots, last));
    problem->description.known_as = identity;
    IdentificationSummary next;
    IdentifiedModel found;
    run("finer spectra of the loads", *problem, near, &begin, &next, &found);
    if (Interrupted(next, summary)) break;
    tried.push_back(Describe(given.knots, next));
    next.seconds += last.seconds;
    last = next;
    begin = found;
    if (next.termination != Termination::kConverged ||
        !IsBetter(next, *summary)) {
      continue;
    }
    *summary = std::move(next);
    *model = std::move(found);
    best = SpectraOfLoads::Of(*problem);
  }
  best.Set(problem);
  if (summary->termination == Termination::kInterrupted) return;
  if (tried.empty() && !again) return;
  // Of all that came before, the fit that stands knows nothing.
  summary->seconds = last.seconds;
  summary->choice = first.choice;
  summary->way = first.way;
  summary->linear_error = first.linear_error;
  const std::string sentence = first.choice.Sentence();
  if (!first.choice.empty() &&
      std::find(summary->remarks.begin(), summary->remarks.end(), sentence) ==
          summary->remarks.end()) {
    summary->remarks.push_back(sentence);
  }
  if (tried.empty()) return;
  summary->remarks.push_back(
      "The spectra of the loads were refined, for they did not describe the "
      "ambient records: " +
      Join(tried, "; then ") + ". What stands is " +
      Describe(given.knots, *summary) + ".");
}

}  // namespace pinode
