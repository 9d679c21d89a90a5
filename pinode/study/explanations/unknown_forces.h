// Unknown forces under other explanations. A force that nobody measured takes
// over whatever the model lacks at its place, so that a small misfit elsewhere
// may stand for a large error of the force.

#ifndef PINODE_STUDY_EXPLANATIONS_UNKNOWN_FORCES_H_
#define PINODE_STUDY_EXPLANATIONS_UNKNOWN_FORCES_H_

#include <string>
#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/verdict.h"
#include "pinode/study/explanations/suspect.h"

namespace pinode {

// Returns a finding where unknown forces leave motion unexplained, and where a
// record has no more fitted channels than unknown forces, so that nothing in it
// can contradict the model. Empty for a problem without unknown forces.
std::vector<Finding> CheckUnknownForces(const IdentificationProblem& problem,
                                        const FitSummary& fit);

// Returns, for each unknown force at one DOF, its other places: one suspect a
// DOF. Empty for structures with more than 12 DOFs, where each place would cost
// a fit.
std::vector<Suspect> MakeForcePlaces(const IdentificationProblem& problem);

// The unknown force that `other` moves most.
struct MovedForce {
  std::string name;
  // Root mean square of the change over that of the 95 % half-widths of `own`.
  double shift = 0.0;
  // Peaks of |F(t)| in `own` and `other`.
  double own_peak = 0.0, other_peak = 0.0;
};
MovedForce MostMovedForce(const std::vector<ForceEstimate>& own,
                          const std::vector<ForceEstimate>& other);

// Widens the bounds of each force so that they hold those of `other` too.
void WidenForces(const std::vector<ForceEstimate>& other,
                 std::vector<ForceEstimate>* forces);

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_UNKNOWN_FORCES_H_
