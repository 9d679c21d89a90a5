#include "pinode/network/initialize_weights.h"

#include <cmath>
#include <random>
#include <string>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/network/activation.h"

namespace pinode {
namespace {

// Standard normal numbers by Box and Muller. std::normal_distribution gives
// different numbers with every standard library; the engine does not.
class NormalGenerator {
 public:
  explicit NormalGenerator(std::uint64_t seed) : engine_(seed) {}

  double operator()() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2.0 * std::log(Uniform()));
    const double angle = kTwoPi * Uniform();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
  }

 private:
  // In (0, 1]: the upper 53 bits, plus one.
  double Uniform() {
    return std::ldexp(static_cast<double>((engine_() >> 11) + 1), -53);
  }

  std::mt19937_64 engine_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

double HiddenDeviation(Activation activation, const WeightLayout::Part& part) {
  switch (activation) {
    case Activation::kRelu:
      return std::sqrt(2.0 / part.cols);
    case Activation::kLeakyRelu:
      return std::sqrt(2.0 /
                       ((1.0 + kLeakyReluSlope * kLeakyReluSlope) * part.cols));
    case Activation::kTanh:
    case Activation::kSigmoid:
    case Activation::kSoftplus:
    case Activation::kSine:
    case Activation::kIdentity:
      break;
  }
  return std::sqrt(2.0 / (part.rows + part.cols));
}

}  // namespace

Vector InitializeWeights(const NetworkArchitecture& architecture,
                         std::uint64_t seed, bool zero_last_layer) {
  std::string error;
  CHECK(architecture.IsValid(&error)) << error;
  const WeightLayout layout = architecture.Layout();
  Vector weights = Vector::Zero(layout.size);
  NormalGenerator normal(seed);
  const auto draw = [&](const WeightLayout::Part& part, double deviation) {
    for (int i = 0; i < part.size(); ++i) {
      weights[part.offset + i] = deviation * normal();
    }
  };
  const int last = layout.num_layers() - 1;
  for (int l = 0; l < last; ++l) {
    const double deviation =
        HiddenDeviation(architecture.activation, layout.weights[l]);
    if (l == 0) {
      const WeightLayout::Part& part = layout.weights[0];
      const double single = HiddenDeviation(architecture.activation, {0, 1, 1});
      for (int i = 0; i < part.rows; ++i) {
        weights[part.offset + (i % part.cols) * part.rows + i] =
            single * normal();
      }
    } else {
      draw(layout.weights[l], deviation);
    }
    draw(layout.biases[l], deviation);
  }
  if (!zero_last_layer) {
    const WeightLayout::Part& part = layout.weights[last];
    draw(part, 0.1 * std::sqrt(2.0 / (part.rows + part.cols)));
  }
  return weights;
}

}  // namespace pinode
