// Groups and other kinds of change together, near a fit that may lack these.

#ifndef PINODE_STUDY_DAMAGE_WIDE_STATE_H_
#define PINODE_STUDY_DAMAGE_WIDE_STATE_H_

#include <string>
#include <vector>

#include "pinode/damage/change.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identified_model.h"
#include "pinode/study/damage/change_candidates.h"

namespace pinode {

// A fit of records.
struct FitOfRecords {
  std::string name;  // for messages
  IdentificationProblem problem;
  FitSummary summary;
  IdentifiedModel model;
};

// The entries of `state` behind the groups in the unit of their candidates.
void ScaleToUnits(const std::vector<ChangeCandidate>& candidates,
                  GroupState* state);

// The problem of `fit` with those candidates that are no unknowns of it yet,
// and where the fit has come to in it. False, with *error, where the fit is
// none of its problem, or a candidate cannot be a term of it.
[[nodiscard]] bool WithCandidates(
    const FitOfRecords& fit, const std::vector<ChangeCandidate>& candidates,
    IdentificationProblem* extended, IdentifiedModel* at, std::string* error);

// `groups` (or other parameters) and candidates as one Gauss-Newton step from
// `fit` leaves them. With H and g the Hessian and gradient of the cost with the
// candidates as unknowns,
//
//   theta = theta_fit - H^-1 g,   cov(theta) = H^-1
//
// (residuals with a memory count as the fewer samples that they are, see
// FittedCost). Groups as in Baseline, candidates in their units. False, with
// *error, where the fit is none of its problem, a candidate cannot be a term of
// it, or the cost is not finite.
[[nodiscard]] bool StateNear(const FitOfRecords& fit,
                             const std::vector<std::string>& groups,
                             const std::vector<ChangeCandidate>& candidates,
                             int num_threads, GroupState* state,
                             std::string* error);

// log(1 + alpha) in place of alpha of groups and masses. Where the ground
// shakes a structure, all of them times the same factor is the same structure;
// that direction is then the same on both sides, whatever has changed between
// them. What is nearly gone in one of the states stays as it is in all of them.
void ToLogarithms(size_t num_groups,
                  const std::vector<ChangeCandidate>& candidates,
                  std::vector<GroupState>* states);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_WIDE_STATE_H_
