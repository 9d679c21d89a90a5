#include "pinode/discover/selection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Differences of BIC below this are not significant.
constexpr double kBicMargin = 2.0;

// A support of free unknowns and its fit.
struct Fit {
  std::vector<int> support;
  Vector free;
  double sum_of_squares = 0.0;
  double bic = 0.0;
  std::vector<double> block_errors;  // of the held-back blocks
};

class Selector {
 public:
  Selector(LeastSquaresSystem system, const CoefficientMap& map,
           const SelectionOptions& options)
      : system_(std::move(system)), map_(map), options_(options) {
    // Residuals of the model with given terms only.
    floor_ = options.noise_floor * options.noise_floor *
             (system_.b.squaredNorm() + system_.rest);
  }

  // Sets the held-back blocks; together they are the samples of the system.
  void SetBlocks(std::vector<LeastSquaresSystem> blocks) {
    blocks_ = std::move(blocks);
    for (size_t k = 0; k < blocks_.size(); ++k) {
      std::vector<int> others(blocks_.size(), 1);
      others[k] = 0;
      rest_.push_back(Combine(blocks_, others));
    }
  }
  void SetNumIndependent(double num) { num_independent_ = num; }

  // Fits a support that is new.
  void Add(const std::vector<int>& support);
  // Adds the supports that remain when the terms of fits()[from] leave one by
  // one.
  void Eliminate(int from);
  // Orders the fits and returns the place of the chosen one.
  int Choose();

  bool WithinRounding(const Fit& fit) const {
    return fit.sum_of_squares <= floor_;
  }
  const Fit& Closest() const;
  const std::vector<Fit>& fits() const { return fits_; }
  // Compares block errors with those of the best fit: mean and standard error
  // of the difference.
  void Excess(const Fit& fit, double* mean, double* error) const;

 private:
  double MeanBlockError(const Fit& fit) const;
  const Fit& LeastBlockError() const;
  bool Acceptable(const Fit& fit) const;
  double Criterion(const Fit& fit) const {
    return options_.criterion == SelectionOptions::Criterion::kBic
               ? fit.bic
               : MeanBlockError(fit);
  }

  LeastSquaresSystem system_;
  const CoefficientMap& map_;
  const SelectionOptions& options_;
  double floor_;
  double num_independent_ = 0.0;
  std::vector<LeastSquaresSystem> blocks_;
  std::vector<LeastSquaresSystem> rest_;  // all blocks but one
  std::vector<Fit> fits_;
  std::set<std::vector<int>> seen_;
};

void Selector::Add(const std::vector<int>& support) {
  if (!seen_.insert(support).second) return;
  Fit fit;
  fit.support = support;
  fit.free = FitSupport(system_, map_, support);
  fit.sum_of_squares = system_.SumOfSquares(fit.free);
  for (size_t k = 0; k < blocks_.size(); ++k) {
    const Vector free = FitSupport(rest_[k], map_, support);
    fit.block_errors.push_back(blocks_[k].SumOfSquares(free) /
                               static_cast<double>(blocks_[k].num_residuals));
  }
  fits_.push_back(std::move(fit));
}

void Selector::Eliminate(int from) {
  std::vector<int> support = fits_[static_cast<size_t>(from)].support;
  while (!support.empty()) {
    std::vector<int> best;
    double least = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < support.size(); ++i) {
      std::vector<int> without = support;
      without.erase(without.begin() + static_cast<std::ptrdiff_t>(i));
      const double sum =
          system_.SumOfSquares(FitSupport(system_, map_, without));
      if (sum < least) {
        least = sum;
        best = std::move(without);
      }
    }
    support = std::move(best);
    Add(support);
  }
}

const Fit& Selector::Closest() const {
  return *std::min_element(fits_.begin(), fits_.end(),
                           [](const Fit& a, const Fit& b) {
                             return a.sum_of_squares < b.sum_of_squares;
                           });
}

double Selector::MeanBlockError(const Fit& fit) const {
  double sum = 0.0;
  for (double error : fit.block_errors) sum += error;
  return sum / static_cast<double>(fit.block_errors.size());
}

const Fit& Selector::LeastBlockError() const {
  return *std::min_element(fits_.begin(), fits_.end(),
                           [this](const Fit& a, const Fit& b) {
                             return MeanBlockError(a) < MeanBlockError(b);
                           });
}

void Selector::Excess(const Fit& fit, double* mean, double* error) const {
  const Fit& least = LeastBlockError();
  const auto count = static_cast<double>(fit.block_errors.size());
  *mean = MeanBlockError(fit) - MeanBlockError(least);
  double squares = 0.0;
  for (size_t k = 0; k < fit.block_errors.size(); ++k) {
    const double off = fit.block_errors[k] - least.block_errors[k] - *mean;
    squares += off * off;
  }
  *error = std::sqrt(squares / (count * (count - 1.0)));
}

