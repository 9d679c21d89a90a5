// Measured forces with an unknown scale, as a term of the equation of motion.

#ifndef PINODE_DYNAMICS_FORCE_SCALE_TERM_H_
#define PINODE_DYNAMICS_FORCE_SCALE_TERM_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/dynamics/term.h"

namespace pinode {

// Unknown factor s of measured forces u_i at the DOFs d_i, for a load cell with
// unknown sensitivity or sign. The linear part already contains the forces with
// the factor 1, so the term adds the rest:
//
//   M dv/dt += (s - 1) sum_i c_i u_i e_(d_i),
//
// e_d is the unit vector of DOF d. c_i is 1, or the switch of the record in
// which force i has this scale. The inputs stay as measured, so features that
// use them are not scaled.
struct ForceScaleTerm {
  struct Force {
    int input = -1;  // index of an input of kind kForce
    // Index of an input that is 1 in the records with this scale and 0 in all
    // others. -1: the force has this scale in every record.
    int record_switch = -1;
  };
  std::string name;
  std::vector<Force> forces;  // at least one
  ParameterBlock parameters;  // the factor s, dimensionless
};

// Creates the term. `inputs` are the inputs of the dynamics and give the DOFs
// of the forces. Returns nullptr, with *error, if an input does not exist or is
// not a force.
std::unique_ptr<Term> MakeTerm(ForceScaleTerm scale,
                               const std::vector<InputSpec>& inputs,
                               std::string* error);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_FORCE_SCALE_TERM_H_
