// Score tests of a catalogue of suspects at a fit.

#ifndef PINODE_STUDY_EXPLANATIONS_SCORE_TEST_H_
#define PINODE_STUDY_EXPLANATIONS_SCORE_TEST_H_

#include <string>
#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identified_model.h"
#include "pinode/study/explanations/suspect.h"

namespace pinode {

// Outcome for one suspect.
struct SuspectScore {
  // Expected gain of the log-likelihood if its unknowns were free, by one
  // Gauss-Newton step of them and of the problem's unknowns: Rao's score
  // statistic over two (C. R. Rao, Proc. Cambridge Phil. Soc. 44 (1948) 50-57).
  // Residuals count as white.
  double gain = 0.0;
  int num_unknowns = 0;
  // Standard deviation of its first unknown if the problem's unknowns are free
  // too, from the records alone: without priors.
  double deviation = 0.0;
  // Change of each of the problem's named unknowns, in the order of
  // `SuspectScores::names`, if the first unknown of the suspect changes by 1
  // and the records are still met best.
  Vector slopes;
};

struct SuspectScores {
  std::vector<SuspectScore> suspects;  // in the order of the catalogue
  std::vector<std::string> names;
  // For each of `names`: change and standard deviation if all suspects are
  // unknowns together, each with the prior deviation Suspect::usual, the noise
  // of the sensors is what has no memory in the residuals, and the cost is
  // linear.
  Vector usual_shifts;
  Vector usual_deviations;
};

// Returns the share of the residuals' energy in the training records that is
// noise: what has no memory from sample to sample. All of it where that is not
// known.
double NoiseShareOfTraining(const FitSummary& fit);

// Scores all suspects by one linearisation of `problem` with all their unknowns
// at its fit (`fit`, `model`). Exchanges of sensors have no score: their gain
// is 0. Unknowns at a bound are kept there. Returns false, with *error, if the
// extended problem is not valid or the cost is not finite.
[[nodiscard]] bool ScoreSuspects(const IdentificationProblem& problem,
                                 const FitSummary& fit,
                                 const IdentifiedModel& model,
                                 const std::vector<Suspect>& suspects,
                                 int num_threads, SuspectScores* scores,
                                 std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_SCORE_TEST_H_
