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

// Turns the change of log(1 + alpha) into that of 1 + alpha, in multiples of
// 1 / `baseline`: 1 gives a fraction of the baseline, 1 + alpha of the baseline
// a plain difference. The probability is that of a loss above `threshold`.
void FromLogarithm(double threshold, double baseline, GroupChange* change);

// EstimateChange of groups and `candidates` by ToLogarithms, with the changes
// turned back into those of alpha. `options` as OptionsFor gives them. Use it
// if one factor on all stiffness, damping and mass is not determined: in a free
// vibration, or under ground motion. Its direction in alpha is (1 + alpha),
// which is not the same in both states once something has changed. The two
// directions together would then explain any change.
[[nodiscard]] bool EstimateChangeByLogarithms(
    size_t num_groups, const std::vector<ChangeCandidate>& candidates,
    const std::vector<GroupState>& healthy, const GroupState& current,
    const ChangeOptions& options, ChangeEstimate* estimate, std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_WIDE_STATE_H_
