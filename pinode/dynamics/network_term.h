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

// A network.
struct NetworkTerm {
  using ActsAs = pinode::ActsAs;
  std::string name;
  std::shared_ptr<const Network> network;
  std::vector<Feature> features;
  Matrix outputs;  // num_dofs x network outputs
  std::vector<std::string> output_names;
  ActsAs acts_as = ActsAs::kAcceleration;
  ParameterBlock weights;
  // Weight decay: negative asks for the evidence's choice, otherwise the
  // precision of a zero-mean Gaussian prior.
  double decay = -1.0;
  // The weights were drawn at random and may be drawn again on the way to a
  // simpler network; false where they were learned before.
  bool drawn = true;
};

// A network that depends on time alone and acts as a force is an unknown force.
bool IsForceOfTime(const NetworkTerm& term);

// Its weights' tangents are one small matrix product per layer for all stages
// together. Where all weights are free, as they nearly always are, the product
// goes straight to its columns; where some are fixed, all are computed beside
// and the free ones copied, which costs less than products of half layers.
std::unique_ptr<Term> MakeTerm(NetworkTerm network);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_NETWORK_TERM_H_
