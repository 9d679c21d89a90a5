// What an equation says along the samples that it was regressed on.

#ifndef PINODE_DISCOVER_EQUATION_VALUES_H_
#define PINODE_DISCOVER_EQUATION_VALUES_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/discovery.h"

namespace pinode {

struct EquationValues {
  // sum_k xi_k f_k(q), one value a sample.
  Vector sum;
  // By feature: the sum of the terms that depend on it; empty where none does.
  std::vector<Vector> parts;
};

// `equation` at the rows of its sample_features. False, with *error, where one
// of its bases is no function of its features.
[[nodiscard]] bool EvaluateAtSamples(const DiscoveredEquation& equation,
                                     EquationValues* values,
                                     std::string* error);

}  // namespace pinode

#endif  // PINODE_DISCOVER_EQUATION_VALUES_H_
