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
  for (const LibraryFunction& function : functions_) {
    num_switches_ += function.num_switches();
  }
}

void LibraryLaw::Switches(const double* features, double* values) const {
  for (const LibraryFunction& function : functions_) {
    function.Switches(features, values);
    values += function.num_switches();
  }
}

void LibraryLaw::SwitchGradient(int j, const double* features,
                                double* gradient) const {
  for (const LibraryFunction& function : functions_) {
    if (j < function.num_switches()) {
      function.SwitchGradient(j, features, gradient);
      return;
    }
    j -= function.num_switches();
  }
}

void LibraryLaw::Evaluate(const double* features, const double* internal,
                          const double* parameters, double* result) const {
  EvaluateOn(nullptr, features, internal, parameters, result);
}

void LibraryLaw::EvaluateOn(const char* branches, const double* features,
                            const double* /*internal*/,
                            const double* parameters, double* result) const {
  result[0] = 0.0;
  for (size_t k = 0; k < functions_.size(); ++k) {
    if (parameters[k] != 0.0) {
      result[0] += parameters[k] * functions_[k].Evaluate(features, branches);
    }
    if (branches != nullptr) branches += functions_[k].num_switches();
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

void LibraryLaw::Linearize(const double* features, const double* internal,
                           const double* parameters, double* result,
                           double* jacobian) const {
  LinearizeOn(nullptr, features, internal, parameters, result, jacobian);
}

void LibraryLaw::LinearizeOn(const char* branches, const double* features,
                             const double* /*internal*/,
                             const double* parameters, double* result,
                             double* jacobian) const {
  std::array<double, kMaxFeatures> gradient;
  std::fill(jacobian, jacobian + num_features_, 0.0);
  result[0] = 0.0;
  for (size_t k = 0; k < functions_.size(); ++k) {
    const double value =
        functions_[k].Linearize(features, gradient.data(), branches);
    if (branches != nullptr) branches += functions_[k].num_switches();
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
