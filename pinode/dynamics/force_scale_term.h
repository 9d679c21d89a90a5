// Measured forces whose scale is unknown, as a term of the equation of motion.

#ifndef PINODE_DYNAMICS_FORCE_SCALE_TERM_H_
#define PINODE_DYNAMICS_FORCE_SCALE_TERM_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/dynamics/term.h"

namespace pinode {

// One unknown factor s of measured forces u_i at the DOFs d_i: a load cell
// whose sensitivity or sign is not known. The linear part has them once
// already, so that the term is
//
//   M dv/dt += (s - 1) sum_i c_i u_i e_(d_i),
//
// with c_i = 1, or the switch of the record in which force i has this scale.
// The columns of the inputs stay as they were measured: features that look at
// them see no scale.
struct ForceScaleTerm {
  struct Force {
    int input = -1;  // of kind kForce
    // An input that is one in records of this scale and zero in all others; -1:
    // the force has it in every record.
    int record_switch = -1;
  };
  std::string name;
  std::vector<Force> forces;  // at least one
  ParameterBlock parameters;  // s alone
};

// `inputs` are those of the dynamics, which say where the forces act; nullptr,
// with *error, where there is none, or one of them is no force.
std::unique_ptr<Term> MakeTerm(ForceScaleTerm scale,
                               const std::vector<InputSpec>& inputs,
                               std::string* error);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_FORCE_SCALE_TERM_H_
