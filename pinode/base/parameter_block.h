// Named unknowns. An identification changes only values that are stored here.
// Unknowns may follow others: one unknown that is used several times.

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
  // Current value, and the closed interval [lower, upper] that it is kept in.
  double value = 0.0;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  // Mean and standard deviation of a Gaussian prior. An infinite standard
  // deviation means: no prior.
  double prior_mean = 0.0;
  double prior_sigma = std::numeric_limits<double>::infinity();
  // False: the value is known, and the fit does not change it.
  bool free = true;
  // Name of another parameter that this one follows. Its value is `tie_factor`
  // times the other's, both in the model's units. A free parameter follows
  // nothing, so set `free` to false. Empty: not tied.
  std::string tie = {};
  double tie_factor = 1.0;

  // True if the parameter follows another one.
  bool IsTied() const { return !free && !tie.empty(); }
  // True if the prior has a finite standard deviation.
  bool HasPrior() const {
    return prior_sigma < std::numeric_limits<double>::infinity();
  }
};

// Unknowns that belong to one term of the model. They are contiguous in the
// vector theta of all parameters. Named parameters, such as stiffness
// corrections and constants of elements, are listed one by one. Network weights
// are many and have indexed names, `<block>[i]`.
struct ParameterBlock {
  // Name of the term, and its parameters.
  std::string name;
  std::vector<Parameter> parameters;
  // True for entries with a prior of mean zero whose width the fit chooses
  // (MacKay 1992): the nonlinear weights of a network. Empty for none, or as
  // long as `parameters`.
  std::vector<bool> decays;
  // False for network weights: reports do not list them one by one.
  bool named = true;

  int size() const { return static_cast<int>(parameters.size()); }

  // Current values and their replacement: one entry per parameter, in its own
  // unit. SetValues() does not check bounds.
  Vector Values() const;
  void SetValues(const Vector& values);

  // Checks that values are finite and inside their bounds, that lower < upper,
  // that prior_sigma > 0, and that names are unique. On failure returns false
  // and names in *error the parameter and the violated rule.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// A parameter that is `factor` times another one. The indices count over all
// blocks.
struct ParameterTie {
  int parameter = -1;
  int source = -1;
  double factor = 1.0;
};

// Returns the ties of these blocks, see Parameter::tie. A tie to a name that no
// block has, or to a parameter that is itself tied, is left out: the parameter
// then stays at its value. AreTiesValid() refuses both.
std::vector<ParameterTie> FindTies(
    const std::vector<const ParameterBlock*>& blocks);

// Checks that each tied parameter names a parameter of these blocks that is
// free or fixed by itself, and that the factor is finite and not zero. On
// failure returns false. *error then says what to do, and *parameter is the
// name of the tied parameter.
[[nodiscard]] bool AreTiesValid(
    const std::vector<const ParameterBlock*>& blocks, std::string* parameter,
    std::string* error);

// Sets the tied entries of `values`, which has one entry per parameter.
template <typename T>
void ApplyTies(const std::vector<ParameterTie>& ties, T* values) {
  for (const ParameterTie& tie : ties) {
    values[tie.parameter] = tie.factor * values[tie.source];
  }
}

}  // namespace pinode

#endif  // PINODE_BASE_PARAMETER_BLOCK_H_
