#include "pinode/discover/stlsq.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

constexpr int kNumThresholds = 40;
constexpr double kSmallestThreshold = 1e-4;

}  // namespace

bool StlsqOptions::IsValid(std::string* error) const {
  CHECK(error != nullptr);
  if (!std::isfinite(threshold) || threshold < 0.0) {
    *error = "STLSQ: threshold " + FormatNumber(threshold) +
             ", expected a finite number of at least 0";
    return false;
  }
  if (!std::isfinite(ridge) || ridge < 0.0) {
    *error = "STLSQ: ridge " + FormatNumber(ridge) +
             ", expected a finite number of at least 0";
    return false;
  }
  if (max_num_iterations < 1) {
    *error = "STLSQ: max_num_iterations " + std::to_string(max_num_iterations) +
             ", expected at least 1";
    return false;
  }
  return true;
}

StlsqSolution SolveStlsq(const LeastSquaresSystem& system,
                         const CoefficientMap& map,
                         const StlsqOptions& options) {
  std::string error;
  CHECK(options.IsValid(&error)) << error;
  CHECK_EQ(system.num_free(), map.num_free());
  const int count = map.num_free();
  const double size = std::sqrt(system.b.squaredNorm() + system.rest);
  // Size of an unknown of 1 in units of the threshold.
  Vector unit = Vector::Zero(count);
  if (options.scaled) {
    if (size > 0.0) unit = system.A.colwise().norm().transpose() / size;
  } else {
    for (int j = 0; j < map.num_coefficients(); ++j) {
      const int i = map.free(j);
      if (i >= 0) unit[i] = std::max(unit[i], std::abs(map.factor(j)));
    }
  }
  std::vector<int> support(static_cast<size_t>(count));
  std::iota(support.begin(), support.end(), 0);

  StlsqSolution solution;
  solution.threshold = options.threshold;
  Vector free;
  while (solution.num_iterations < options.max_num_iterations &&
         !solution.converged) {
    ++solution.num_iterations;
    free = FitSupport(system, map, support, options.ridge);
    std::vector<int> kept;
    for (int i : support) {
      const double share = std::abs(free[i]) * unit[i];
      if (share > 0.0 && share >= options.threshold) kept.push_back(i);
    }
    solution.converged = kept.size() == support.size();
    support = kept;
  }
  free = FitSupport(system, map, support);
  solution.sum_of_squares = system.SumOfSquares(free);
  solution.coefficients = map.Expand(free);
  solution.support = map.ExpandSupport(support);
  return solution;
}

bool SolveStlsq(const RegressionProblem& problem, const StlsqOptions& options,
                StlsqSolution* solution, std::string* error) {
  CHECK(solution != nullptr && error != nullptr);
  std::vector<StlsqSolution> path;
  if (!SolveStlsqPath(problem, options, {options.threshold}, &path, error)) {
    return false;
  }
  *solution = path[0];
  return true;
}

bool SolveStlsqPath(const RegressionProblem& problem,
                    const StlsqOptions& options,
                    const std::vector<double>& thresholds,
                    std::vector<StlsqSolution>* path, std::string* error) {
  CHECK(path != nullptr && error != nullptr);
  CoefficientMap map;
  if (!problem.IsValid(error, &map)) return false;
  std::vector<double> used = thresholds;
  if (used.empty()) {
    for (int i = 0; i < kNumThresholds; ++i) {
      used.push_back(std::pow(kSmallestThreshold,
                              static_cast<double>(i) / (kNumThresholds - 1)));
    }
  }
  std::vector<StlsqOptions> each(used.size(), options);
  for (size_t i = 0; i < used.size(); ++i) {
    each[i].threshold = used[i];
    if (!each[i].IsValid(error)) return false;
  }
  const LeastSquaresSystem system = Condense(problem, map);
  path->clear();
  for (const StlsqOptions& one : each) {
    path->push_back(SolveStlsq(system, map, one));
  }
  return true;
}

}  // namespace pinode
