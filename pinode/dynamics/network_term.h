// Networks as terms of the equation of motion.

#ifndef PINODE_DYNAMICS_NETWORK_TERM_H_
#define PINODE_DYNAMICS_NETWORK_TERM_H_

#include <memory>
#include <string>
#include <vector>

#include "pinode/dynamics/feature.h"
#include "pinode/dynamics/term.h"
#include "pinode/network/network.h"

namespace pinode {

// Network and its place in the structure.
struct NetworkTerm {
  using ActsAs = pinode::ActsAs;
  std::string name;
  // Network, and its inputs in their order.
  std::shared_ptr<const Network> network;
  std::vector<Feature> features;
  // Map from the network's outputs to the DOFs, num_dofs x outputs.
  Matrix outputs;
  std::vector<std::string> output_names;
  // Effect of the outputs. kForce: resisting forces, which are subtracted from
  // the loads. kAcceleration: they are added to dv/dt.
  ActsAs acts_as = ActsAs::kAcceleration;
  ParameterBlock weights;
  // Weight decay: precision (1 / variance) of the weights' Gaussian prior with
  // mean zero. Negative: the evidence chooses it (MacKay 1992).
  double decay = -1.0;
  // True if the weights are random and may be drawn again for a simpler
  // network. False if they were learned before.
  bool drawn = true;
};

// True for a network that depends on time alone and acts as a force. Such a
// network is an unknown force with the opposite sign: its output resists.
bool IsForceOfTime(const NetworkTerm& term);

// Creates the term. Term::IsValid checks sizes and features. The derivatives
// with respect to the weights cost one small matrix product per layer, for all
// stages of a step together. If some weights are fixed, the derivatives of all
// weights are computed, and those of the free ones are copied.
std::unique_ptr<Term> MakeTerm(NetworkTerm network);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_NETWORK_TERM_H_
