// Candidates: optional terms of a problem.

#ifndef PINODE_STUDY_TERMS_MODEL_CANDIDATE_H_
#define PINODE_STUDY_TERMS_MODEL_CANDIDATE_H_

#include <string>
#include <vector>

#include "pinode/dynamics/element_library.h"
#include "pinode/dynamics/law_term.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

// Optional law, or optional function of a library.
struct ModelCandidate {
  // Name of the candidate: the name of the law, or of the coefficient,
  // "<library>.<basis>".
  std::string name;
  std::string law;
  // Names of the candidate's parameters. Its force is proportional to
  // `amplitudes`, which are some of them. If all amplitudes are 0, it has no
  // effect.
  std::vector<std::string> parameters;
  std::vector<std::string> amplitudes;
  bool is_library_term = false;
};

// Returns the candidate for one function of a library; `function` is its index.
ModelCandidate LibraryCandidate(const LawTerm& library, int function);

// Returns the candidate for a named element. `infos` describes its parameters.
ModelCandidate ElementCandidate(const LawTerm& element,
                                const std::vector<ElementParameterInfo>& infos);

// Checks that these can be candidates of `problem`. It must have each term
// once, with a free amplitude, and training records. It must not have unknowns
// whose decay the evidence chooses (networks, splines of forces, curves of
// groups). These would compensate for terms that are left out. On failure
// returns false, and *error names the candidate.
[[nodiscard]] bool AreCandidatesOf(
    const IdentificationProblem& problem,
    const std::vector<ModelCandidate>& candidates, std::string* error);

// Makes a copy of `problem` without these terms, their parameters and their
// internal states, which are also removed from known starts. Integration steps
// are unchanged. The result has the identity of `problem` (ProblemIdentity).
// Returns false, with *error, if a candidate does not exist or the result is
// not valid.
[[nodiscard]] bool LeaveOut(const IdentificationProblem& problem,
                            const std::vector<ModelCandidate>& candidates,
                            IdentificationProblem* result, std::string* error);

// Returns `model`, a result of `problem`, as the initial model of a fit of
// `other`. Both problems have the same records and share some terms. Parameters
// and states are matched by name. Parameters that `problem` lacks get the
// initial values of `other`, and such states 0.
IdentifiedModel ModelOfOther(const IdentificationProblem& problem,
                             const IdentifiedModel& model,
                             const IdentificationProblem& other);

}  // namespace pinode

#endif  // PINODE_STUDY_TERMS_MODEL_CANDIDATE_H_
