// State of a running fit, and the hash by which its problem is recognised.

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
  // Argument `initial` of Identify. A fit that was still running has no starts.
  IdentifiedModel model;
  // Finished profiles, if the fit has ended.
  std::vector<ParameterProfile> profiles;
  // Choice of terms so far. `model` belongs to the problem without the terms
  // that it has left out.
  ModelChoice choice;
};

// Returns 16 hexadecimal digits that identify a problem: matrices, named
// unknowns, networks' sizes, records and their numbers. The description and the
// options of a fit are not included, so that they may change between a fit and
// its continuation.
std::string ProblemHash(const IdentificationProblem& problem);

// Returns the identity by which results of the problem are recognised:
// ProblemDescription::known_as, else its hash.
std::string ProblemIdentity(const IdentificationProblem& problem);

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_CHECKPOINT_H_
