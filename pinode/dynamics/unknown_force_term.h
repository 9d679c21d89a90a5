// A force that nobody measured, as a term of the equation of motion.

#ifndef PINODE_DYNAMICS_UNKNOWN_FORCE_TERM_H_
#define PINODE_DYNAMICS_UNKNOWN_FORCE_TERM_H_

#include <memory>
#include <string>

#include "pinode/dynamics/term.h"
#include "pinode/dynamics/unknown_force.h"

namespace pinode {

// A force that nobody measured: outputs * F(t) is added to the right-hand side.
struct UnknownForceTerm {
  std::string name;
  std::shared_ptr<const ForceHistory> history;
  Vector outputs;  // num_dofs
  // What happens in one record does not happen in another: an input that is
  // one in the force's record and zero in all others, by which the force is
  // multiplied. -1: the force acts in every record.
  int input = -1;
  ParameterBlock parameters;
  // Empty: none but the parameters' own. With one, all parameters are free or
  // none.
  CombinationPrior prior;
};

// At any instant it depends on few of its parameters, and so do its tangents.
std::unique_ptr<Term> MakeTerm(UnknownForceTerm force);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_UNKNOWN_FORCE_TERM_H_
