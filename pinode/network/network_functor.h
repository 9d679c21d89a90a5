// A network on any scalar type, for automatic differentiation.
//
// Plain loops follow the equations of network_architecture.h. They allocate
// memory and are slower than class Network. They check its hand-written
// derivatives.

#ifndef PINODE_NETWORK_NETWORK_FUNCTOR_H_
#define PINODE_NETWORK_NETWORK_FUNCTOR_H_

#include <cmath>
#include <vector>

#include "pinode/network/activation.h"
#include "pinode/network/network_architecture.h"

namespace pinode {

template <typename T>
T EvaluateActivation(Activation activation, const T& z) {
  using std::exp;
  using std::log1p;
  using std::sin;
  using std::tanh;
  switch (activation) {
    case Activation::kTanh:
      return tanh(z);
    case Activation::kSigmoid:
      // 1 / (1 + exp(-z)), without overflow in its derivatives.
      return 0.5 * (1.0 + tanh(0.5 * z));
    case Activation::kRelu:
      return z <= T(0.0) ? T(0.0) : z;  // NaN stays NaN.
    case Activation::kLeakyRelu:
      return z <= T(0.0) ? kLeakyReluSlope * z : z;
    case Activation::kSoftplus:
      // log(1 + exp(z)), without overflow.
      return z > T(0.0) ? z + log1p(exp(-z)) : log1p(exp(z));
    case Activation::kSine:
      return sin(z);
    case Activation::kIdentity:
      return z;
  }
  return z;
}

// Returns the first derivative of EvaluateActivation.
template <typename T>
T EvaluateActivationSlope(Activation activation, const T& z) {
  using std::cos;
  using std::tanh;
  switch (activation) {
    case Activation::kTanh: {
      const T t = tanh(z);
      return 1.0 - t * t;
    }
    case Activation::kSigmoid: {
      const T t = tanh(0.5 * z);
      return 0.25 * (1.0 - t * t);
    }
    case Activation::kRelu:
      return z <= T(0.0) ? T(0.0) : T(1.0);
    case Activation::kLeakyRelu:
      return z <= T(0.0) ? T(kLeakyReluSlope) : T(1.0);
    case Activation::kSoftplus:
      return 0.5 * (1.0 + tanh(0.5 * z));
    case Activation::kSine:
      return cos(z);
    case Activation::kIdentity:
      return T(1.0);
  }
  return T(1.0);
}

// Computes y = g(q), or the gauged y(q). `q` has num_inputs entries, `weights`
// has NumWeights() in the order of WeightLayout, `y` has num_outputs.
template <typename T>
void EvaluateNetwork(const NetworkArchitecture& architecture, const T* q,
                     const T* weights, T* y) {
  const WeightLayout layout = architecture.Layout();
  const int num_layers = layout.num_layers();

  // W_l x + b_l, or W_l x alone.
  const auto apply_layer = [&](int l, bool with_bias, const std::vector<T>& x) {
    const WeightLayout::Part& w = layout.weights[l];
    const WeightLayout::Part& b = layout.biases[l];
    std::vector<T> z(w.rows, T(0.0));
    for (int i = 0; i < w.rows; ++i) {
      if (with_bias && b.cols > 0) z[i] = weights[b.offset + i];
      for (int j = 0; j < w.cols; ++j) {
        z[i] += weights[w.offset + j * w.rows + i] * x[j];
      }
    }
    return z;
  };

  std::vector<T> scaled(q, q + architecture.num_inputs);
  if (architecture.input_scale.size() != 0) {
    for (int j = 0; j < architecture.num_inputs; ++j) {
      scaled[j] = scaled[j] / architecture.input_scale[j];
    }
  }

  std::vector<T> a = scaled;
  // The same layers at rest, and their derivative in the direction q.
  std::vector<T> rest(architecture.num_inputs, T(0.0));
  std::vector<T> rate = scaled;
  for (int l = 0; l + 1 < num_layers; ++l) {
    a = apply_layer(l, true, a);
    for (T& z : a) z = EvaluateActivation(architecture.activation, z);
    if (!architecture.gauge) continue;
    rest = apply_layer(l, true, rest);
    rate = apply_layer(l, false, rate);
    for (size_t i = 0; i < rest.size(); ++i) {
      rate[i] *= EvaluateActivationSlope(architecture.activation, rest[i]);
      rest[i] = EvaluateActivation(architecture.activation, rest[i]);
    }
  }
  if (architecture.gauge) {
    for (size_t i = 0; i < a.size(); ++i) a[i] = a[i] - rest[i] - rate[i];
  }
  const std::vector<T> output = apply_layer(num_layers - 1, true, a);
  for (int i = 0; i < architecture.num_outputs; ++i) {
    y[i] = output[i];
    if (!architecture.HasSkipPath()) continue;
    for (int j = 0; j < architecture.num_inputs; ++j) {
      y[i] +=
          weights[layout.skip.offset + j * layout.skip.rows + i] * scaled[j];
    }
  }
  for (int i = 0; i < architecture.output_scale.size(); ++i) {
    y[i] *= architecture.output_scale[i];
  }
}

}  // namespace pinode

#endif  // PINODE_NETWORK_NETWORK_FUNCTOR_H_
