#include "pinode/study/explanations/confusions.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/strings.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/problem/assumed_noise.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/explanations/catalogue.h"
#include "pinode/study/explanations/explain.h"

namespace pinode {
namespace {

// Change of an unknown that matters, for an error of the usual size.
constexpr double kMuch = 0.03;

bool BeginsKnown(const IdentificationRecord& record) {
  return record.start != IdentificationRecord::Start::kFree;
}

// "'k1', 'k2', 'k3' and 4 others".
std::string ListOf(const std::vector<std::string>& names) {
  constexpr size_t kMost = 3;
  std::vector<std::string> quoted;
  for (const std::string& name : names) {
    if (quoted.size() < kMost) quoted.push_back("'" + name + "'");
  }
  if (names.size() <= kMost) return Join(quoted, " and ");
  const size_t more = names.size() - kMost;
  return Join(quoted, ", ") + " and " + std::to_string(more) +
         (more == 1 ? " other" : " others");
}

// True if all that takes over an error in `suspect` is free in the problem and
// of the suspect's own kind: then the error is what the problem looks for.
bool IsAmongFree(const IdentificationProblem& problem, const Suspect& suspect,
                 const std::vector<std::string>& names) {
  if (suspect.groups.size() != 1) return false;
  const auto is_of_kind = [&](const std::string& name) {
    for (const GroupTerm& term : problem.dynamics->groups()) {
      if (term.alpha.name == name) {
        return term.group.target == suspect.groups[0].group.target;
      }
    }
    return false;
  };
  return std::all_of(names.begin(), names.end(), is_of_kind);
}

}  // namespace

std::vector<Confusion> FindConfusions(const std::vector<Suspect>& suspects,
                                      const SuspectScores& scores) {
  std::vector<Confusion> confusions;
  for (size_t i = 0; i < scores.suspects.size(); ++i) {
    const SuspectScore& score = scores.suspects[i];
    if (score.num_unknowns != 1 || !(score.deviation > suspects[i].usual)) {
      continue;
    }
    Confusion confusion;
    confusion.suspect = i;
    confusion.deviation = score.deviation;
    for (size_t j = 0; j < scores.names.size(); ++j) {
      const double change =
          suspects[i].usual * score.slopes[static_cast<Eigen::Index>(j)];
      if (!(std::abs(change) > kMuch)) continue;
      confusion.names.push_back(scores.names[j]);
      confusion.changes.push_back(change);
    }
    if (!confusion.names.empty()) confusions.push_back(std::move(confusion));
  }
  return confusions;
}

std::vector<std::string> ConfusionsBeforeFit(
    const IdentificationProblem& problem,
    const IdentificationOptions& options) {
  std::vector<std::string> sentences;
  if (!CanExplain(problem, options) ||
      !std::all_of(problem.records.begin(), problem.records.end(),
                   BeginsKnown)) {
    return sentences;
  }
  const ParameterLayout layout(problem);
  IdentifiedModel model;
  model.parameters = layout.InitialValues();
  model.sigmas = AssumedNoise(problem, options.tuning.noise);
  FitSummary fit;
  for (size_t r = 0; r < problem.records.size(); ++r) {
    const IdentificationRecord& record = problem.records[r];
    Vector start = record.known_start;
    if (start.size() == 0) {
      start = Vector::Zero(problem.dynamics->num_states());
    }
    model.starts.push_back(start);
    RecordScore score;
    score.name = record.name;
    score.role = record.role;
    ScoreRecord(problem, static_cast<int>(r), model.parameters, start, 0,
                &score);
    fit.records.push_back(std::move(score));
  }
  const std::vector<Suspect> suspects = MakeSuspects(problem, model);
  SuspectScores scores;
  std::string unused;
  if (!ScoreSuspects(problem, fit, model, suspects, options.num_threads,
                     &scores, &unused)) {
    return sentences;
  }
  for (const Confusion& confusion : FindConfusions(suspects, scores)) {
    const Suspect& suspect = suspects[confusion.suspect];
    if (IsAmongFree(problem, suspect, confusion.names)) continue;
    double most = 0.0;
    for (const double change : confusion.changes) {
      most = std::max(most, std::abs(change));
    }
    const std::string name = suspect.what.substr(0, suspect.what.find(" ("));
    const std::string those =
        confusion.names.size() == 1 ? "that parameter" : "those parameters";
    sentences.push_back(
        "The records do not separate " + name + " from " +
        ListOf(confusion.names) + ". An error of " +
        FormatNumber(suspect.usual, 2) + " in " + name + " changes " + those +
        " by up to " + FormatNumber(most, 2) +
        ", and no record shows it. Measure it, or give " + those + " a prior.");
  }
  return sentences;
}

}  // namespace pinode
