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

// Largest number of steps per sample. If more are needed, the record is sampled
// too coarsely for the model.
inline constexpr int kMaxSubsteps = 1000;

struct SubstepChoice {
  Integrator integrator = Integrator::kRungeKutta;
  // Number of Runge-Kutta steps. For the exact solution, or exponential steps,
  // the approximate number that Runge-Kutta would take.
  int substeps = 1;
  StabilityReport stability;
  // Largest change of a fitted channel when the step is halved (RMS over the
  // record), and its limit, both in the channel's model unit; NaN if no
  // simulation was possible.
  double error = 0.0;
  double error_limit = 0.0;
  std::string channel;
};

// Returns d(dh/dt)/dh at rest, under the inputs of the record's first sample,
// with the tangents of all elements and networks (num_states x num_states).
// Laws without a finite tangent at rest are left out.
Matrix StateMatrixAtRest(const StructuralDynamics& dynamics,
                         const IdentificationRecord& record);

// Chooses the number of steps per sample. Halving the step then changes the
// simulation of the initial model by less than a tenth of sigma in every fitted
// channel, or by less than 1e-4 of its RMS if sigma is to be estimated. The
// number is doubled from the smallest stable one, then reduced as the fourth
// order of RK4 allows.
//
// The simulation starts at rest or from the known start. A free start is taken
// from the first sample if displacement and velocity channels determine it, and
// is at rest otherwise. If that gives no motion, or the model diverges, the
// rule is step * max|lambda| <= 0.35: then RK4 errs by less than 5e-5 of the
// amplitude per radian.
//
// `record.substeps` is not read. Fails if more than kMaxSubsteps would be
// needed, or if the dynamics cannot be prepared.
[[nodiscard]] bool ChooseSubsteps(const StructuralDynamics& dynamics,
                                  const IdentificationRecord& record,
                                  SubstepChoice* choice, std::string* error);

// Checks `substeps`, given by the user. Fails if the integration would be
// unstable.
[[nodiscard]] bool CheckSubsteps(const StructuralDynamics& dynamics,
                                 const IdentificationRecord& record,
                                 int substeps, SubstepChoice* choice,
                                 std::string* error);

// Sets the steps of all records:
//
// - zeros are chosen, and marked so; given numbers are checked;
// - the exact solution (see IntegratorOf) takes no steps; if steps are given
//   for a training record, the other records take steps too;
// - exponential steps are chosen in all records or in none; they must suit, and
//   at most half as many must do as Runge-Kutta needs to be stable, or no more
//   with 16 states;
// - a model carries the error of the steps of its fit, so that no record is
//   integrated more coarsely than the finest training record where steps are
//   chosen.
//
// Returns false if a record asks for the exact solution of dynamics that are
// not linear, or for exponential steps that do not suit. On failure *failed is
// the record of *error.
[[nodiscard]] bool SetSubsteps(IdentificationProblem* problem,
                               std::vector<SubstepChoice>* choices, int* failed,
                               std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_SUBSTEPS_H_
