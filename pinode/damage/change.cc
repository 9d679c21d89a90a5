#include "pinode/damage/change.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <sstream>
#include <utility>

#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/estimate/certainty/covariance.h"

namespace pinode {
namespace {

// Returns P(Z < z).
double NormalProbability(double z) {
  return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

bool IsGroupState(const GroupState& state, Eigen::Index size,
                  const std::string& name, std::string* error) {
  if (state.values.size() != size || state.covariance.rows() != size ||
      state.covariance.cols() != size) {
    std::ostringstream message;
    message << name << " has " << state.values.size() << " groups and a "
            << state.covariance.rows() << " x " << state.covariance.cols()
            << " covariance, expected " << size;
    *error = message.str();
    return false;
  }
  if (!state.values.allFinite() || !state.covariance.allFinite() ||
      state.covariance.llt().info() != Eigen::Success) {
    *error = name +
             " does not determine all groups: their covariance is not positive "
             "definite";
    return false;
  }
  return true;
}

// Baseline value of each group, its covariance, and the variance between
// records.
struct Pool {
  Vector values;
  Matrix covariance;
  Vector between;
};

// True if the weighted mean is far from all its values. Weights of strongly
// correlated groups are negative. If records differ in more than single groups,
// these weights lead away from the values (R. W. Peelle's pertinent puzzle,
// 1987).
bool IsOutside(const Pool& pool, const std::vector<GroupState>& healthy) {
  for (Eigen::Index j = 0; j < pool.values.size(); ++j) {
    double least = healthy[0].values[j];
    double most = least;
    for (const GroupState& state : healthy) {
      least = std::min(least, state.values[j]);
      most = std::max(most, state.values[j]);
    }
    const double sigma = std::sqrt(pool.covariance(j, j));
    if (pool.values[j] < least - sigma || pool.values[j] > most + sigma) {
      return true;
    }
  }
  return false;
}

// Pools the values by their unweighted mean.
void PoolEqually(const std::vector<GroupState>& healthy, Pool* pool) {
  const double count = static_cast<double>(healthy.size());
  pool->values.setZero();
  pool->covariance.setZero();
  for (const GroupState& state : healthy) {
    pool->values += state.values / count;
    pool->covariance += state.covariance / (count * count);
  }
  pool->covariance.diagonal() += pool->between / count;
}

Pool PoolHealthy(const std::vector<GroupState>& healthy) {
  const int size = static_cast<int>(healthy[0].values.size());
  const int count = static_cast<int>(healthy.size());
  Pool pool;
  pool.between = Vector::Zero(size);
  // Moments: scatter of the values beyond their own variances.
  if (count > 1) {
    for (int j = 0; j < size; ++j) {
      double weights = 0.0;
      double squares = 0.0;
      double mean = 0.0;
      for (const GroupState& state : healthy) {
        const double weight = 1.0 / state.covariance(j, j);
        weights += weight;
        squares += weight * weight;
        mean += weight * state.values[j];
      }
      mean /= weights;
      double q = 0.0;
      for (const GroupState& state : healthy) {
        q += std::pow(state.values[j] - mean, 2) / state.covariance(j, j);
      }
      pool.between[j] =
          std::max(0.0, (q - (count - 1)) / (weights - squares / weights));
    }
  }
  Matrix information = Matrix::Zero(size, size);
  Vector right = Vector::Zero(size);
  for (const GroupState& state : healthy) {
    Matrix covariance = state.covariance;
    covariance.diagonal() += pool.between;
    const Matrix inverse = covariance.llt().solve(Matrix::Identity(size, size));
    information += inverse;
    right += inverse * state.values;
  }
  pool.covariance = information.llt().solve(Matrix::Identity(size, size));
  pool.values = pool.covariance * right;
  if (IsOutside(pool, healthy)) PoolEqually(healthy, &pool);
  return pool;
}

// Scores of single changes in addition to those in `found`, and their
// correlation.
class Scores {
 public:
  Scores(const Matrix& information, const Vector& right,
         const std::vector<int>& found)
      : found_(found) {
    for (int j = 0; j < right.size(); ++j) {
      if (std::find(found.begin(), found.end(), j) == found.end()) {
        rest_.push_back(j);
      }
    }
    Matrix conditional = information(rest_, rest_);
    Vector score = right(rest_);
    if (!found.empty()) {
      const Eigen::LLT<Matrix> llt(Matrix(information(found, found)));
      const Matrix coupling = information(rest_, found);
      const Matrix by_found = llt.solve(coupling.transpose());
      const Vector shift = llt.solve(Vector(right(found)));
      conditional -= coupling * by_found;
      score -= coupling * shift;
    }
    const Vector scale = conditional.diagonal().cwiseSqrt();
    correlation_ = scale.cwiseInverse().asDiagonal() * conditional *
                   scale.cwiseInverse().asDiagonal();
    z_ = score.cwiseQuotient(scale);
  }

  int Largest() const {
    Eigen::Index index = 0;
    z_.cwiseAbs().maxCoeff(&index);
    return static_cast<int>(index);
  }
  int Group(int index) const { return rest_[static_cast<size_t>(index)]; }
  double z(int index) const { return z_[index]; }

  // Returns P(max |z| >= value) if none of the rest has changed; with Student's
  // t of `degrees` in place of normal scores.
  double Exceedance(double value, double degrees, int draws) const {
    const Matrix root =
        Eigen::SelfAdjointEigenSolver<Matrix>(correlation_).operatorSqrt();
    std::mt19937_64 random(20210116);
    std::normal_distribution<double> normal;
    std::chi_squared_distribution<double> chi2(std::min(degrees, 1e8));
    int count = 0;
    Vector z(z_.size());
    for (int i = 0; i < draws; ++i) {
      for (double& entry : z) entry = normal(random);
      z = root * z;
      double size = z.cwiseAbs().maxCoeff();
      if (std::isfinite(degrees)) size /= std::sqrt(chi2(random) / degrees);
      count += size >= value;
    }
    // The rate is never zero, because the number of draws is finite.
    return (count + 1.0) / (draws + 1.0);
  }

 private:
  std::vector<int> found_, rest_;
  Matrix correlation_;
  Vector z_;
};

// Returns the gain in twice the log-likelihood by changes of the groups in
// `support` alone.
double Gain(const Matrix& information, const Vector& right,
            const std::vector<int>& support) {
  if (support.empty()) return 0.0;
  const Vector part = right(support);
  return part.dot(Matrix(information(support, support)).llt().solve(part));
}

std::vector<RivalChange> Rivals(const Matrix& information, const Vector& right,
                                const std::vector<int>& found,
                                double largest_loss) {
  std::vector<RivalChange> rivals;
  const double gain = Gain(information, right, found);
  for (size_t k = 0; k < found.size(); ++k) {
    for (int j = 0; j < right.size(); ++j) {
      if (std::find(found.begin(), found.end(), j) != found.end()) continue;
      std::vector<int> exchanged = found;
      exchanged[k] = j;
      const double loss = gain - Gain(information, right, exchanged);
      if (loss < largest_loss) rivals.push_back({found[k], j, loss});
    }
  }
  std::stable_sort(rivals.begin(), rivals.end(),
                   [](const RivalChange& a, const RivalChange& b) {
                     return a.loss < b.loss;
                   });
  return rivals;
}

// Both sides of the comparison.
struct Comparison {
  Pool pool;
  Vector healthy_value;  // changes are fractions of it
  Vector difference;     // as changes
  Matrix covariance;     // of the difference
  Matrix information;    // its inverse
  Vector right;          // information * difference
};

bool Compare(const std::vector<GroupState>& healthy, const GroupState& current,
             const ChangeOptions& options, Comparison* result,
             std::string* error) {
  if (!options.IsValid(error)) return false;
  if (healthy.empty()) {
    *error = "there is no baseline state";
    return false;
  }
  const Eigen::Index size = current.values.size();
  if (size == 0) {
    *error = "there is no group";
    return false;
  }
  for (size_t i = 0; i < healthy.size(); ++i) {
    if (!IsGroupState(healthy[i], size,
                      "baseline state " + std::to_string(i + 1), error)) {
      return false;
    }
  }
  if (!IsGroupState(current, size, "the current state", error)) return false;
  if (!options.absolute.empty() &&
      static_cast<Eigen::Index>(options.absolute.size()) != size) {
    *error = "absolute has " + std::to_string(options.absolute.size()) +
             " entries, expected " + std::to_string(size) + " or none";
    return false;
  }
  const Pool pool = PoolHealthy(healthy);
  Vector scale = pool.values.array() + 1.0;
  for (Eigen::Index j = 0; j < size; ++j) {
    if (!options.absolute.empty() && options.absolute[static_cast<size_t>(j)]) {
      scale[j] = 1.0;
    }
    if (scale[j] <= 0.0) {
      *error = "the baseline stiffness of group " + std::to_string(j + 1) +
               " is not positive";
      return false;
    }
  }
  result->difference = (current.values - pool.values).cwiseQuotient(scale);
  Matrix covariance = current.covariance + pool.covariance;
  covariance.diagonal() += pool.between;
  const auto inverse_scale = scale.cwiseInverse().asDiagonal();
  result->covariance = inverse_scale * covariance * inverse_scale;
  result->information =
      result->covariance.llt().solve(Matrix::Identity(size, size));
  result->right = result->information * result->difference;
  result->pool = pool;
  result->healthy_value = scale;
  return true;
}

// Standard deviations between baseline records, as fractions.
Vector BetweenRecords(const Comparison& comparison) {
  return comparison.pool.between.cwiseSqrt().cwiseQuotient(
      comparison.healthy_value);
}

// Degrees of freedom of the differences of a comparison.
double DegreesOf(const Comparison& comparison, size_t num_baselines) {
  return DegreesOfFreedom(BetweenRecords(comparison).cwiseAbs2(),
                          comparison.covariance.diagonal(), num_baselines);
}

}  // namespace

// The variance between records comes from few of them: the degrees are those
// of its sum with the known covariance (F. E. Satterthwaite, Biometrics Bull. 2
// (1946) 110-114), for the group with the fewest.
double DegreesOfFreedom(const Vector& between, const Vector& variances,
                        size_t num_baselines) {
  const double baselines = static_cast<double>(num_baselines);
  double degrees = std::numeric_limits<double>::infinity();
  for (Eigen::Index j = 0; j < between.size(); ++j) {
    if (!(between[j] > 0.0)) continue;
    const double share = between[j] * (1.0 + 1.0 / baselines) / variances[j];
    degrees = std::min(degrees, (baselines - 1.0) / (share * share));
  }
  return degrees;
}

bool ChangeOptions::IsValid(std::string* error) const {
  if (!(threshold >= 0.0 && threshold < 1.0)) {
    *error = "threshold is " + FormatNumber(threshold) +
             ", expected a fraction from 0 to below 1, such as 0.05 for 5 %";
    return false;
  }
  if (!(false_alarm_rate > 0.0 && false_alarm_rate < 1.0)) {
    *error = "false_alarm_rate is " + FormatNumber(false_alarm_rate) +
             ", expected a probability between 0 and 1, such as 0.05";
    return false;
  }
  if (num_draws < 1000) {
    *error = "num_draws must be at least 1000";
    return false;
  }
  return true;
}

std::vector<bool> NearlyGone(const std::vector<GroupState>& healthy) {
  constexpr double kNearlyGone = 0.1;
  std::vector<bool> gone;
  for (const GroupState& state : healthy) {
    gone.resize(static_cast<size_t>(state.values.size()), false);
    for (size_t j = 0; j < gone.size(); ++j) {
      const double value = 1.0 + state.values[static_cast<Eigen::Index>(j)];
      gone[j] = gone[j] || !(value > kNearlyGone);
    }
  }
  return gone;
}

bool EstimateChange(const std::vector<GroupState>& healthy,
                    const GroupState& current, const ChangeOptions& options,
                    ChangeEstimate* estimate, std::string* error) {
  *estimate = ChangeEstimate();
  Comparison comparison;
  if (!Compare(healthy, current, options, &comparison, error)) return false;
  const Eigen::Index size = current.values.size();
  const Vector& difference = comparison.difference;
  const Matrix& information = comparison.information;
  const Vector& right = comparison.right;
  estimate->has_between_records = healthy.size() > 1;
  estimate->between_records = BetweenRecords(comparison);
  const double degrees = DegreesOf(comparison, healthy.size());

  std::vector<int> found;
  Vector p_values = Vector::Ones(size);
  // A group may enter, leave and enter again; the limit ends such cycles.
  const Eigen::Index max_rounds = 3 * size;
  for (Eigen::Index round = 0;
       round < max_rounds && static_cast<Eigen::Index>(found.size()) < size;
       ++round) {
    const Scores scores(information, right, found);
    const int largest = scores.Largest();
    const double p = scores.Exceedance(std::abs(scores.z(largest)), degrees,
                                       options.num_draws);
    const int group = scores.Group(largest);
    p_values[group] = p;
    if (p > options.false_alarm_rate) break;
    found.push_back(group);
    // Groups that the newcomer explains leave again, the least needed first.
    for (bool any = true; any && found.size() > 1;) {
      any = false;
      double worst = 1.0;
      size_t leaver = 0;
      for (size_t k = 0; k + 1 < found.size(); ++k) {
        std::vector<int> others = found;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
        const Scores beside(information, right, others);
        for (int i = 0;; ++i) {
          if (beside.Group(i) != found[k]) continue;
          const double alone = beside.Exceedance(std::abs(beside.z(i)), degrees,
                                                 options.num_draws);
          if (alone > options.false_alarm_rate && (!any || alone > worst)) {
            any = true;
            worst = alone;
            leaver = k;
          }
          break;
        }
      }
      if (any) {
        p_values[found[leaver]] = worst;
        found.erase(found.begin() + static_cast<std::ptrdiff_t>(leaver));
      }
    }
  }

  const double quantile = StudentQuantile(degrees);
  estimate->groups.resize(static_cast<size_t>(size));
  for (int j = 0; j < size; ++j) {
    GroupChange& group = estimate->groups[static_cast<size_t>(j)];
    const auto position = std::find(found.begin(), found.end(), j);
    group.changed = position != found.end();
    group.p_value = p_values[j];
    std::vector<int> model = found;
    if (!group.changed) model.push_back(j);
    const int index = group.changed ? static_cast<int>(position - found.begin())
                                    : static_cast<int>(found.size());
    const Matrix variance =
        Matrix(information(model, model))
            .llt()
            .solve(Matrix::Identity(static_cast<int>(model.size()),
                                    static_cast<int>(model.size())));
    const Vector refit = variance * right(model);
    group.change = refit[index];
    group.sigma = std::sqrt(variance(index, index));
    group.lower95 = group.change - quantile * group.sigma;
    group.upper95 = group.change + quantile * group.sigma;
    group.probability =
        NormalProbability((-options.threshold - group.change) / group.sigma);
  }
  estimate->rivals = Rivals(information, right, found, options.rival_loss);
  Vector rest = difference;
  if (!found.empty()) {
    const Vector refit =
        Matrix(information(found, found)).llt().solve(Vector(right(found)));
    for (size_t k = 0; k < found.size(); ++k) {
      rest[found[k]] -= refit[static_cast<int>(k)];
    }
  }
  estimate->unexplained_chi2 = rest.dot(information * rest);
  estimate->unexplained_degrees =
      static_cast<int>(size) - static_cast<int>(found.size());
  return true;
}

bool PoolBaselines(const std::vector<GroupState>& healthy,
                   PooledBaselines* pooled, std::string* error) {
  if (healthy.empty()) {
    *error = "there is no baseline";
    return false;
  }
  for (size_t i = 0; i < healthy.size(); ++i) {
    if (!IsGroupState(healthy[i], healthy[0].values.size(),
                      "baseline " + std::to_string(i + 1), error)) {
      return false;
    }
  }
  Pool pool = PoolHealthy(healthy);
  pooled->state.values = std::move(pool.values);
  pooled->state.covariance = std::move(pool.covariance);
  pooled->state.covariance.diagonal() += pool.between;
  pooled->between = std::move(pool.between);
  pooled->num_baselines = static_cast<int>(healthy.size());
  return true;
}

bool FindRivals(const std::vector<GroupState>& healthy,
                const GroupState& current, const ChangeOptions& options,
                const std::vector<int>& found, std::vector<RivalChange>* rivals,
                std::string* error) {
  Comparison comparison;
  if (!Compare(healthy, current, options, &comparison, error)) return false;
  *rivals = Rivals(comparison.information, comparison.right, found,
                   options.rival_loss);
  return true;
}

bool FindChangeInstead(const std::vector<GroupState>& healthy,
                       const GroupState& current, const ChangeOptions& options,
                       const std::vector<int>& found, int one, int other,
                       const std::vector<int>& beside, ChangeInstead* result,
                       std::string* error) {
  Comparison comparison;
  if (!Compare(healthy, current, options, &comparison, error)) return false;
  std::vector<int> with = found;
  std::vector<int> without = {other};
  for (const int j : found) {
    if (j != one && j != other) without.push_back(j);
  }
  for (const int j : beside) {
    for (std::vector<int>* set : {&with, &without}) {
      if (std::find(set->begin(), set->end(), j) == set->end()) {
        set->push_back(j);
      }
    }
  }
  const Matrix& information = comparison.information;
  const Vector& right = comparison.right;
  result->loss =
      Gain(information, right, with) - Gain(information, right, without);
  const Eigen::Index size = static_cast<Eigen::Index>(without.size());
  const Matrix variance = Matrix(information(without, without))
                              .llt()
                              .solve(Matrix::Identity(size, size));
  GroupChange& change = result->change;
  change = GroupChange();
  change.change = variance.row(0).dot(right(without));
  change.sigma = std::sqrt(variance(0, 0));
  const double quantile =
      StudentQuantile(DegreesOf(comparison, healthy.size()));
  change.lower95 = change.change - quantile * change.sigma;
  change.upper95 = change.change + quantile * change.sigma;
  change.probability =
      NormalProbability((-options.threshold - change.change) / change.sigma);
  return true;
}

}  // namespace pinode
