// Model that an identification has found, as the start of further work.

#ifndef PINODE_PROBLEM_IDENTIFIED_MODEL_H_
#define PINODE_PROBLEM_IDENTIFIED_MODEL_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Identified model: values of all parameters, noise levels and initial states.
// The next identification, damage detection or discovery begins from it.
struct IdentifiedModel {
  // Values of all parameters, first of the dynamics, then of the sensors, each
  // in its unit.
  Vector parameters;
  // Standard deviation of the noise of each channel, one vector per record, in
  // the model's units. Vectors of records that were not fitted are empty.
  std::vector<Vector> sigmas;
  // Initial state of each record, num_states entries.
  std::vector<Vector> starts;
  // Precision of each decay group, see ParameterLayout.
  Vector decays;
  // Stage in which an interrupted fit continues, from 1. 0: this is a result,
  // and a fit that begins with it goes through all stages.
  int resume_stage = 0;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_IDENTIFIED_MODEL_H_
