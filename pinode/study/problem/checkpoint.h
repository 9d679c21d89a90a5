// A fit on its way, and by what its problem is known again.

#ifndef PINODE_STUDY_PROBLEM_CHECKPOINT_H_
#define PINODE_STUDY_PROBLEM_CHECKPOINT_H_

#include <string>
#include <vector>

#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/model_choice.h"
#include "pinode/problem/parameter_profile.h"

namespace pinode {

struct Checkpoint {
  int iteration = 0;
  double cost = 0.0;
  // What Identify takes as its `initial`. Of a fit that was still running it
  // has no starts.
  IdentifiedModel model;
  // Those that are done, of a fit that has ended.
  std::vector<ParameterProfile> profiles;
  // Where terms are chosen: what was by then. `model` is of the problem without
  // what it has left out.
  ModelChoice choice;
};

// 16 hexadecimal digits that stand for a problem: matrices, named unknowns,
// networks' sizes, records and their numbers, but neither its description nor
// the options of a fit, which may be changed between a fit and its
// continuation.
std::string ProblemHash(const IdentificationProblem& problem);

// By what results of the problem are known: ProblemDescription::known_as, else
// its hash.
std::string ProblemIdentity(const IdentificationProblem& problem);

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_CHECKPOINT_H_
