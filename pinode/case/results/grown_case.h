// Cases of problems that were made from others: the same records, other terms.

#ifndef PINODE_CASE_RESULTS_GROWN_CASE_H_
#define PINODE_CASE_RESULTS_GROWN_CASE_H_

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pinode/case/sections/case_file.h"
#include "pinode/discover/discovery.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/study/damage/change_candidates.h"
#include "pinode/study/reduction/reduced_structure.h"

namespace pinode {

// Makes the case of `problem`, which is that of `c` with these candidates, with
// the options of `c`. False, with *error,
// where the case cannot be read any more or says otherwise.
[[nodiscard]] bool CaseWithCandidates(
    const Case& c, const std::vector<ChangeCandidate>& candidates,
    const IdentificationProblem& problem, Case* grown, std::string* error);

// The same with `equations` in place of networks. Where `given_steps`, the case
// gives the steps of each record, as of a refit, and else leaves them as they
// were.
[[nodiscard]] bool CaseWithEquations(
    const Case& c, const std::vector<DiscoveredEquation>& equations,
    const IdentificationProblem& problem, bool given_steps, Case* grown,
    std::string* error);

// The case after a choice among its candidates: without those that were left
// out, by name, and with `problem`, which is that of `c` without them. Nothing
// is left to be chosen.
Case CaseAfterChoice(const Case& c, const std::vector<std::string>& left_out,
                     const IdentificationProblem& problem);

// The same where the problem has to be made. False, with *error, where a name
// is none of a candidate.
[[nodiscard]] bool LeaveOutOfCase(const std::vector<std::string>& left_out,
                                  Case* c, std::string* error);

// The model that pinode_update has left in the result folder `folder` for this
// case, which becomes the case as it was fitted: without terms that were left
// out, in the basis of that model. False, with *error, for another folder or
// another case's.
[[nodiscard]] bool ReadFittedModel(const std::string& folder, Case* c,
                                   IdentifiedModel* model, std::string* error);

// The case with these parameters of its groups, by name, fixed at these values;
// of a curve all of them.
void HoldInCase(const std::map<std::string, double>& values, Case* c);

// Returns true if the case asks for a basis that follows the parameters
// ([model.reduction] renew = true).
bool RenewsBasis(const Case& c);

// RenewBasis of a case with a finite-element model.
[[nodiscard]] bool RenewCase(const Case& c, const IdentifiedModel& model,
                             Case* renewed, IdentifiedModel* begin,
                             std::string* error);

// Makes *c the case as it was fitted: `problem`, `reduced` and `summary` are
// the outcome of Identify on it. Of c->problem only the dynamics are needed.
void TakeOver(IdentificationProblem problem,
              const std::shared_ptr<const ReducedStructure>& reduced,
              const IdentificationSummary& summary, Case* c);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_GROWN_CASE_H_
