#include "pinode/discover/equation_values.h"

#include <utility>

#include "pinode/dynamics/library_function.h"

namespace pinode {

bool EvaluateAtSamples(const DiscoveredEquation& equation,
                       EquationValues* values, std::string* error) {
  const Eigen::Index samples = equation.sample_features.rows();
  const size_t num_features = equation.feature_names.size();
  if (equation.sample_features.cols() !=
      static_cast<Eigen::Index>(num_features)) {
    *error = "equation of '" + equation.output +
             "': its samples are not those of its features";
    return false;
  }
  EquationValues result;
  result.sum = Vector::Zero(samples);
  result.parts.resize(num_features);
  for (const DiscoveredTerm& term : equation.terms) {
    LibraryFunction function;
    if (!LibraryFunction::Parse(term.basis, equation.feature_names, &function,
                                error)) {
      return false;
    }
    Vector of_term(samples);
    for (Eigen::Index i = 0; i < samples; ++i) {
      const Vector at = equation.sample_features.row(i).transpose();
      of_term[i] = term.coefficient * function.Evaluate(at.data());
    }
    result.sum += of_term;
    for (size_t f = 0; f < num_features; ++f) {
      if (!function.DependsOn(static_cast<int>(f))) continue;
      if (result.parts[f].size() == 0) result.parts[f] = Vector::Zero(samples);
      result.parts[f] += of_term;
    }
  }
  *values = std::move(result);
  return true;
}

}  // namespace pinode
