// Groups and other kinds of change together, near a fit that may lack the
// latter.

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

// Fit of records.
struct FitOfRecords {
  std::string name;  // for messages
  IdentificationProblem problem;
  FitSummary summary;
  IdentifiedModel model;
};

// Returns the unexplained motion (StructuredError) of the training records, the
// largest; of those where it is at least `least_share` of the residuals, for
// from noise alone less cannot be told.
double MissedOf(const FitSummary& summary, double least_share);

// Scales the entries of `state` after the groups to the units of their
// candidates.
void ScaleToUnits(const std::vector<ChangeCandidate>& candidates,
                  GroupState* state);

// Adds to the problem of `fit` the candidates that are not yet its unknowns,
// and sets *at to the fit's values in it. Returns false, with *error, if the
// fit does not belong to its problem, or a candidate cannot be a term of it.
[[nodiscard]] bool WithCandidates(
    const FitOfRecords& fit, const std::vector<ChangeCandidate>& candidates,
    IdentificationProblem* extended, IdentifiedModel* at, std::string* error);

// Computes `groups` (or other parameters) and candidates after one Gauss-Newton
// step from `fit`. With H and g the Hessian and gradient of the cost with the
// candidates as unknowns,
//
//   theta = theta_fit - H^-1 g,   cov(theta) = H^-1
//
// (autocorrelated residuals count as fewer samples, see FittedCost). Groups as
// in Baseline, candidates in their units. Returns false, with *error, if the
// fit does not belong to its problem, a candidate cannot be a term of it, or
// the cost is not finite.
[[nodiscard]] bool StateNear(const FitOfRecords& fit,
                             const std::vector<std::string>& groups,
                             const std::vector<ChangeCandidate>& candidates,
                             int num_threads, GroupState* state,
                             std::string* error);

// Computes what these candidates, not yet unknowns of `fit`, promise to save of
// its cost, as minus a log-likelihood, by the same step. Returns false as
// StateNear does.
[[nodiscard]] bool PromiseOf(const FitOfRecords& fit,
                             const std::vector<ChangeCandidate>& candidates,
                             int num_threads, double* promise,
                             std::string* error);

// Replaces alpha of groups and masses by log(1 + alpha). If the ground shakes a
// structure, multiplying all of them by the same factor gives an equivalent
// structure. In logarithms that direction is the same on both sides, whatever
// has changed between them. Entries that are nearly zero in one of the states
// keep alpha in all of them. Returns one flag per entry, true for logarithms.
std::vector<bool> ToLogarithms(size_t num_groups,
                               const std::vector<ChangeCandidate>& candidates,
                               std::vector<GroupState>* states);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_WIDE_STATE_H_
