// Named unknowns. Everything that an identification may change is stored in
// them.

#ifndef PINODE_BASE_PARAMETER_BLOCK_H_
#define PINODE_BASE_PARAMETER_BLOCK_H_

#include <limits>
#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// One scalar unknown with a name that an engineer understands.
struct Parameter {
  // Name, unique within a model, such as "k1", "spring.cubic" or "gain.a1".
  std::string name;
  // Unit of `value` and of all other members. "1" for a dimensionless number.
  std::string unit = "1";
  double value = 0.0;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  // Gaussian prior. An infinite standard deviation means: no prior.
  double prior_mean = 0.0;
  double prior_sigma = std::numeric_limits<double>::infinity();
  bool free = true;

  bool HasPrior() const {
    return prior_sigma < std::numeric_limits<double>::infinity();
  }
};

// A group of unknowns that belong to one term of the model. They are contiguous
// in the flat parameter vector theta. Named parameters (stiffness corrections,
// element constants) are listed one by one. Network weights are many and have
// indexed names, `<block>[i]`.
struct ParameterBlock {
  std::string name;
  std::vector<Parameter> parameters;
  // True for entries that the evidence may shrink towards zero (the nonlinear
  // weights of a network). Empty, or as long as `parameters`.
  std::vector<bool> decays;
  // False for network weights: reports do not list them one by one.
  bool named = true;

  int size() const { return static_cast<int>(parameters.size()); }

  // Current values, one per parameter.
  Vector Values() const;
  void SetValues(const Vector& values);

  // Checks names, bounds (lower < upper, value inside) and priors. On failure
  // returns false and names in *error the parameter and the violated rule.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

}  // namespace pinode

#endif  // PINODE_BASE_PARAMETER_BLOCK_H_
