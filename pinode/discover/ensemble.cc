#include "pinode/discover/ensemble.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/parallel_for.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Evidence of a bag drawn with replacement: the variance of its fit is twice
// that of a fit to as many independent samples.
constexpr double kBagEvidence = 0.5;

// Draws uniformly in [0, count). std::uniform_int_distribution gives different
// numbers with every standard library.
int Draw(int count, std::mt19937_64* engine) {
  return static_cast<int>((*engine)() % static_cast<uint64_t>(count));
}

// Interpolates between the order statistics; `values` sorted, not empty.
double Percentile(const std::vector<double>& values, double fraction) {
  const double place = fraction * static_cast<double>(values.size() - 1);
  const auto below = static_cast<size_t>(place);
  const size_t above = std::min(below + 1, values.size() - 1);
  const double share = place - static_cast<double>(below);
  return (1.0 - share) * values[below] + share * values[above];
}

struct Bag {
  std::vector<bool> offered;
  Vector free;
};

// Returns the rank of a bag.
int RankOfBag(size_t bag, size_t count, int ranks) {
  return static_cast<int>(bag * static_cast<size_t>(ranks) / count);
}

// Distributes each rank's results for its bags to all ranks, `count` unknowns
// each.
bool ExchangeBags(Eigen::Index count, Communicator* ranks,
                  std::vector<Bag>* bags) {
  if (ranks->size() == 1) return true;
  // Rows: offered or not, then coefficients. The bags of a rank are
  // consecutive.
  Matrix numbers(2 * count, static_cast<Eigen::Index>(bags->size()));
  std::vector<int64_t> sizes(static_cast<size_t>(ranks->size()), 0);
  for (size_t b = 0; b < bags->size(); ++b) {
    const int owner = RankOfBag(b, bags->size(), ranks->size());
    sizes[static_cast<size_t>(owner)] += numbers.rows();
    if (owner != ranks->rank()) continue;
    auto column = numbers.col(static_cast<Eigen::Index>(b));
    for (Eigen::Index i = 0; i < count; ++i) {
      column[i] = (*bags)[b].offered[static_cast<size_t>(i)] ? 1.0 : 0.0;
    }
    column.tail(count) = (*bags)[b].free;
  }
  if (!ranks->Gather(sizes, numbers.data())) return false;
  for (size_t b = 0; b < bags->size(); ++b) {
    const auto column = numbers.col(static_cast<Eigen::Index>(b));
    Bag& bag = (*bags)[b];
    bag.offered.assign(static_cast<size_t>(count), false);
    for (Eigen::Index i = 0; i < count; ++i) {
      bag.offered[static_cast<size_t>(i)] = column[i] != 0.0;
    }
    bag.free = column.tail(count);
  }
  return true;
}

void CheckLasso(const LassoOptions& lasso, const SelectionOptions& selection,
                double independent_fraction) {
  std::string error;
  LassoOptions own = lasso;
  own.penalty_weights.resize(0);
  CHECK(own.IsValid(0, &error)) << error;
  CHECK(selection.IsValid(&error)) << error;
  CHECK(independent_fraction > 0.0 && independent_fraction <= 1.0)
      << independent_fraction;
}

std::vector<std::vector<int>> SupportsOfPath(const LeastSquaresSystem& system,
                                             const CoefficientMap& map,
                                             const LassoOptions& lasso) {
  LassoOptions own = lasso;
  own.penalty_weights.resize(0);
  std::vector<std::vector<int>> supports;
  for (const LassoSolution& solution :
       SolveLassoPath(system, map, own).solutions) {
    supports.push_back(map.ReduceSupport(solution.support));
  }
  return supports;
}

}  // namespace

SparseLearner StlsqLearner(const StlsqOptions& options) {
  std::string error;
  CHECK(options.IsValid(&error)) << error;
  return
      [options](const LeastSquaresSystem& system, const CoefficientMap& map) {
        const StlsqSolution solution = SolveStlsq(system, map, options);
        return FitSupport(system, map, map.ReduceSupport(solution.support));
      };
}

SparseLearner LassoLearner(const LassoOptions& lasso,
                           const SelectionOptions& selection,
                           double independent_fraction) {
  CheckLasso(lasso, selection, independent_fraction);
  return [lasso, selection, independent_fraction](
             const LeastSquaresSystem& system, const CoefficientMap& map) {
    return FitSupport(
        system, map,
        SelectByBic(system, map, SupportsOfPath(system, map, lasso),
                    kBagEvidence * independent_fraction *
                        static_cast<double>(system.num_residuals),
                    selection));
  };
}

SparseLearner LassoLearnerWithin(double tolerance, const LassoOptions& lasso,
                                 const SelectionOptions& selection,
                                 double independent_fraction) {
  CheckLasso(lasso, selection, independent_fraction);
  CHECK_GE(tolerance, 0.0);
  return [tolerance, lasso, selection, independent_fraction](
             const LeastSquaresSystem& system, const CoefficientMap& map) {
    return FitSupport(
        system, map,
        SelectByLoss(
            system, map, SupportsOfPath(system, map, lasso),
            kBagEvidence * independent_fraction *
                static_cast<double>(system.num_residuals),
            tolerance * tolerance * static_cast<double>(system.num_residuals),
            selection));
  };
}

