// Optional terms of a problem.

#ifndef PINODE_STUDY_TERMS_MODEL_CANDIDATE_H_
#define PINODE_STUDY_TERMS_MODEL_CANDIDATE_H_

#include <string>
#include <vector>

#include "pinode/dynamics/element_library.h"
#include "pinode/dynamics/law_term.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

// Candidate: a law, or one term of a library.
struct ModelCandidate {
  // Name of the law, or of the coefficient, "<library>.<basis>".
  std::string name;
  std::string law;
  // Unknowns of the candidate, and those among them to which its force is
  // proportional: without these, or if they are 0, it has no effect.
  std::vector<std::string> parameters;
  std::vector<std::string> amplitudes;
  bool is_library_term = false;
};

// Returns the candidate for function number `function` of a library.
ModelCandidate LibraryCandidate(const LawTerm& library, int function);

// Returns the candidate for a named element, with its internal states.
ModelCandidate ElementCandidate(const LawTerm& element,
                                const std::vector<ElementParameterInfo>& infos);

// Checks that these can be candidates of `problem`. It must have each term,
// once, with a free amplitude, and training records to judge by. It must have
// no unknowns with a decay that the evidence chooses (networks, splines of
// forces, tables of groups), which would compensate for removed terms. On
// failure *error names the candidate.
[[nodiscard]] bool AreCandidatesOf(
    const IdentificationProblem& problem,
    const std::vector<ModelCandidate>& candidates, std::string* error);

// Makes `problem` without these terms. Their parameters and internal states are
// removed, also from known starts. Steps are unchanged. The problem keeps its
// identity (ProblemIdentity). Returns false, with *error, if a candidate does
// not exist or the rest is no valid problem.
[[nodiscard]] bool LeaveOut(const IdentificationProblem& problem,
                            const std::vector<ModelCandidate>& candidates,
                            IdentificationProblem* result, std::string* error);

// Returns `model`, one of `problem`, as the initial model of a fit of `other`,
// which has the same records and some of the same terms. Parameters and states
// are matched by name. Parameters that `problem` lacks have their own initial
// values, such states 0.
IdentifiedModel ModelOfOther(const IdentificationProblem& problem,
                             const IdentifiedModel& model,
                             const IdentificationProblem& other);

}  // namespace pinode

#endif  // PINODE_STUDY_TERMS_MODEL_CANDIDATE_H_