bool Selector::Acceptable(const Fit& fit) const {
  if (options_.criterion == SelectionOptions::Criterion::kBic) {
    double least = std::numeric_limits<double>::infinity();
    for (const Fit& other : fits_) least = std::min(least, other.bic);
    return fit.bic <= least + kBicMargin;
  }
  double mean, error;
  Excess(fit, &mean, &error);
  return mean <= options_.num_standard_errors * error +
                     floor_ / static_cast<double>(system_.num_residuals);
}

int Selector::Choose() {
  const auto n = static_cast<double>(system_.num_residuals);
  for (Fit& fit : fits_) {
    const double mean = std::max({fit.sum_of_squares, floor_,
                                  std::numeric_limits<double>::min()}) /
                        n;
    fit.bic =
        num_independent_ * std::log(mean) +
        static_cast<double>(fit.support.size()) * std::log(num_independent_);
  }
  std::stable_sort(fits_.begin(), fits_.end(), [](const Fit& a, const Fit& b) {
    return a.support.size() != b.support.size()
               ? a.support.size() < b.support.size()
               : a.sum_of_squares < b.sum_of_squares;
  });
  int chosen = -1;
  for (size_t i = 0; i < fits_.size(); ++i) {
    if (!Acceptable(fits_[i])) continue;
    if (chosen >= 0) {
      const Fit& other = fits_[static_cast<size_t>(chosen)];
      if (other.support.size() < fits_[i].support.size()) break;
      if (Criterion(other) <= Criterion(fits_[i])) continue;
    }
    chosen = static_cast<int>(i);
  }
  CHECK_GE(chosen, 0) << "the least criterion is acceptable by definition";
  return chosen;
}

// Returns the residuals of each output and record, in units of sigma.
std::vector<std::vector<Vector>> Residuals(const RegressionProblem& problem,
                                           const Vector& coefficients) {
  std::vector<Eigen::Index> starts = problem.record_starts;
  if (starts.empty()) starts.push_back(0);
  starts.push_back(problem.num_samples());
  std::vector<std::vector<Vector>> residuals;
  Eigen::Index first = 0;
  for (const RegressionOutput& output : problem.outputs) {
    const Eigen::Index count = output.theta.cols();
    const Vector all =
        (output.y - output.theta * coefficients.segment(first, count)) /
        output.sigma;
    first += count;
    residuals.emplace_back();
    for (size_t r = 0; r + 1 < starts.size(); ++r) {
      residuals.back().push_back(
          all.segment(starts[r], starts[r + 1] - starts[r]));
    }
  }
  return residuals;
}

}  // namespace

double NumIndependent(const std::vector<Vector>& series) {
  Eigen::Index length = 0;
  Eigen::Index longest = 0;
  double variance = 0.0;
  for (const Vector& values : series) {
    length += values.size();
    longest = std::max(longest, values.size());
    variance += values.squaredNorm();
  }
  const auto total = static_cast<double>(length);
  if (variance == 0.0) return total;
  const auto correlation = [&](Eigen::Index lag) {
    double sum = 0.0;
    for (const Vector& values : series) {
      const Eigen::Index overlap = values.size() - lag;
      if (overlap > 0) sum += values.head(overlap).dot(values.tail(overlap));
    }
    return sum / variance;
  };
  double time = -1.0;
  for (Eigen::Index lag = 0; lag < longest; lag += 2) {
    const double pair = correlation(lag) + correlation(lag + 1);
    if (pair <= 0.0) break;
    time += 2.0 * pair;
  }
  return total / std::max(1.0, time);
}

bool SelectionOptions::IsValid(std::string* error) const {
  CHECK(error != nullptr);
  if (num_blocks < 2) {
    *error = "selection: num_blocks " + std::to_string(num_blocks) +
             ", expected at least 2";
    return false;
  }
  if (!(num_standard_errors >= 0.0) || !std::isfinite(num_standard_errors)) {
    *error = "selection: num_standard_errors " +
             FormatNumber(num_standard_errors) +
             ", expected a finite number of at least 0";
    return false;
  }
  if (!(noise_floor >= 0.0 && noise_floor < 1.0)) {
    *error = "selection: noise_floor " + FormatNumber(noise_floor) +
             ", expected a number of at least 0 and below 1";
    return false;
  }
  return true;
}

std::vector<std::vector<int>> Supports(const LassoPath& path) {
  std::vector<std::vector<int>> supports;
  for (const LassoSolution& solution : path.solutions) {
    supports.push_back(solution.support);
  }
  return supports;
}

std::vector<std::vector<int>> Supports(const std::vector<StlsqSolution>& path) {
  std::vector<std::vector<int>> supports;
  for (const StlsqSolution& solution : path) {
    supports.push_back(solution.support);
  }
  return supports;
}

