// Errors of a model that records cannot tell from the unknowns of a problem.

#ifndef PINODE_STUDY_EXPLANATIONS_CONFUSIONS_H_
#define PINODE_STUDY_EXPLANATIONS_CONFUSIONS_H_

#include <string>
#include <vector>

#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/study/explanations/score_test.h"
#include "pinode/study/explanations/suspect.h"

namespace pinode {

// A suspect that changes the records as unknowns of the problem do.
struct Confusion {
  size_t suspect = 0;  // index into the catalogue
  // Named unknowns that take over an error of the usual size in it, unseen, and
  // by how much they change.
  std::vector<std::string> names;
  std::vector<double> changes;
  // Its standard deviation, as SuspectScore::deviation.
  double deviation = 0.0;
};

// Finds the suspects of one unknown of which the records do not see an error of
// the usual size, because the problem's unknowns take it over.
std::vector<Confusion> FindConfusions(const std::vector<Suspect>& suspects,
                                      const SuspectScores& scores);

// The same before a fit, at the initial values and whatever was measured: a
// sentence for each. None where records begin at unknown states, and for
// problems that Explain leaves alone.
std::vector<std::string> ConfusionsBeforeFit(
    const IdentificationProblem& problem, const IdentificationOptions& options);

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_CONFUSIONS_H_
