// A law as a term of the equation of motion.

#ifndef PINODE_DYNAMICS_LAW_TERM_H_
#define PINODE_DYNAMICS_LAW_TERM_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/dynamics/feature.h"
#include "pinode/dynamics/law.h"
#include "pinode/dynamics/term.h"

namespace pinode {

// A law at its place. `outputs` (num_dofs x law outputs) maps its results to
// the DOFs.
struct LawTerm {
  std::string name;
  std::string type;  // an element type, "library" (see LibraryLaw), or "user"
  // Identifier of a user's law, which distinguishes it from others. May be
  // empty.
  std::string identity;
  std::shared_ptr<const Law> law;
  std::vector<Feature> features;
  Matrix outputs;
  ActsAs acts_as = ActsAs::kForce;
  ParameterBlock parameters;
};

// Creates the term. Its derivatives are those of Law::Linearize.
std::unique_ptr<Term> MakeTerm(LawTerm law);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_LAW_TERM_H_
