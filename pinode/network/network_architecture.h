// The architecture of a network, without its weights.

#ifndef PINODE_NETWORK_NETWORK_ARCHITECTURE_H_
#define PINODE_NETWORK_NETWORK_ARCHITECTURE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Activation functions. Where a derivative jumps (at zero, for kRelu and
// kLeakyRelu) the value from the left is used: 0 and kLeakyReluSlope. Their
// second derivative is zero everywhere.
enum class Activation {
  kTanh,
  kSigmoid,
  kRelu,
  kLeakyRelu,
  kSoftplus,
  kSine,
  kIdentity
};

// Positions of the matrices in the flat block of weights, in this order: W_1
// (column-major), b_1, W_2, b_2, ..., W_L, b_L, W_skip (column-major). Parts
// that an architecture does not have are left out.
struct WeightLayout {
  struct Part {
    int offset = 0;
    int rows = 0;
    int cols = 0;
    int size() const { return rows * cols; }
  };
  // W_1 ... W_L; the last one has num_outputs rows.
  std::vector<Part> weights;
  // b_1 ... b_L. `cols` is 1, or 0 if the layer has no bias.
  std::vector<Part> biases;
  // W_skip; empty without a skip path.
  Part skip;
  // Total number of weights.
  int size = 0;

  int num_layers() const { return static_cast<int>(weights.size()); }
};

// A feed-forward network, eq. (6) of Lai, Mylonas, Nagarajaiah, Chatzi (2021),
// with a parallel linear path:
//
//   a_0 = q / s                          (elementwise)
//   a_l = act(W_l a_{l-1} + b_l)         l = 1 ... L-1
//   g(q) = r (W_L a_{L-1} + b_L + W_skip a_0)
//
// Without hidden layers the network is linear, g = r (W_1 a_0 + b_1). W_1 then
// includes any skip path, and `skip` has no effect.
//
// In the gauged form the value and the slope at rest are subtracted,
//
//   y(q) = g(q) - g(0) - (dg/dq)(0) q,
//
// so that a stiffness or damping group over the same inputs is the tangent at
// rest. b_L and W_skip cancel: there is no b_L in the layout, and `skip` and an
// empty `hidden_widths` are refused. For |q / s| << 1 the three terms nearly
// cancel: the absolute error stays at the rounding of g.
struct NetworkArchitecture {
  int num_inputs = 0;
  int num_outputs = 0;
  std::vector<int> hidden_widths;
  Activation activation = Activation::kTanh;
  bool bias = true;
  bool skip = true;
  bool gauge = false;
  // s, in the features' units: features are divided by it. Empty means ones.
  Vector input_scale;
  // r, in the outputs' units: results are multiplied by it. Empty means ones.
  // With both scales the weights have no units.
  Vector output_scale;

  // Checks the architecture. On failure *error names the field, its value and
  // the violated rule.
  [[nodiscard]] bool IsValid(std::string* error) const;

  bool IsLinear() const { return hidden_widths.empty(); }
  bool HasSkipPath() const { return skip && !IsLinear(); }

  // The functions below require a valid architecture.
  WeightLayout Layout() const;
  int NumWeights() const { return Layout().size; }

  // Returns true for the weights that a decay may shrink: all but W_skip and
  // b_L. All are false for a linear network, which has no nonlinear part.
  std::vector<bool> NonlinearWeights() const;
};

// Returns the explicit linear map in the weights, for folding it into the model
// (eq. 17). It is diag(r) W_1 diag(1/s) for a linear network. For other
// networks W_skip replaces W_1; without a skip path it is zero. Shape
// num_outputs x num_inputs. `weights` has NumWeights() entries.
Matrix LinearPart(const NetworkArchitecture& architecture,
                  const Vector& weights);

// Returns the constant that belongs to it: diag(r) b_1 of a linear network,
// zero without a bias. Only linear networks can be folded completely into the
// model. Others are a CHECK failure.
Vector ConstantPart(const NetworkArchitecture& architecture,
                    const Vector& weights);

}  // namespace pinode

#endif  // PINODE_NETWORK_NETWORK_ARCHITECTURE_H_
