#include "pinode/network/network_architecture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// num_inputs, hidden widths, num_outputs.
std::vector<int> LayerWidths(const NetworkArchitecture& architecture) {
  std::vector<int> widths = {architecture.num_inputs};
  widths.insert(widths.end(), architecture.hidden_widths.begin(),
                architecture.hidden_widths.end());
  widths.push_back(architecture.num_outputs);
  return widths;
}

// Returns true if `scale` is empty or has `size` positive numbers.
bool IsScale(const Vector& scale, const char* key, int size, const char* of,
             std::string* error) {
  if (scale.size() != 0 && scale.size() != size) {
    *error = std::string(key) + " has " + std::to_string(scale.size()) +
             " entries, expected one for each of the " + std::to_string(size) +
             " " + of;
    return false;
  }
  for (Eigen::Index i = 0; i < scale.size(); ++i) {
    if (!(scale[i] > 0.0) || !std::isfinite(scale[i])) {
      *error = std::string(key) + "[" + std::to_string(i) + "] is " +
               FormatNumber(scale[i]) + ", expected a positive finite number";
      return false;
    }
  }
  return true;
}

}  // namespace

bool NetworkArchitecture::IsValid(std::string* error) const {
  CHECK(error != nullptr);
  if (num_inputs < 1) {
    *error =
        "num_inputs is " + std::to_string(num_inputs) + ", expected at least 1";
    return false;
  }
  if (num_outputs < 1) {
    *error = "num_outputs is " + std::to_string(num_outputs) +
             ", expected at least 1";
    return false;
  }
  for (const int width : hidden_widths) {
    if (width < 1) {
      *error = "a hidden layer has width " + std::to_string(width) +
               ", expected at least 1";
      return false;
    }
  }
  if (!IsScale(input_scale, "input_scale", num_inputs, "inputs", error) ||
      !IsScale(output_scale, "output_scale", num_outputs, "outputs", error)) {
    return false;
  }
  if (gauge && IsLinear()) {
    *error =
        "gauge is true without hidden layers: nothing is left of a linear "
        "network, expected at least one hidden layer or gauge = false";
    return false;
  }
  if (gauge && skip) {
    *error =
        "gauge and skip are both true: the gauge removes the skip path, "
        "expected skip = false";
    return false;
  }
  const std::vector<int> widths = LayerWidths(*this);
  std::int64_t count = 0;
  for (size_t l = 1; l < widths.size(); ++l) {
    count += widths[l] * (std::int64_t{widths[l - 1]} + 1);
    if (count > std::numeric_limits<int>::max() / 2) break;
  }
  count += std::int64_t{num_outputs} * num_inputs;
  if (count > std::numeric_limits<int>::max() / 2) {
    *error = "the layers have more than " +
             std::to_string(std::numeric_limits<int>::max() / 2) +
             " weights, expected a smaller network";
    return false;
  }
  return true;
}

WeightLayout NetworkArchitecture::Layout() const {
  const std::vector<int> widths = LayerWidths(*this);
  const int num_layers = static_cast<int>(widths.size()) - 1;
  WeightLayout layout;
  for (int l = 0; l < num_layers; ++l) {
    layout.weights.push_back({layout.size, widths[l + 1], widths[l]});
    layout.size += layout.weights.back().size();
    const bool has_bias = bias && !(gauge && l + 1 == num_layers);
    layout.biases.push_back({layout.size, widths[l + 1], has_bias ? 1 : 0});
    layout.size += layout.biases.back().size();
  }
  if (HasSkipPath()) layout.skip = {layout.size, num_outputs, num_inputs};
  layout.size += layout.skip.size();
  return layout;
}

std::vector<bool> NetworkArchitecture::NonlinearWeights() const {
  const WeightLayout layout = Layout();
  std::vector<bool> nonlinear(layout.size, false);
  if (IsLinear()) return nonlinear;
  // W_L is the last of them.
  std::fill_n(nonlinear.begin(), layout.biases.back().offset, true);
  return nonlinear;
}

Matrix LinearPart(const NetworkArchitecture& architecture,
                  const Vector& weights) {
  const WeightLayout layout = architecture.Layout();
  CHECK_EQ(weights.size(), layout.size);
  const WeightLayout::Part& part =
      architecture.IsLinear() ? layout.weights.front() : layout.skip;
  if (part.size() == 0) {
    return Matrix::Zero(architecture.num_outputs, architecture.num_inputs);
  }
  Matrix linear = Eigen::Map<const Matrix>(weights.data() + part.offset,
                                           part.rows, part.cols);
  if (architecture.input_scale.size() != 0) {
    linear *= architecture.input_scale.cwiseInverse().asDiagonal();
  }
  if (architecture.output_scale.size() != 0) {
    linear = architecture.output_scale.asDiagonal() * linear;
  }
  return linear;
}

Vector ConstantPart(const NetworkArchitecture& architecture,
                    const Vector& weights) {
  CHECK(architecture.IsLinear())
      << "Only a network without hidden layers has a constant to fold; "
         "evaluate the others at rest.";
  const WeightLayout layout = architecture.Layout();
  CHECK_EQ(weights.size(), layout.size);
  const WeightLayout::Part& part = layout.biases.back();
  if (part.size() == 0) return Vector::Zero(architecture.num_outputs);
  Vector constant = weights.segment(part.offset, part.size());
  if (architecture.output_scale.size() != 0) {
    constant.array() *= architecture.output_scale.array();
  }
  return constant;
}

}  // namespace pinode
