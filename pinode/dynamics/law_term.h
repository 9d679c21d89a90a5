// Laws as terms of the equation of motion.

#ifndef PINODE_DYNAMICS_LAW_TERM_H_
#define PINODE_DYNAMICS_LAW_TERM_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/dynamics/feature.h"
#include "pinode/dynamics/law.h"
#include "pinode/dynamics/term.h"

namespace pinode {

// Law and its place in the structure.
struct LawTerm {
  std::string name;
  // Element type, "library" (see LibraryLaw), "memory_network" or "user".
  std::string type;
  // Text that distinguishes a user's law from others. May be empty.
  std::string identity;
  std::shared_ptr<const Law> law;
  // Arguments of the law, Law::num_features() entries.
  std::vector<Feature> features;
  // Map from the law's outputs to the DOFs, num_dofs x Law::num_outputs(). A
  // spring from a to b with the deformation x[b] - x[a] has -1 at a and +1 at
  // b.
  Matrix outputs;
  // Effect of the outputs. kForce: resisting forces, which are subtracted from
  // the loads. kAcceleration: they are added to dv/dt.
  ActsAs acts_as = ActsAs::kForce;
  // Parameters of the law, Law::num_parameters() entries.
  ParameterBlock parameters;
};

// Creates the term. Its derivatives come from Law::Linearize. Term::IsValid
// checks the sizes.
std::unique_ptr<Term> MakeTerm(LawTerm law);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_LAW_TERM_H_
