// A network as a term of the equation of motion.

#ifndef PINODE_DYNAMICS_NETWORK_TERM_H_
#define PINODE_DYNAMICS_NETWORK_TERM_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/dynamics/feature.h"
#include "pinode/dynamics/term.h"
#include "pinode/network/network.h"

namespace pinode {

// A network at its place.
struct NetworkTerm {
  using ActsAs = pinode::ActsAs;
  std::string name;
  std::shared_ptr<const Network> network;
  std::vector<Feature> features;
  Matrix outputs;  // num_dofs x network outputs
  std::vector<std::string> output_names;
  ActsAs acts_as = ActsAs::kAcceleration;
  ParameterBlock weights;
  // Weight decay: the precision of a zero-mean Gaussian prior. Negative: the
  // evidence chooses it.
  double decay = -1.0;
  // True if the weights are random and may be drawn again for a simpler
  // network. False if they were learned before.
  bool drawn = true;
};

// Returns true for a network that depends on time alone and acts as a force.
// Such a network is an unknown force.
bool IsForceOfTime(const NetworkTerm& term);

// Creates the term. Its weights' tangents are one small matrix product per
// layer for all stages together. If all weights are free, as in most cases, the
// product is written directly to its columns. If some are fixed, all are
// computed separately and the free ones are copied, which costs less than
// products of half layers.
std::unique_ptr<Term> MakeTerm(NetworkTerm network);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_NETWORK_TERM_H_
