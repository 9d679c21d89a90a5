// Architecture of a network, without its weights.

#ifndef PINODE_NETWORK_NETWORK_ARCHITECTURE_H_
#define PINODE_NETWORK_NETWORK_ARCHITECTURE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Activation functions. The derivatives of kRelu and kLeakyRelu jump at zero.
// There the value from the left is used: 0 and kLeakyReluSlope. Their second
// derivative is zero everywhere.
enum class Activation {
  kTanh,
  kSigmoid,
  kRelu,
  kLeakyRelu,
  kSoftplus,
  kSine,
  kIdentity
};

// Positions of the matrices in the block of all weights. Their order is W_1,
// b_1, W_2, b_2, ..., W_L, b_L, W_skip; matrices are stored by columns. Parts
// that an architecture does not have are left out.
struct WeightLayout {
  // One matrix: index of its first weight, and its shape.
  struct Part {
    int offset = 0;
    int rows = 0;
    int cols = 0;
    int size() const { return rows * cols; }
  };
  // W_1 to W_L; W_L has num_outputs rows.
  std::vector<Part> weights;
  // b_1 to b_L. `cols` is 1, or 0 if the layer has no bias.
  std::vector<Part> biases;
  // W_skip; empty without a skip path.
  Part skip;
  // Total number of weights.
  int size = 0;

  int num_layers() const { return static_cast<int>(weights.size()); }
};

// Feed-forward network with a parallel linear path, eq. (6) of Z. Lai, C.
// Mylonas, S. Nagarajaiah and E. Chatzi, J. Sound Vib. 508 (2021) 116196:
//
//   a_0 = q / s                          (elementwise)
//   a_l = act(W_l a_{l-1} + b_l)         l = 1 ... L-1
//   g(q) = r (W_L a_{L-1} + b_L + W_skip a_0)
//
// s and r are the scales of inputs q and outputs g, applied elementwise.
// Without hidden layers the network is linear, g = r (W_1 a_0 + b_1). `skip`
// then has no effect.
//
// The gauged form has zero value and zero slope at rest, q = 0:
//
//   y(q) = g(q) - g(0) - (dg/dq)(0) q,
//
// A stiffness or damping group with the same inputs then is the tangent at
// rest, and is not confused with the network. b_L and W_skip would cancel. The
// layout therefore has no b_L, and IsValid refuses `skip` and empty
// `hidden_widths`. For |q / s| << 1 the three terms nearly cancel, so that the
// error of y is the rounding error of g.
struct NetworkArchitecture {
  // Numbers of features q and of outputs.
  int num_inputs = 0;
  int num_outputs = 0;
  // Sizes of a_1 to a_{L-1}. Empty: a linear network.
  std::vector<int> hidden_widths;
  Activation activation = Activation::kTanh;
  // True: the network has the b_l, has W_skip, or is gauged.
  bool bias = true;
  bool skip = true;
  bool gauge = false;
  // Scales s, one per input in the input's unit. Inputs are divided by them.
  // Empty: ones.
  Vector input_scale;
  // Scales r, one per output in the output's unit. Results are multiplied by
  // them. Empty: ones. With both scales the weights are dimensionless.
  Vector output_scale;

  // Checks the architecture. On failure returns false, and *error names the
  // field, its value and the violated rule.
  [[nodiscard]] bool IsValid(std::string* error) const;

  // True without hidden layers.
  bool IsLinear() const { return hidden_widths.empty(); }
  bool HasSkipPath() const { return skip && !IsLinear(); }

  // Return positions and number of the weights. The functions from here on
  // require a valid architecture.
  WeightLayout Layout() const;
  int NumWeights() const { return Layout().size; }

  // Returns one flag per weight, true for weights that a decay may shrink: all
  // but W_skip and b_L. All flags are false for a linear network.
  std::vector<bool> NonlinearWeights() const;
};

// Returns the linear path of a network, num_outputs x num_inputs, so that it
// can be added to the model's matrices (Lai et al. 2021, eq. (17)). It is
// diag(r) W_1 diag(1/s) for a linear network, and diag(r) W_skip diag(1/s) for
// others. Without a skip path it is zero. `weights` has NumWeights() entries.
Matrix LinearPart(const NetworkArchitecture& architecture,
                  const Vector& weights);

// Returns the constant diag(r) b_1 of a linear network (num_outputs entries),
// zero without a bias. Aborts for a network that is not linear, because its
// constant does not belong to the linear path alone.
Vector ConstantPart(const NetworkArchitecture& architecture,
                    const Vector& weights);

}  // namespace pinode

#endif  // PINODE_NETWORK_NETWORK_ARCHITECTURE_H_
