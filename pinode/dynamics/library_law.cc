#include "pinode/dynamics/library_law.h"

#include <ceres/jet.h>

#include <algorithm>
#include <array>
#include <utility>

#include "pinode/base/logging.h"

namespace pinode {

bool LibraryLaw::AreValid(int num_features,
                          const std::vector<LibraryFunction>& functions,
                          std::string* error) {
  if (num_features < 1 || num_features > kMaxFeatures) {
    *error = std::to_string(num_features) + " features, expected 1 to " +
             std::to_string(kMaxFeatures);
    return false;
  }
  if (functions.empty()) {
    *error = "a library term needs at least one function";
    return false;
  }
  for (const LibraryFunction& function : functions) {
    if (function.num_features() != num_features) {
      *error = "'" + function.text() + "' is of other features than its term";
      return false;
    }
  }
  return true;
}

LibraryLaw::LibraryLaw(int num_features, std::vector<LibraryFunction> functions)
    : num_features_(num_features), functions_(std::move(functions)) {
  std::string error;
  CHECK(AreValid(num_features_, functions_, &error)) << error;
}

void LibraryLaw::Evaluate(const double* features, const double* /*internal*/,
                          const double* parameters, double* result) const {
  result[0] = 0.0;
  for (size_t k = 0; k < functions_.size(); ++k) {
    if (parameters[k] == 0.0) continue;
    result[0] += parameters[k] * functions_[k].Evaluate(features);
  }
}

void LibraryLaw::Evaluate(const WideJet* features, const WideJet* /*internal*/,
                          const WideJet* parameters, WideJet* result) const {
  std::array<double, kMaxFeatures> values;
  std::array<double, kMaxFeatures> gradient;
  for (int i = 0; i < num_features_; ++i) {
    values[static_cast<size_t>(i)] = features[i].a;
  }
  result[0] = WideJet(0.0);
  for (size_t k = 0; k < functions_.size(); ++k) {
    // The chain rule: a library function knows its own gradient.
    WideJet value(functions_[k].Linearize(values.data(), gradient.data()));
    for (int i = 0; i < num_features_; ++i) {
      const double slope = gradient[static_cast<size_t>(i)];
      if (slope != 0.0) value.v += slope * features[i].v;
    }
    result[0] += parameters[k] * value;
  }
}

void LibraryLaw::Linearize(const double* features, const double* /*internal*/,
                           const double* parameters, double* result,
                           double* jacobian) const {
  std::array<double, kMaxFeatures> gradient;
  std::fill(jacobian, jacobian + num_features_, 0.0);
  result[0] = 0.0;
  for (size_t k = 0; k < functions_.size(); ++k) {
    const double value = functions_[k].Linearize(features, gradient.data());
    for (int i = 0; i < num_features_; ++i) {
      const double slope = gradient[static_cast<size_t>(i)];
      // A coefficient of 0 keeps an infinite slope out.
      if (parameters[k] != 0.0 && slope != 0.0) {
        jacobian[i] += parameters[k] * slope;
      }
    }
    jacobian[num_features_ + static_cast<int>(k)] = value;
    result[0] += parameters[k] * value;
  }
}

}  // namespace pinode
