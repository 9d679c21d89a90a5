// Model that an identification has found.

#ifndef PINODE_PROBLEM_IDENTIFIED_MODEL_H_
#define PINODE_PROBLEM_IDENTIFIED_MODEL_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// The identified model: values of all parameters, noise levels and starts. The
// next identification, damage detection or discovery begins from it.
struct IdentifiedModel {
  Vector parameters;           // dynamics first, then sensors
  std::vector<Vector> sigmas;  // per record of the problem (training ones)
  std::vector<Vector> starts;  // per record
  Vector decays;               // per decay group of the parameter layout
  // Stage in which an interrupted fit continues, from 1. 0: this is a result,
  // and a fit that begins with it goes through all stages.
  int resume_stage = 0;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_IDENTIFIED_MODEL_H_
