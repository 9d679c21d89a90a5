// Regression of outputs on candidate functions, under constraints.

#ifndef PINODE_DISCOVER_REGRESSION_PROBLEM_H_
#define PINODE_DISCOVER_REGRESSION_PROBLEM_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/coefficient_map.h"

namespace pinode {

// Output y = Theta xi + noise, with candidates of its own.
struct RegressionOutput {
  std::string name;
  std::vector<std::string> candidates;
  Matrix theta;  // samples x candidates
  Vector y;      // samples
  // Divisor of the residuals: the noise's standard deviation, up to a factor
  // that all outputs share. In y's unit.
  double sigma = 1.0;
};

// Consecutive samples of one record.
struct TimeBlock {
  Eigen::Index begin = 0;
  Eigen::Index count = 0;
};

// Outputs at the same samples. Put several outputs into one problem only if a
// constraint binds their coefficients. Otherwise solve each on its own, with
// its own penalty.
struct RegressionProblem {
  std::vector<RegressionOutput> outputs;
  // First sample of each record, beginning with 0; empty: one record.
  std::vector<Eigen::Index> record_starts;
  std::vector<CoefficientConstraint> constraints;

  Eigen::Index num_samples() const {
    return outputs.empty() ? 0 : outputs[0].y.size();
  }
  // Number of coefficients over all outputs.
  int num_coefficients() const;
  // Returns one name for each candidate of each output, in their order: the
  // candidate if there is one output, else "output: candidate".
  std::vector<std::string> CoefficientNames() const;

  // Checks sizes, names, finite entries, records and constraints. On failure
  // *error names the output or constraint and what was expected. Passes the map
  // of the coefficients if `map` is not null.
  [[nodiscard]] bool IsValid(std::string* error,
                             CoefficientMap* map = nullptr) const;
};

// Cuts the records into about `num_blocks` blocks of about the same length (at
// least one per record), in their order. No block reaches across two records.
std::vector<TimeBlock> DivideIntoBlocks(const RegressionProblem& problem,
                                        int num_blocks);

}  // namespace pinode

#endif  // PINODE_DISCOVER_REGRESSION_PROBLEM_H_