bool EnsembleOptions::IsValid(std::string* error) const {
  CHECK(error != nullptr);
  if (num_bags < 1 || num_blocks < 2 || num_threads < 1) {
    *error = "ensemble: num_bags " + std::to_string(num_bags) +
             ", num_blocks " + std::to_string(num_blocks) + ", num_threads " +
             std::to_string(num_threads) + ", expected at least 1, 2 and 1";
    return false;
  }
  if (!(library_fraction > 0.0 && library_fraction <= 1.0)) {
    *error = "ensemble: library_fraction " + FormatNumber(library_fraction) +
             ", expected a number above 0 and at most 1";
    return false;
  }
  if (!(inclusion_threshold > 0.0 && inclusion_threshold <= 1.0)) {
    *error = "ensemble: inclusion_threshold " +
             FormatNumber(inclusion_threshold) +
             ", expected a number above 0 and at most 1";
    return false;
  }
  return true;
}

bool RunEnsemble(const RegressionProblem& problem, const SparseLearner& learner,
                 const EnsembleOptions& options, Ensemble* ensemble,
                 std::string* error) {
  CHECK(ensemble != nullptr && error != nullptr);
  CHECK(learner != nullptr);
  CoefficientMap map;
  if (!problem.IsValid(error, &map) || !options.IsValid(error)) return false;
  const int count = map.num_free();
  std::vector<LeastSquaresSystem> blocks;
  for (const TimeBlock& block : DivideIntoBlocks(problem, options.num_blocks)) {
    blocks.push_back(Condense(problem, map, block));
  }
  const int num_blocks = static_cast<int>(blocks.size());
  const int num_offered =
      count == 0
          ? 0
          : std::clamp(
                static_cast<int>(std::lround(options.library_fraction * count)),
                1, count);

  std::vector<Bag> bags(static_cast<size_t>(options.num_bags));
  Communicator& ranks = CommunicatorOrSingle(options.communicator);
  ParallelFor(options.num_bags, options.num_threads, [&](int b, int) {
    if (RankOfBag(static_cast<size_t>(b), bags.size(), ranks.size()) !=
        ranks.rank()) {
      return;
    }
    std::seed_seq seed{static_cast<uint32_t>(options.seed),
                       static_cast<uint32_t>(options.seed >> 32),
                       static_cast<uint32_t>(b)};
    std::mt19937_64 engine(seed);
    std::vector<int> multiplicities(blocks.size(), 0);
    for (int k = 0; k < num_blocks; ++k) {
      ++multiplicities[static_cast<size_t>(Draw(num_blocks, &engine))];
    }
    LeastSquaresSystem system = Combine(blocks, multiplicities);
    std::vector<int> order(static_cast<size_t>(count));
    std::iota(order.begin(), order.end(), 0);
    for (int i = 0; i < num_offered; ++i) {
      std::swap(order[static_cast<size_t>(i)],
                order[static_cast<size_t>(i + Draw(count - i, &engine))]);
    }
    Bag& bag = bags[static_cast<size_t>(b)];
    bag.offered.assign(static_cast<size_t>(count), false);
    for (int i = 0; i < count; ++i) {
      const int column = order[static_cast<size_t>(i)];
      if (i < num_offered) {
        bag.offered[static_cast<size_t>(column)] = true;
      } else {
        system.A.col(column).setZero();
      }
    }
    bag.free = learner(system, map);
    CHECK_EQ(bag.free.size(), count) << "the learner's result";
  });
  if (!ExchangeBags(count, &ranks, &bags)) {
    *error = "a rank does not answer";
    return false;
  }

  const auto size = static_cast<Eigen::Index>(map.num_coefficients());
  Ensemble created;
  created.num_offered.assign(static_cast<size_t>(size), 0);
  created.inclusion_probability = Vector::Zero(size);
  created.median = Vector::Zero(size);
  created.lower = Vector::Zero(size);
  created.upper = Vector::Zero(size);
  std::vector<int> support;
  for (int j = 0; j < map.num_coefficients(); ++j) {
    const int i = map.free(j);
    if (i < 0) {
      created.num_offered[static_cast<size_t>(j)] = options.num_bags;
      created.inclusion_probability[j] = 1.0;
      created.median[j] = created.lower[j] = created.upper[j] = map.value(j);
      continue;
    }
    std::vector<double> values;
    int offered = 0;
    for (const Bag& bag : bags) {
      if (!bag.offered[static_cast<size_t>(i)]) continue;
      ++offered;
      if (bag.free[i] != 0.0) values.push_back(map.factor(j) * bag.free[i]);
    }
    created.num_offered[static_cast<size_t>(j)] = offered;
    if (values.empty()) continue;
    std::sort(values.begin(), values.end());
    created.inclusion_probability[j] =
        static_cast<double>(values.size()) / offered;
    created.median[j] = Percentile(values, 0.5);
    created.lower[j] = Percentile(values, 0.025);
    created.upper[j] = Percentile(values, 0.975);
    if (created.inclusion_probability[j] >= options.inclusion_threshold) {
      support.push_back(j);
    }
  }
  const std::vector<int> free_support = map.ReduceSupport(support);
  created.support = map.ExpandSupport(free_support);
  created.coefficients =
      map.Expand(FitSupport(Condense(problem, map), map, free_support));
  *ensemble = std::move(created);
  return true;
}

}  // namespace pinode
