// Activation functions of the networks and their derivatives.

#ifndef PINODE_NETWORK_ACTIVATION_H_
#define PINODE_NETWORK_ACTIVATION_H_

#include <string>
#include <string_view>

#include "pinode/network/network_architecture.h"

namespace pinode {

// Slope of leaky_relu below zero.
inline constexpr double kLeakyReluSlope = 0.01;

// Returns the name as in the case file and the network file: tanh sigmoid relu
// leaky_relu softplus sine identity.
const char* ActivationName(Activation activation);

// Parses such a name. On failure *error gives the nearest name, or all names.
[[nodiscard]] bool ParseActivation(std::string_view name,
                                   Activation* activation, std::string* error);

// Applies the function to z[0..size). `value`, `slope` and `curvature` receive
// the function and its first and second derivative; `slope` may be null, and
// `curvature` may be null. `value` may be `z`. Allocates nothing.
void ApplyActivation(Activation activation, int size, const double* z,
                     double* value, double* slope, double* curvature);

}  // namespace pinode

#endif  // PINODE_NETWORK_ACTIVATION_H_
