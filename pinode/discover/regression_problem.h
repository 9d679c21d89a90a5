// What is regressed: outputs on candidate functions, under conditions.

#ifndef PINODE_DISCOVER_REGRESSION_PROBLEM_H_
#define PINODE_DISCOVER_REGRESSION_PROBLEM_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/discover/coefficient_map.h"

namespace pinode {

// One output, y = Theta xi + noise, on candidates of its own.
struct RegressionOutput {
  std::string name;
  std::vector<std::string> candidates;
  Matrix theta;  // samples x candidates
  Vector y;      // samples
  // Residuals are divided by it: the noise's standard deviation, up to a factor
  // that all outputs share. In y's unit.
  double sigma = 1.0;
};

// Consecutive samples of one record.
struct TimeBlock {
  Eigen::Index begin = 0;
  Eigen::Index count = 0;
};

// Outputs at the same samples. Several outputs belong into one problem only if
// a constraint binds their coefficients; otherwise each is better solved on its
// own, with its own penalty.
struct RegressionProblem {
  std::vector<RegressionOutput> outputs;
  // First sample of each record, beginning with 0; empty: one record.
  std::vector<Eigen::Index> record_starts;
  std::vector<CoefficientConstraint> constraints;

  Eigen::Index num_samples() const {
    return outputs.empty() ? 0 : outputs[0].y.size();
  }
  // Over all outputs.
  int num_coefficients() const;
  // One for each candidate of each output, in their order: the candidate where
  // there is one output, else "output: candidate".
  std::vector<std::string> CoefficientNames() const;

  // Sizes, names, finite entries, records and constraints. On failure *error
  // names the output or constraint and what was expected. Passes the map of the
  // coefficients where `map` is not null.
  [[nodiscard]] bool IsValid(std::string* error,
                             CoefficientMap* map = nullptr) const;
};

// Cuts the records into about `num_blocks` blocks of about the same length (at
// least one a record), in their order. No block reaches across two records.
std::vector<TimeBlock> DivideIntoBlocks(const RegressionProblem& problem,
                                        int num_blocks);

}  // namespace pinode

#endif  // PINODE_DISCOVER_REGRESSION_PROBLEM_H_
