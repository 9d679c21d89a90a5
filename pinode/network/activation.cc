#include "pinode/network/activation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/base/types.h"

namespace pinode {
namespace {

constexpr std::array<std::pair<Activation, const char*>, 7> kNames = {{
    {Activation::kTanh, "tanh"},
    {Activation::kSigmoid, "sigmoid"},
    {Activation::kRelu, "relu"},
    {Activation::kLeakyRelu, "leaky_relu"},
    {Activation::kSoftplus, "softplus"},
    {Activation::kSine, "sine"},
    {Activation::kIdentity, "identity"},
}};

// Number of entries in a few vector registers. The tail of a layer is padded,
// so that every entry uses the same arithmetic.
constexpr int kBlock = 8;
using Block = Eigen::Array<double, kBlock, 1>;

// Returns tanh. The library's tanh is scalar and takes longer than the rest of
// a small network. Near zero: Lambert's continued fraction x/(1 + x^2/(3 +
// x^2/(5 + ...))) cut off after 15, whose relative error is below 1e-17 for |x|
// < 0.625. Elsewhere: (exp(2|x|) - 1)/(exp(2|x|) + 1). Within 3 ulp of the
// exact value. Divisions take longest, so the choice between the two comes
// before the division.
Block Tanh(const Block& x) {
  const Block s = x * x;
  const Block numerator =
      x * (2027025.0 + s * (270270.0 + s * (6930.0 + s * 36.0)));
  const Block denominator =
      2027025.0 + s * (945945.0 + s * (51975.0 + s * (630.0 + s)));
  // The bound keeps exp finite and changes no result: tanh(20) rounds to 1.
  const Block exponential = (2.0 * x.abs().min(20.0)).exp();
  // A loop, because Eigen does not vectorise its select(). NaN fails the
  // comparison and is that of `numerator`.
  Block above;
  Block below;
  for (int i = 0; i < kBlock; ++i) {
    const bool near_zero = !(std::abs(x[i]) >= 0.625);
    above[i] =
        near_zero ? numerator[i] : std::copysign(exponential[i] - 1.0, x[i]);
    below[i] = near_zero ? denominator[i] : exponential[i] + 1.0;
  }
  return above / below;
}

// Calls tanh(scale * z) block by block: write(i, count, block).
template <typename Write>
void ForEachTanhBlock(double scale, int size, const double* z, Write write) {
  for (int i = 0; i < size; i += kBlock) {
    const int count = std::min(kBlock, size - i);
    if (count == kBlock) {
      write(i, count, Tanh(scale * Eigen::Map<const Block>(z + i)));
    } else {
      Block padded = Block::Zero();
      std::copy(z + i, z + i + count, padded.data());
      write(i, count, Tanh(scale * padded));
    }
  }
}

void Store(const Block& block, int count, double* to) {
  if (count == kBlock) {
    std::copy(block.data(), block.data() + kBlock, to);
  } else {
    std::copy(block.data(), block.data() + count, to);
  }
}

double Softplus(double z) {
  return std::max(z, 0.0) + std::log1p(std::exp(-std::abs(z)));
}

// Calls f(z, &value, &slope, &curvature) for every entry.
template <typename Function>
void ApplyScalar(int size, const double* z, double* value, double* slope,
                 double* curvature, Function function) {
  for (int i = 0; i < size; ++i) {
    double f = 0.0;
    double df = 0.0;
    double ddf = 0.0;
    function(z[i], &f, &df, &ddf);
    value[i] = f;
    if (slope != nullptr) slope[i] = df;
    if (curvature != nullptr) curvature[i] = ddf;
  }
}

}  // namespace

const char* ActivationName(Activation activation) {
  for (const auto& [candidate, name] : kNames) {
    if (candidate == activation) return name;
  }
  LOG(FATAL) << "Not an activation: " << static_cast<int>(activation);
  return "";
}

bool ParseActivation(std::string_view name, Activation* activation,
                     std::string* error) {
  CHECK(activation != nullptr);
  CHECK(error != nullptr);
  for (const auto& [candidate, candidate_name] : kNames) {
    if (name == candidate_name) {
      *activation = candidate;
      return true;
    }
  }
  std::vector<std::string> known;
  for (const auto& entry : kNames) known.emplace_back(entry.second);
  *error = "unknown activation '" + std::string(name) + "'" +
           NameHint(std::string(name), known);
  return false;
}

void ApplyActivation(Activation activation, int size, const double* z,
                     double* value, double* slope, double* curvature) {
  switch (activation) {
    case Activation::kTanh:
      ForEachTanhBlock(1.0, size, z, [&](int i, int count, const Block& f) {
        Store(f, count, value + i);
        const Block df = 1.0 - f * f;
        if (slope != nullptr) Store(df, count, slope + i);
        if (curvature != nullptr) Store(-2.0 * f * df, count, curvature + i);
      });
      return;
    case Activation::kSigmoid:
      // 1 / (1 + exp(-z)) = (1 + tanh(z / 2)) / 2.
      ForEachTanhBlock(0.5, size, z, [&](int i, int count, const Block& t) {
        Store(0.5 + 0.5 * t, count, value + i);
        const Block df = 0.25 * (1.0 - t * t);
        if (slope != nullptr) Store(df, count, slope + i);
        if (curvature != nullptr) Store(-t * df, count, curvature + i);
      });
      return;
    case Activation::kRelu:
    case Activation::kLeakyRelu: {
      const double below =
          activation == Activation::kRelu ? 0.0 : kLeakyReluSlope;
      ApplyScalar(size, z, value, slope, curvature,
                  [below](double x, double* f, double* df, double*) {
                    *df = x <= 0.0 ? below : 1.0;
                    *f = *df * x;
                  });
      return;
    }
    case Activation::kSoftplus:
      ForEachTanhBlock(0.5, size, z, [&](int i, int count, const Block& t) {
        // `value` may be `z`, so the value is the last to be written.
        if (slope != nullptr) Store(0.5 + 0.5 * t, count, slope + i);
        if (curvature != nullptr) {
          Store(0.25 * (1.0 - t * t), count, curvature + i);
        }
        std::transform(z + i, z + i + count, value + i, Softplus);
      });
      return;
    case Activation::kSine:
      ApplyScalar(size, z, value, slope, curvature,
                  [](double x, double* f, double* df, double* ddf) {
                    *f = std::sin(x);
                    *df = std::cos(x);
                    *ddf = -*f;
                  });
      return;
    case Activation::kIdentity:
      ApplyScalar(size, z, value, slope, curvature,
                  [](double x, double* f, double* df, double*) {
                    *f = x;
                    *df = 1.0;
                  });
      return;
  }
  LOG(FATAL) << "Not an activation: " << static_cast<int>(activation);
}

}  // namespace pinode
