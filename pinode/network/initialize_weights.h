// Starting values of a network's weights.

#ifndef PINODE_NETWORK_INITIALIZE_WEIGHTS_H_
#define PINODE_NETWORK_INITIALIZE_WEIGHTS_H_

#include <cstdint>

#include "pinode/base/types.h"
#include "pinode/network/network_architecture.h"

namespace pinode {

// Returns random weights in the order of WeightLayout. The same seed gives the
// same weights on every platform, up to the rounding of log and cos.
//
// W_l of a hidden layer is normal with zero mean and the variance
//
//   2 / (inputs + outputs of the layer)    (Glorot and Bengio 2010), or
//   2 / ((1 + slope^2) inputs)             (He et al. 2015) for relu and
//                                          leaky_relu.
//
// Each unit of the first hidden layer starts with one input, in turn, with the
// variance of a layer that has one input and one output. Most devices depend on
// one deformation, and a network that starts by mixing all inputs continues to
// mix them. b_l of a hidden layer has the variance that W_l would have with all
// inputs. With b_l = 0 every kink would be at rest and a tanh network would be
// odd.
//
// With `zero_last_layer` W_L is zero, and so is the network: training starts
// from the physics alone. Without it W_L has a tenth of the Glorot deviation,
// small but not zero. b_L and W_skip are zero. W_1 is the last layer of a
// linear network.
Vector InitializeWeights(const NetworkArchitecture& architecture,
                         std::uint64_t seed, bool zero_last_layer);

}  // namespace pinode

#endif  // PINODE_NETWORK_INITIALIZE_WEIGHTS_H_
