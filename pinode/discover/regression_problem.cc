#include "pinode/discover/regression_problem.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {

int RegressionProblem::num_coefficients() const {
  int count = 0;
  for (const RegressionOutput& output : outputs) {
    count += static_cast<int>(output.candidates.size());
  }
  return count;
}

std::vector<std::string> RegressionProblem::CoefficientNames() const {
  std::vector<std::string> names;
  for (const RegressionOutput& output : outputs) {
    for (const std::string& candidate : output.candidates) {
      names.push_back(outputs.size() == 1 ? candidate
                                          : output.name + ": " + candidate);
    }
  }
  return names;
}

bool RegressionProblem::IsValid(std::string* error, CoefficientMap* map) const {
  CHECK(error != nullptr);
  if (outputs.empty() || num_samples() == 0) {
    *error = "regression: no output or no sample, expected at least one";
    return false;
  }
  for (const RegressionOutput& output : outputs) {
    const std::string who = "output '" + output.name + "': ";
    const auto candidates = static_cast<Eigen::Index>(output.candidates.size());
    if (output.y.size() != num_samples() ||
        output.theta.rows() != num_samples()) {
      *error = who + std::to_string(output.y.size()) + " values and " +
               std::to_string(output.theta.rows()) +
               " rows of candidates, expected " +
               std::to_string(num_samples()) + " as of the first output";
      return false;
    }
    if (output.theta.cols() != candidates || candidates == 0) {
      *error = who + std::to_string(candidates) + " candidates and " +
               std::to_string(output.theta.cols()) +
               " columns, expected as many, at least one";
      return false;
    }
    if (!output.y.allFinite()) {
      *error = who + "a value is not finite";
      return false;
    }
    for (Eigen::Index j = 0; j < candidates; ++j) {
      if (!output.theta.col(j).allFinite()) {
        *error = who + "candidate '" +
                 output.candidates[static_cast<size_t>(j)] +
                 "' is not finite everywhere";
        return false;
      }
    }
    if (!std::isfinite(output.sigma) || output.sigma <= 0.0) {
      *error = who + "sigma " + FormatNumber(output.sigma) +
               ", expected a positive number";
      return false;
    }
  }
  const std::vector<std::string> names = CoefficientNames();
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (!seen.insert(name).second) {
      *error = "regression: coefficient '" + name + "' twice";
      return false;
    }
  }
  for (size_t i = 0; i < record_starts.size(); ++i) {
    const Eigen::Index before = i == 0 ? -1 : record_starts[i - 1];
    if ((i == 0 && record_starts[0] != 0) || record_starts[i] <= before ||
        record_starts[i] >= num_samples()) {
      *error = "regression: record " + std::to_string(i + 1) +
               " starts at sample " + std::to_string(record_starts[i]) +
               ", expected starts that ascend from 0 to below " +
               std::to_string(num_samples());
      return false;
    }
  }
  CoefficientMap created;
  if (!CoefficientMap::Create(names, constraints, &created, error)) {
    return false;
  }
  if (map != nullptr) *map = std::move(created);
  return true;
}

std::vector<TimeBlock> DivideIntoBlocks(const RegressionProblem& problem,
                                        int num_blocks) {
  CHECK_GT(num_blocks, 0);
  std::vector<Eigen::Index> starts = problem.record_starts;
  if (starts.empty()) starts.push_back(0);
  const Eigen::Index total = problem.num_samples();
  std::vector<TimeBlock> blocks;
  for (size_t r = 0; r < starts.size(); ++r) {
    const Eigen::Index begin = starts[r];
    const Eigen::Index end = r + 1 < starts.size() ? starts[r + 1] : total;
    const Eigen::Index length = end - begin;
    const auto share = static_cast<Eigen::Index>(
        std::llround(static_cast<double>(num_blocks) *
                     static_cast<double>(length) / static_cast<double>(total)));
    const Eigen::Index parts = std::clamp<Eigen::Index>(share, 1, length);
    for (Eigen::Index i = 0; i < parts; ++i) {
      TimeBlock block;
      block.begin = begin + length * i / parts;
      block.count = begin + length * (i + 1) / parts - block.begin;
      blocks.push_back(block);
    }
  }
  return blocks;
}

}  // namespace pinode
