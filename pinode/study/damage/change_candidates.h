// Changes of other kinds than those of groups, as terms of a problem.

#ifndef PINODE_STUDY_DAMAGE_CHANGE_CANDIDATES_H_
#define PINODE_STUDY_DAMAGE_CHANGE_CANDIDATES_H_

#include <string>
#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/verdict.h"
#include "pinode/study/damage/damage_search.h"

namespace pinode {

// Place of the candidate that is one factor on all damping.
inline constexpr char kAllModes[] = "all modes";

// Returns candidates at the places of `search`, which is valid: masses, factors
// on the damping, stiffness that is in no group, and four nonlinear forces per
// spring,
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

// Returns the candidates that describe the likeliest of `explanations` (best
// first). One factor on all masses is passed over, because it is the same
// structure in other units: the next explanation stands for it if its odds are
// like the best's. Empty: more than noise is left, or a part of the explanation
// is no candidate, as the gain of a sensor.
std::vector<ChangeCandidate> ExplainedCandidates(
    const std::vector<Explanation>& explanations,
    const std::vector<ChangeCandidate>& candidates);

// Returns the features of a candidate's function: the deformation of its place,
// then the rate.
std::vector<Feature> FeaturesOf(const ChangeCandidate& candidate);

// Returns the standard deviation of the prior of a candidate's unknown around
// zero.
double PriorOf(const ChangeCandidate& candidate);

// Extends `problem` by these candidates as unknowns that begin at zero. Each
// has a prior of deviation 1 in its unit. The prior only says that a change is
// not many times its unit, and keeps undetermined candidates from growing.
// Returns false if a name is taken, or if a candidate does not belong to this
// problem.
[[nodiscard]] bool AddCandidates(const IdentificationProblem& problem,
                                 const std::vector<ChangeCandidate>& candidates,
                                 IdentificationProblem* extended,
                                 std::string* error);

// Sets the force shares of the candidates' subjects. A share is the RMS of the
// candidates' forces at each place together, as a fraction of the RMS of the
// whole restoring force there. The restoring force is K x and the candidates'
// forces at DOF `to`. The trajectories are those of `summary`, a fit with these
// candidates.
void SetForceShares(const IdentificationProblem& extended,
                    const FitSummary& summary, const IdentifiedModel& model,
                    std::vector<ChangeCandidate>* candidates);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_CHANGE_CANDIDATES_H_
