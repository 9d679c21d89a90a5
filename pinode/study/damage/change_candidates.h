// Other kinds of change than those of groups, as terms of a problem.

#ifndef PINODE_STUDY_DAMAGE_CHANGE_CANDIDATES_H_
#define PINODE_STUDY_DAMAGE_CHANGE_CANDIDATES_H_

#include <string>
#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/study/damage/damage_search.h"

namespace pinode {

// Candidates at the places of `search`, which is valid: masses, and per spring
// four nonlinear forces,
//
//   opening    |d|            stiffness that differs by sign, as of a crack
//   hardening  d^3            or softening
//   friction   tanh(w / v0)   v0 a tenth of the RMS of w
//   drag       |w| w
//
// of deformation d and rate w, with units by the trajectories of `summary`, a
// fit of the problem's own unknowns.
std::vector<ChangeCandidate> MakeChangeCandidates(
    const IdentificationProblem& problem, const DamageSearch& search,
    const FitSummary& summary, const IdentifiedModel& model);

// The deformation of a candidate's place, then its rate: what its function may
// look at.
std::vector<Feature> FeaturesOf(const ChangeCandidate& candidate);

// Standard deviation of the prior of a candidate's unknown around zero.
double PriorOf(const ChangeCandidate& candidate);

// `problem` with these candidates as further unknowns that begin at zero, each
// with a prior of deviation 1 in its unit, which says no more than that it is
// not many times what is there, and keeps what the data cannot see from running
// away. False where a name is taken, or a candidate is none of this problem's.
[[nodiscard]] bool AddCandidates(const IdentificationProblem& problem,
                                 const std::vector<ChangeCandidate>& candidates,
                                 IdentificationProblem* extended,
                                 std::string* error);

// RMS of the candidates' forces at each place together as a fraction of the
// RMS of the whole restoring force there, K x and theirs at DOF `to`, on the
// trajectories of `summary`, a fit that had them; into their subjects.
void SetForceShares(const IdentificationProblem& extended,
                    const FitSummary& summary, const IdentifiedModel& model,
                    std::vector<ChangeCandidate>* candidates);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_CHANGE_CANDIDATES_H_
