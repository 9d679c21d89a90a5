// Constraints on coefficients, and the free unknowns that remain.

#ifndef PINODE_DISCOVER_COEFFICIENT_MAP_H_
#define PINODE_DISCOVER_COEFFICIENT_MAP_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/equation_options.h"

namespace pinode {

// The coefficients xi as a function of free unknowns g,
//
//   xi_j = factor_j g_{free_j}    or    xi_j = value_j (given),
//
// where g has signs of its own: sign_i g_i >= 0 if sign_i is not 0. Every
// solver of this layer works on g.
class CoefficientMap {
 public:
  // Creates the map. Returns false, with *map untouched, for an unknown name,
  // an entry that is not finite, a zero factor, a coefficient in two equalities
  // or given twice, or contradictory constraints. If all coefficients are
  // given, num_free() is 0.
  [[nodiscard]] static bool Create(
      const std::vector<std::string>& names,
      const std::vector<CoefficientConstraint>& constraints,
      CoefficientMap* map, std::string* error);

  int num_coefficients() const { return static_cast<int>(free_.size()); }
  int num_free() const { return static_cast<int>(signs_.size()); }

  // Free unknown of a coefficient; -1 if the coefficient is given.
  int free(int coefficient) const {
    return free_[static_cast<size_t>(coefficient)];
  }
  double factor(int coefficient) const { return factors_[coefficient]; }
  // Given value of a coefficient; 0 if it is not given.
  double value(int coefficient) const { return values_[coefficient]; }
  // Sign of each unknown: 1, -1 or 0 (either).
  const std::vector<int>& signs() const { return signs_; }

  // Returns xi from g.
  Vector Expand(const Vector& free) const;
  // Returns the coefficients that depend on these free unknowns, ascending,
  // without given ones.
  std::vector<int> ExpandSupport(const std::vector<int>& free_support) const;
  // Returns the free unknowns of the coefficients in `support`, ascending, each
  // once.
  std::vector<int> ReduceSupport(const std::vector<int>& support) const;

 private:
  std::vector<int> free_;
  Vector factors_;
  Vector values_;
  std::vector<int> signs_;
};

}  // namespace pinode

#endif  // PINODE_DISCOVER_COEFFICIENT_MAP_H_
