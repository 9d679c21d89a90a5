#include "pinode/study/terms/library_term.h"

#include <cmath>
#include <memory>
#include <utility>

#include "pinode/dynamics/library_law.h"

namespace pinode {
namespace {

// Powers of force, length and time.
struct Powers {
  double force = 0.0;
  double length = 0.0;
  double time = 0.0;
};

// Returns the powers of a feature; covariates count as pure numbers.
Powers FeaturePowers(const Feature& feature,
                     const std::vector<InputSpec>& inputs) {
  switch (feature.kind) {
    case Feature::Kind::kDisplacement:
    case Feature::Kind::kDeformation:
      return {0.0, 1.0, 0.0};
    case Feature::Kind::kVelocity:
    case Feature::Kind::kDeformationRate:
      return {0.0, 1.0, -1.0};
    case Feature::Kind::kTime:
      return {0.0, 0.0, 1.0};
    case Feature::Kind::kInput:
      switch (inputs[static_cast<size_t>(feature.input)].kind) {
        case InputSpec::Kind::kGroundAcceleration:
        case InputSpec::Kind::kPrescribedAcceleration:
          return {0.0, 1.0, -2.0};
        case InputSpec::Kind::kPrescribedVelocity:
          return {0.0, 1.0, -1.0};
        case InputSpec::Kind::kGroundDisplacement:
        case InputSpec::Kind::kPrescribedDisplacement:
          return {0.0, 1.0, 0.0};
        case InputSpec::Kind::kForce:
          return {1.0, 0.0, 0.0};
        case InputSpec::Kind::kCovariate:
        case InputSpec::Kind::kRecordSwitch:
          return {};
      }
  }
  return {};
}

// Finds p with f(2^powers_i q_i) = 2^p f(q) at several q; false if there is
// none.
bool ScalingPower(const LibraryFunction& function,
                  const std::vector<double>& powers, double* power) {
  const size_t size = powers.size();
  std::vector<double> q(size);
  std::vector<double> scaled(size);
  int count = 0;
  for (int trial = 0; trial < 12; ++trial) {
    for (size_t i = 0; i < size; ++i) {
      // Trial values have either sign and are never 0.
      q[i] = std::sin(1.7 * trial + 0.9 * static_cast<double>(i) + 0.3) +
             (trial % 2 == 0 ? 1.3 : -1.4);
      scaled[i] = q[i] * std::exp2(powers[i]);
    }
    const double before = function.Evaluate(q.data());
    const double ratio = function.Evaluate(scaled.data()) / before;
    if (before == 0.0 || !std::isfinite(before)) continue;
    if (!(ratio > 0.0) || !std::isfinite(ratio)) return false;
    const double here = std::log2(ratio);
    if (count > 0 && std::abs(here - *power) > 1e-9) return false;
    *power = here;
    ++count;
  }
  return count > 1;
}

bool Exists(const Feature& feature, const StructuralDynamics& dynamics) {
  const int n = dynamics.num_dofs();
  switch (feature.kind) {
    case Feature::Kind::kDisplacement:
    case Feature::Kind::kVelocity:
      return feature.a >= 0 && feature.a < n;
    case Feature::Kind::kDeformation:
    case Feature::Kind::kDeformationRate:
      return feature.a >= Feature::kGround && feature.a < n &&
             feature.b >= Feature::kGround && feature.b < n &&
             feature.a != feature.b;
    case Feature::Kind::kInput:
      return feature.input >= 0 && feature.input < dynamics.num_inputs();
    case Feature::Kind::kTime:
      break;
  }
  return true;
}

// Reads the functions of `spec` with the names of `features`.
bool ParseFunctions(const LibrarySpec& spec,
                    const std::vector<std::string>& names,
                    std::vector<LibraryFunction>* functions,
                    std::string* error) {
  functions->clear();
  for (const LibrarySpec::Coefficient& coefficient : spec.coefficients) {
    LibraryFunction function;
    if (!LibraryFunction::Parse(coefficient.basis, names, &function, error)) {
      *error = "'" + spec.name + "': " + *error;
      return false;
    }
    functions->push_back(std::move(function));
  }
  return true;
}

}  // namespace

std::string LibraryCoefficientUnit(const LibraryFunction& function,
                                   const std::vector<Feature>& features,
                                   const std::vector<InputSpec>& inputs,
                                   ActsAs acts_as, const UnitSystem& units) {
  Powers result = acts_as == ActsAs::kForce ? Powers{1.0, 0.0, 0.0}
                                            : Powers{0.0, 1.0, -2.0};
  std::vector<double> force, length, time;
  for (const Feature& feature : features) {
    const Powers powers = FeaturePowers(feature, inputs);
    force.push_back(powers.force);
    length.push_back(powers.length);
    time.push_back(powers.time);
  }
  Powers function_powers;
  if (ScalingPower(function, force, &function_powers.force) &&
      ScalingPower(function, length, &function_powers.length) &&
      ScalingPower(function, time, &function_powers.time)) {
    // Powers are rounded, because they come from a text such as "x[u1]^1.5".
    const auto rounded = [](double x) { return std::round(x * 1e6) / 1e6; };
    result.force -= rounded(function_powers.force);
    result.length -= rounded(function_powers.length);
    result.time -= rounded(function_powers.time);
  }
  return PowersUnitName(result.force, result.length, result.time, units);
}

bool OutputColumn(const StructuralModel& model, const std::string& text,
                  Vector* column) {
  *column = Vector::Zero(model.num_dofs());
  const int dof = model.DofIndex(text);
  if (dof >= 0) {
    (*column)[dof] = 1.0;
    return true;
  }
  for (size_t dash = text.find('-'); dash != std::string::npos;
       dash = text.find('-', dash + 1)) {
    const int a = model.DofIndex(text.substr(0, dash));
    const int b = model.DofIndex(text.substr(dash + 1));
    if (a < 0 || b < 0 || a == b) continue;
    (*column)[a] = 1.0;
    (*column)[b] = -1.0;
    return true;
  }
  return false;
}

bool MakeLibraryTerm(const LibrarySpec& spec,
                     const StructuralDynamics& dynamics,
                     const UnitSystem& units, LawTerm* term,
                     std::string* error) {
  const StructuralModel& model = dynamics.model();
  if (spec.coefficients.empty() || spec.features.empty()) {
    *error = "'" + spec.name + "' has no terms or no inputs, expected both";
    return false;
  }
  Vector column;
  if (!OutputColumn(model, spec.output, &column)) {
    *error = "'" + spec.name + "': '" + spec.output +
             "' is neither a DOF of the model nor a pair such as \"a-b\"";
    return false;
  }
  std::vector<std::string> input_names;
  for (const InputSpec& input : dynamics.inputs()) {
    input_names.push_back(input.name);
  }
  std::vector<std::string> names;
  for (const Feature& feature : spec.features) {
    if (!Exists(feature, dynamics)) {
      *error =
          "'" + spec.name + "' uses a quantity that the model does not have";
      return false;
    }
    names.push_back(feature.Name(model.dof_names, input_names));
  }
  std::vector<LibraryFunction> functions;
  if (!ParseFunctions(spec, names, &functions, error)) return false;

  LawTerm result;
  std::vector<std::string> used;
  for (size_t f = 0; f < spec.features.size(); ++f) {
    bool looked_at = false;
    for (const LibraryFunction& function : functions) {
      looked_at = looked_at || function.DependsOn(static_cast<int>(f));
    }
    if (!looked_at) continue;
    used.push_back(names[f]);
    result.features.push_back(spec.features[f]);
  }
  // A constant alone depends on no feature; a library has at least one input.
  if (used.empty()) {
    used = {names[0]};
    result.features = {spec.features[0]};
  }
  if (static_cast<int>(used.size()) > LibraryLaw::kMaxFeatures) {
    *error = "'" + spec.name + "' has " + std::to_string(used.size()) +
             " inputs, expected at most " +
             std::to_string(LibraryLaw::kMaxFeatures);
    return false;
  }
  if (!ParseFunctions(spec, used, &functions, error)) return false;
  result.name = spec.name;
  result.type = "library";
  result.acts_as = spec.acts_as;
  result.outputs = column;
  result.parameters.name = spec.name;
  for (size_t k = 0; k < functions.size(); ++k) {
    Parameter parameter = spec.coefficients[k].parameter;
    parameter.name = spec.name + "." + functions[k].text();
    parameter.unit = LibraryCoefficientUnit(
        functions[k], result.features, dynamics.inputs(), spec.acts_as, units);
    result.parameters.parameters.push_back(std::move(parameter));
  }
  const int num_features = static_cast<int>(used.size());
  result.law = std::make_shared<LibraryLaw>(num_features, std::move(functions));
  *term = std::move(result);
  return true;
}

}  // namespace pinode
