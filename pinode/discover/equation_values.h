// Values of an equation along its regression samples.

#ifndef PINODE_DISCOVER_EQUATION_VALUES_H_
#define PINODE_DISCOVER_EQUATION_VALUES_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/discovery.h"

namespace pinode {

struct EquationValues {
  // Values of sum_k xi_k f_k(q), one per sample.
  Vector sum;
  // Sum of the terms that depend on a feature, per feature; empty if there is
  // no such term.
  std::vector<Vector> parts;
};

// Evaluates `equation` at the rows of its sample_features. Returns false, with
// *error, if one of its bases is no function of its features.
[[nodiscard]] bool EvaluateAtSamples(const DiscoveredEquation& equation,
                                     EquationValues* values,
                                     std::string* error);

}  // namespace pinode

#endif  // PINODE_DISCOVER_EQUATION_VALUES_H_
