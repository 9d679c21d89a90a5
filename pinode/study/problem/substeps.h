// Number of Runge-Kutta steps per sampling interval of a record.

#ifndef PINODE_STUDY_PROBLEM_SUBSTEPS_H_
#define PINODE_STUDY_PROBLEM_SUBSTEPS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/integrate/integrator.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Largest number of steps per sample. If more are needed, the samples of the
// record are too far apart for the model.
inline constexpr int kMaxSubsteps = 1000;

// Integrator and steps of one record, with the reasons.
struct SubstepChoice {
  Integrator integrator = Integrator::kRungeKutta;
  // Number of Runge-Kutta steps per sample. For other integrators, the
  // approximate number that Runge-Kutta would need.
  int substeps = 1;
  StabilityReport stability;
  // Change of the fitted channel `channel` if the step is halved (RMS over the
  // record), and its limit, both in the channel's model unit. The channel is
  // the one with the largest change. NaN if no simulation was possible.
  double error = 0.0;
  double error_limit = 0.0;
  std::string channel;
};

// Returns the state matrix d(dh/dt)/dh at rest, num_states x num_states, with
// the tangents of all elements and networks. Inputs are those of the record's
// first sample. Laws without a finite tangent at rest are left out.
Matrix StateMatrixAtRest(const StructuralDynamics& dynamics,
                         const IdentificationRecord& record);

// Chooses the number of steps per sample so that halving the step hardly
// changes the simulation of the initial model. In every fitted channel the
// change must be below a tenth of sigma, or 1e-4 of its RMS if sigma is to be
// estimated. The number is doubled from the smallest stable one. It is then
// reduced as far as the fourth order of the method allows.
//
// The simulation starts from the known start. A free start is taken from the
// first sample if channels of displacement and velocity determine it, and is
// rest otherwise. If nothing moves, or the simulation diverges, the rule is
// step * max|lambda| <= 0.35. The error is then below 5e-5 of the amplitude per
// radian.
//
// `record.substeps` is not read. Returns false, with *error, if more than
// kMaxSubsteps would be needed or the dynamics cannot be prepared.
[[nodiscard]] bool ChooseSubsteps(const StructuralDynamics& dynamics,
                                  const IdentificationRecord& record,
                                  SubstepChoice* choice, std::string* error);

// Checks the number of steps per sample that a user has given. Returns false,
// with *error, if the integration would be unstable.
[[nodiscard]] bool CheckSubsteps(const StructuralDynamics& dynamics,
                                 const IdentificationRecord& record,
                                 int substeps, SubstepChoice* choice,
                                 std::string* error);

// Sets the steps of all records:
//
// - If `substeps` is 0, steps are chosen, and `substeps_chosen` is set. Given
//   steps are checked.
// - The exact solution (see IntegratorOf) needs no steps. If a training record
//   has given steps, the other records get steps too.
// - Exponential steps are used in all records or in none. They must suit the
//   dynamics. With 16 or more states they must be at most as many as
//   Runge-Kutta needs to be stable, with fewer states half as many.
// - If steps are chosen, no record has fewer steps than the finest training
//   record, because a model contains the error of the steps of its fit.
//
// Returns false, with *error, if steps cannot be chosen or are unstable. Also
// returns false if a record requires the exact solution of nonlinear dynamics,
// or exponential steps that are not suitable. *failed is then the index of the
// record, and records before it may have new steps: PrepareProblem restores
// them. No pointer may be null.
[[nodiscard]] bool SetSubsteps(IdentificationProblem* problem,
                               std::vector<SubstepChoice>* choices, int* failed,
                               std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_SUBSTEPS_H_
