// The last thing before a problem made in memory is fitted.

#ifndef PINODE_STUDY_PROBLEM_PREPARE_PROBLEM_H_
#define PINODE_STUDY_PROBLEM_PREPARE_PROBLEM_H_

#include <string>

#include "pinode/problem/identification_problem.h"

namespace pinode {

// Checks the problem (IdentificationProblem::IsValid) and sets the steps of all
// records whose `substeps` is 0; those that were given are checked (SetSubsteps
// in study/problem/substeps.h says how); then the scales of networks that have
// none (ScaleNetworks), and the starts of training records that their first
// samples say (FixTrainingStarts). A problem that comes from a case file is
// prepared already; to do it again changes nothing.
//
// False, with the problem untouched, where something is wrong: *error names the
// record, channel or mode, and what was expected.
[[nodiscard]] bool PrepareProblem(IdentificationProblem* problem,
                                  std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_PREPARE_PROBLEM_H_
