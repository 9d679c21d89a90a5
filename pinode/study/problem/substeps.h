// How many Runge-Kutta steps a record's sampling interval is divided into.

#ifndef PINODE_STUDY_PROBLEM_SUBSTEPS_H_
#define PINODE_STUDY_PROBLEM_SUBSTEPS_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/integrate/integrator.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// More steps per sample than this mean that the record is sampled too coarsely
// for the model.
inline constexpr int kMaxSubsteps = 1000;

struct SubstepChoice {
  Integrator integrator = Integrator::kRungeKutta;
  // Of Runge-Kutta; where the solution is exact, or by exponential steps, what
  // it would take about.
  int substeps = 1;
  StabilityReport stability;
  // Largest change of a fitted channel when the step is halved (RMS over the
  // record), and the limit it was held against, both in the channel's model
  // unit; NaN where no free run was possible.
  double error = 0.0;
  double error_limit = 0.0;
  std::string channel;
};

// d(dh/dt)/dh at rest, under the inputs of the record's first sample, with the
// tangents of all elements and networks (num_states x num_states). Laws without
// a finite tangent at rest are left out.
Matrix StateMatrixAtRest(const StructuralDynamics& dynamics,
                         const IdentificationRecord& record);

// The number of steps per sample at which halving the step changes the free run
// of the model as it is by less than a tenth of sigma in every fitted channel,
// or by less than 1e-4 of its RMS where sigma is to be estimated: doubled from
// the smallest stable number, then reduced as the fourth order of RK4 allows.
//
// The free run starts at rest or from the known start. Where the start is free
// it is taken from the first sample if displacement and velocity channels
// determine it, and at rest otherwise. Where that would be no motion at all, or
// the model diverges, the rule is step * max|lambda| <= 0.35: then RK4 errs by
// less than 5e-5 of the amplitude in a radian.
//
// `record.substeps` is not read. Fails where more than kMaxSubsteps would be
// needed, or where the dynamics cannot be prepared.
[[nodiscard]] bool ChooseSubsteps(const StructuralDynamics& dynamics,
                                  const IdentificationRecord& record,
                                  SubstepChoice* choice, std::string* error);

// What `substeps`, given by the user, mean. Fails if the integration would be
// unstable.
[[nodiscard]] bool CheckSubsteps(const StructuralDynamics& dynamics,
                                 const IdentificationRecord& record,
                                 int substeps, SubstepChoice* choice,
                                 std::string* error);

// Sets the steps of all records: zeros are chosen, and marked so; the others
// are checked. Where the solution is exact (see IntegratorOf) it takes none; if
// steps are given for a training record, the others take steps too. Exponential
// steps are chosen where they suit and at most half as many do as Runge-Kutta
// needs to be stable, or no more where there are 16 states, in all records or
// in none. False where a record asks for the exact solution of dynamics that
// are not linear, or for exponential steps where they do not suit. A model
// carries the error of the steps with which it was fitted, so where they are
// chosen no record is integrated more coarsely than the finest training record.
// On failure *failed is the record that *error speaks of.
[[nodiscard]] bool SetSubsteps(IdentificationProblem* problem,
                               std::vector<SubstepChoice>* choices, int* failed,
                               std::string* error);

}  // namespace pinode

#endif  // PINODE_STUDY_PROBLEM_SUBSTEPS_H_
