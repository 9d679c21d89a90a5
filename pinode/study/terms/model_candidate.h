// Terms of a problem that may be left out of it.

#ifndef PINODE_STUDY_TERMS_MODEL_CANDIDATE_H_
#define PINODE_STUDY_TERMS_MODEL_CANDIDATE_H_

#include <string>
#include <vector>

#include "pinode/dynamics/element_library.h"
#include "pinode/dynamics/law_term.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"

namespace pinode {

// A law, or one term of a library.
struct ModelCandidate {
  // That of the law, or of the coefficient, "<library>.<basis>".
  std::string name;
  std::string law;
  // The unknowns that go with it, and those among them to which its force is
  // proportional: without any of these, or where they are 0, it does not act.
  std::vector<std::string> parameters;
  std::vector<std::string> amplitudes;
  bool is_library_term = false;
};

// The function number `function` of a library.
ModelCandidate LibraryCandidate(const LawTerm& library, int function);

// A named element, with its internal states.
ModelCandidate ElementCandidate(const LawTerm& element,
                                const std::vector<ElementParameterInfo>& infos);

// Whether these can be candidates of `problem`: terms that it has, with a free
// amplitude, each one once; training records, by which they are judged; and no
// unknowns with a decay that the evidence chooses (networks, splines of forces,
// tables of groups), which would make up for what is left out. On failure
// *error names the candidate.
[[nodiscard]] bool AreCandidatesOf(
    const IdentificationProblem& problem,
    const std::vector<ModelCandidate>& candidates, std::string* error);

// `problem` without these of its terms: their parameters and internal states
// are gone, known starts are shorter by these. Steps stay as they are. The
// problem is known as what it was (ProblemIdentity). False, with *error, where
// one is not there or the rest makes no problem.
[[nodiscard]] bool LeaveOut(const IdentificationProblem& problem,
                            const std::vector<ModelCandidate>& candidates,
                            IdentificationProblem* result, std::string* error);

// `model`, one of `problem`, as the beginning of a fit of `other`, which has
// the same records and some of the same terms: parameters and states by name,
// the problem's own initial values and 0 for those that `problem` does not
// have.
IdentifiedModel ModelOfOther(const IdentificationProblem& problem,
                             const IdentifiedModel& model,
                             const IdentificationProblem& other);

}  // namespace pinode

#endif  // PINODE_STUDY_TERMS_MODEL_CANDIDATE_H_
