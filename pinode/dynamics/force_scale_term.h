// Measured forces with an unknown scale, as a term of the equation of motion.

#ifndef PINODE_DYNAMICS_FORCE_SCALE_TERM_H_
#define PINODE_DYNAMICS_FORCE_SCALE_TERM_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/dynamics/term.h"

namespace pinode {

// One unknown factor s of measured forces u_i at the DOFs d_i, for a load cell
// with unknown sensitivity or sign. The linear part already contains the forces
// once, so the term is
//
//   M dv/dt += (s - 1) sum_i c_i u_i e_(d_i),
//
// with c_i = 1, or the switch of the record in which force i has this scale.
// The inputs stay as measured: features that use them are not scaled.
struct ForceScaleTerm {
  struct Force {
    int input = -1;  // of kind kForce
    // Input that is one in records of this scale and zero in all others. -1:
    // the force has this scale in every record.
    int record_switch = -1;
  };
  std::string name;
  std::vector<Force> forces;  // at least one
  ParameterBlock parameters;  // s alone
};

// Creates the term. `inputs` are those of the dynamics and give the places of
// the forces. Returns nullptr, with *error, if an input does not exist or is
// not a force.
std::unique_ptr<Term> MakeTerm(ForceScaleTerm scale,
                               const std::vector<InputSpec>& inputs,
                               std::string* error);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_FORCE_SCALE_TERM_H_