bool SelectSupport(const RegressionProblem& problem,
                   const std::vector<std::vector<int>>& supports,
                   const SelectionOptions& options, Selection* selection,
                   std::string* error) {
  CHECK(selection != nullptr && error != nullptr);
  CoefficientMap map;
  if (!problem.IsValid(error, &map) || !options.IsValid(error)) return false;
  const std::vector<TimeBlock> blocks =
      DivideIntoBlocks(problem, options.num_blocks);
  if (blocks.size() < 2) {
    *error = "selection: " + std::to_string(problem.num_samples()) +
             " samples make no two blocks, expected more";
    return false;
  }
  Selector selector(Condense(problem, map), map, options);
  std::vector<LeastSquaresSystem> parts;
  for (const TimeBlock& block : blocks) {
    parts.push_back(Condense(problem, map, block));
  }
  selector.SetBlocks(std::move(parts));
  selector.Add({});
  for (const std::vector<int>& support : supports) {
    selector.Add(map.ReduceSupport(support));
  }

  Selection created;
  created.num_independent =
      static_cast<double>(problem.num_samples() * problem.outputs.size());
  if (options.autocorrelation && !selector.WithinRounding(selector.Closest())) {
    created.num_independent = 0.0;
    for (const auto& series :
         Residuals(problem, map.Expand(selector.Closest().free))) {
      created.num_independent += NumIndependent(series);
    }
  }
  selector.SetNumIndependent(created.num_independent);
  int chosen = selector.Choose();
  if (options.backward_elimination) {
    selector.Eliminate(chosen);
    chosen = selector.Choose();
  }
  created.chosen = chosen;
  for (const Fit& fit : selector.fits()) {
    SelectionEntry entry;
    entry.support = map.ExpandSupport(fit.support);
    entry.num_terms = static_cast<int>(fit.support.size());
    entry.coefficients = map.Expand(fit.free);
    entry.sum_of_squares = fit.sum_of_squares;
    entry.bic = fit.bic;
    for (double block_error : fit.block_errors) {
      entry.held_back +=
          block_error / static_cast<double>(fit.block_errors.size());
    }
    selector.Excess(fit, &entry.held_back_excess, &entry.held_back_error);
    created.entries.push_back(std::move(entry));
  }
  *selection = std::move(created);
  return true;
}

namespace {

// Adds the supports of backward elimination from the best of `supports`;
// returns the place of the best of all.
int ChooseByBic(const std::vector<std::vector<int>>& supports,
                double num_independent, const SelectionOptions& options,
                Selector* selector) {
  selector->SetNumIndependent(num_independent);
  selector->Add({});
  for (const std::vector<int>& support : supports) selector->Add(support);
  int chosen = selector->Choose();
  if (options.backward_elimination) {
    selector->Eliminate(chosen);
    chosen = selector->Choose();
  }
  return chosen;
}

SelectionOptions ByBic(const LeastSquaresSystem& system, double num_independent,
                       const SelectionOptions& options) {
  std::string error;
  CHECK(options.IsValid(&error)) << error;
  CHECK(num_independent > 0.0 &&
        num_independent <= static_cast<double>(system.num_residuals))
      << num_independent << " of " << system.num_residuals;
  SelectionOptions bic = options;
  bic.criterion = SelectionOptions::Criterion::kBic;
  return bic;
}

}  // namespace

std::vector<int> SelectByBic(const LeastSquaresSystem& system,
                             const CoefficientMap& map,
                             const std::vector<std::vector<int>>& supports,
                             double num_independent,
                             const SelectionOptions& options) {
  const SelectionOptions bic = ByBic(system, num_independent, options);
  Selector selector(system, map, bic);
  const int chosen = ChooseByBic(supports, num_independent, bic, &selector);
  return selector.fits()[static_cast<size_t>(chosen)].support;
}

std::vector<int> SelectByLoss(const LeastSquaresSystem& system,
                              const CoefficientMap& map,
                              const std::vector<std::vector<int>>& supports,
                              double num_independent, double loss,
                              const SelectionOptions& options) {
  CHECK_GE(loss, 0.0);
  const SelectionOptions bic = ByBic(system, num_independent, options);
  Selector selector(system, map, bic);
  const int chosen = ChooseByBic(supports, num_independent, bic, &selector);
  std::vector<int> all;
  for (int j = 0; j < system.num_free(); ++j) {
    if (!system.A.col(j).isZero(0.0)) all.push_back(j);
  }
  const double least =
      std::min(selector.Closest().sum_of_squares,
               system.SumOfSquares(FitSupport(system, map, all)));
  // Ascending number of terms.
  for (const Fit& fit : selector.fits()) {
    if (fit.sum_of_squares - least <= loss) return fit.support;
  }
  return selector.fits()[static_cast<size_t>(chosen)].support;
}

}  // namespace pinode
