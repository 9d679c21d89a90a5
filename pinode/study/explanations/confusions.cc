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

// Rounding of the information, and less.
constexpr double kNothingLeft = 1e-4;
// Change of an unknown that matters, for an error of the usual size.
constexpr double kMuch = 0.03;

bool BeginsKnown(const IdentificationRecord& record) {
  return record.start != IdentificationRecord::Start::kFree;
}

}  // namespace

std::vector<Confusion> FindConfusions(const std::vector<Suspect>& suspects,
                                      const SuspectScores& scores) {
  std::vector<Confusion> confusions;
  for (size_t i = 0; i < scores.suspects.size(); ++i) {
    const SuspectScore& score = scores.suspects[i];
    if (score.num_unknowns != 1 || score.information_left > kNothingLeft) {
      continue;
    }
    Confusion confusion;
    confusion.suspect = i;
    confusion.information_left = score.information_left;
    for (size_t j = 0; j < scores.names.size(); ++j) {
      const double change =
          suspects[i].usual * score.slopes[static_cast<Eigen::Index>(j)];
      if (!(std::abs(change) > kMuch)) continue;
      confusion.names.push_back("'" + scores.names[j] + "'");
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
    std::vector<std::string> changes;
    for (const double change : confusion.changes) {
      changes.push_back(FormatNumber(change, 2));
    }
    sentences.push_back("These records cannot tell " + suspect.what + " from " +
                        Join(confusion.names, " and ") + ": an error of " +
                        FormatNumber(suspect.usual, 2) +
                        " in it would change " +
                        (changes.size() == 1 ? "it" : "them") + " by " +
                        Join(changes, " and ") + ", and nobody would see it.");
  }
  return sentences;
}

}  // namespace pinode
