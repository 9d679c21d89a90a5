#include "pinode/watch/control_chart.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>

#include "pinode/base/statistics.h"

namespace pinode {
namespace {

constexpr double kYear = 365.25 * kDay;

// Records that are simulated for the limits, unless fewer suffice or more are
// needed, and for each of the repetitions that show their uncertainty.
constexpr size_t kSimulated = 150000;
constexpr int kRepetitions = 8;
// The fewest rises whose rate is counted, which is known to 22 % then.
constexpr double kFewestRises = 20.0;
// A notice lasts `clear_days`. At this share of the year notices would merge.
constexpr double kMostNotices = 0.25;
// Simulated years that suffice: with 200 false alarms their rate is known to
// 7 %.
constexpr double kEnoughYears = 200.0;
// The fewest innovations that blocks can be drawn from.
constexpr size_t kFewestInnovations = 25;

// Solves a symmetric system whose rows may have very different scales, or be
// empty.
Vector SolveScaled(const Matrix& matrix, const Vector& right) {
  Vector scales = matrix.diagonal().cwiseSqrt();
  for (double& scale : scales) scale = scale > 0.0 ? 1.0 / scale : 0.0;
  Matrix scaled = scales.asDiagonal() * matrix * scales.asDiagonal();
  scaled.diagonal().array() += 1e-9;
  return scales.asDiagonal() *
         scaled.llt().solve(scales.asDiagonal() * right).eval();
}

// A pool of innovations, and blocks of it.
class Simulation {
 public:
  Simulation(const std::vector<Innovation>& pool,
             const std::vector<double>& steps, size_t block,
             const ChartOptions& options)
      : pool_(pool), steps_(steps), block_(block), options_(options) {}

  // Simulates `count` records from blocks that begin at one of `starts`. With
  // `normal`, their innovations are replaced by normal ones.
  void Run(const std::vector<size_t>& starts, size_t count, uint64_t seed,
           bool normal) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> deviate;
    Innovation drawn;
    values_.clear();
    times_.resize(static_cast<Eigen::Index>(count));
    const Eigen::Index p = pool_.front().score.size();
    ScoreAverage average(p, 0, options_.memory_days * kDay);
    double time = 0.0;
    while (values_.size() < count) {
      const size_t start = starts[random() % starts.size()];
      for (size_t i = 0; i < block_ && values_.size() < count; ++i) {
        const size_t at = (start + i) % pool_.size();
        time += steps_[at];
        drawn.whitened = pool_[at].whitened;
        if (normal) {
          for (double& value : drawn.whitened) value = deviate(random);
        }
        drawn.score = pool_[at].whitened_change.transpose() * drawn.whitened;
        drawn.information = pool_[at].information;
        average.Add(steps_[at], drawn);
        times_[static_cast<Eigen::Index>(values_.size())] = time;
        values_.push_back(
            {NormalScore(drawn.whitened.squaredNorm(),
                         static_cast<double>(drawn.whitened.size())),
             average.Score(Matrix())});
      }
    }
    years_ = time / kYear;
    sorted_t2_.clear();
    sorted_average_.clear();
    for (const ChartValues& values : values_) {
      sorted_t2_.push_back(values.t2);
      sorted_average_.push_back(values.average);
    }
    std::sort(sorted_t2_.begin(), sorted_t2_.end());
    std::sort(sorted_average_.begin(), sorted_average_.end());
  }

  double years() const { return years_; }
  // Returns true if the simulated years hold enough rises of that rate.
  bool Holds(double rises_per_year) const {
    return rises_per_year * years_ >= kFewestRises;
  }

  // Finds the limits. A rate that the simulation does not hold is extrapolated:
  // a normal score crosses z at a rate of exp(-z^2 / 2) times a constant (S. O.
  // Rice 1945).
  ChartLimits Limits(double rises_per_year) const {
    if (Holds(rises_per_year)) return CountedLimits(rises_per_year);
    const double held = kFewestRises / years_;
    const ChartLimits counted = CountedLimits(held);
    const double squares = 2.0 * std::log(held / rises_per_year);
    return {std::sqrt(counted.t2 * counted.t2 + squares),
            std::sqrt(counted.average * counted.average + squares)};
  }

 private:
  // Finds limits by bisection of the share of records above each.
  ChartLimits CountedLimits(double rises_per_year) const {
    double low = 0.5;
    double high = 0.5 / static_cast<double>(values_.size());
    for (int i = 0; i < 25; ++i) {
      const double share = std::sqrt(low * high);
      const int rises =
          CountRises(values_, times_, LimitsAt(share), options_.clear_days);
      // Beyond a certain share the rises merge into one that lasts.
      const bool is_high = rises > rises_per_year * years_ || share > 0.1;
      (is_high ? low : high) = share;
    }
    return LimitsAt(high);
  }

  ChartLimits LimitsAt(double share) const {
    return {Quantile(sorted_t2_, share), Quantile(sorted_average_, share)};
  }

  static double Quantile(const std::vector<double>& sorted, double share) {
    const double place =
        (1.0 - share) * static_cast<double>(sorted.size()) - 0.5;
    const double last = static_cast<double>(sorted.size() - 1);
    const double inside = std::clamp(place, 0.0, last);
    const size_t below = static_cast<size_t>(inside);
    const size_t above = std::min(below + 1, sorted.size() - 1);
    const double part = inside - static_cast<double>(below);
    return sorted[below] + part * (sorted[above] - sorted[below]);
  }

  const std::vector<Innovation>& pool_;
  const std::vector<double>& steps_;
  size_t block_;
  const ChartOptions& options_;
  double years_ = 0.0;
  std::vector<ChartValues> values_;
  Vector times_;
  std::vector<double> sorted_t2_, sorted_average_;
};

}  // namespace

ScoreAverage::ScoreAverage(Eigen::Index num_features, Eigen::Index num_effects,
                           double memory)
    : memory_(memory),
      sum_(Vector::Zero(num_features)),
      unlimited_sum_(sum_),
      sum_covariance_(Matrix::Zero(num_features, num_features)),
      weight_(Matrix::Zero(num_features, num_features)),
      effect_(Matrix::Zero(num_features, num_effects)) {}

void ScoreAverage::Add(double step, const Innovation& innovation) {
  const double keep = std::exp(-step / memory_);
  sum_ = keep * sum_ + innovation.score;
  // Simulated innovations have none.
  if (innovation.unlimited_score.size() > 0) {
    unlimited_sum_ = keep * unlimited_sum_ + innovation.unlimited_score;
  }
  sum_covariance_ = keep * keep * sum_covariance_ + innovation.information;
  weight_ = keep * weight_ + innovation.information;
  if (effect_.cols() > 0) {
    effect_ = keep * effect_ + innovation.coefficient_effect;
  }
}

double ScoreAverage::Score(const Matrix& coefficient_covariance) const {
  Matrix covariance = sum_covariance_;
  if (coefficient_covariance.size() > 0) {
    covariance += effect_ * coefficient_covariance * effect_.transpose();
  }
  const double chi2 = sum_.dot(SolveScaled(covariance, sum_));
  Eigen::Index present = 0;
  for (const double variance : sum_covariance_.diagonal()) {
    if (variance > 0.0) ++present;
  }
  return present > 0 ? NormalScore(chi2, static_cast<double>(present)) : kNaN;
}

void ScoreAverage::Change(const Matrix& coefficient_covariance, Vector* change,
                          Vector* deviation) const {
  *change = SolveScaled(weight_, unlimited_sum_);
  deviation->resize(change->size());
  const Matrix covariance =
      sum_covariance_ + effect_ * coefficient_covariance * effect_.transpose();
  for (Eigen::Index f = 0; f < change->size(); ++f) {
    const Vector row = SolveScaled(weight_, Vector::Unit(change->size(), f));
    (*deviation)[f] = std::sqrt(std::max(0.0, row.dot(covariance * row)));
  }
}

int CountRises(const std::vector<ChartValues>& values, const Vector& times,
               const ChartLimits& limits, double clear_days) {
  int rises = 0;
  double last = -kInfinity;
  for (size_t i = 0; i < values.size(); ++i) {
    if (!(values[i].t2 > limits.t2) && !(values[i].average > limits.average)) {
      continue;
    }
    const double time = times[static_cast<Eigen::Index>(i)];
    if (time - last >= clear_days * kDay) ++rises;
    last = time;
  }
  return rises;
}

bool FindThresholds(const std::vector<Innovation>& reference,
                    const Vector& times, double scatter_memory,
                    const ChartOptions& options, ChartThresholds* thresholds,
                    std::string* error) {
  std::vector<Innovation> pool;
  std::vector<double> steps;
  double last = kNaN;
  std::vector<double> known_steps;
  for (size_t i = 0; i < reference.size(); ++i) {
    if (!reference[i].valid) continue;
    const double time = times[static_cast<Eigen::Index>(i)];
    steps.push_back(time - last);
    if (!std::isnan(last)) known_steps.push_back(time - last);
    last = time;
    if (!reference[i].whitened.allFinite() || !reference[i].score.allFinite()) {
      *error =
          "the reference gives no finite limits; look for frequencies or "
          "standard deviations that are 0 in its records";
      return false;
    }
    pool.push_back(reference[i]);
  }
  if (pool.size() < kFewestInnovations) {
    *error = "the reference has " + std::to_string(pool.size()) +
             " records for the chart, expected at least " +
             std::to_string(kFewestInnovations);
    return false;
  }
  const double typical_step = Median(known_steps);
  steps.front() = typical_step;
  // A gap within the reference is not simulated again and again.
  double duration = 0.0;
  for (double& step : steps) {
    step = std::min(step, 10.0 * typical_step);
    duration += step;
  }
  thresholds->reference_years = duration / kYear;
  // Blocks are longer than the memory of the series, so that what the filter
  // left of it stays.
  const double block_time = std::max(3.0 * scatter_memory, kDay);
  const size_t block = std::clamp<size_t>(
      static_cast<size_t>(block_time / typical_step), 1, pool.size() / 10 + 1);
  const double most = static_cast<double>(options.most_simulated);
  const double rate = options.false_alarms_per_year;
  const double per_year = kYear / typical_step;
  // The records must be many enough for the rate to be counted, also of rare
  // alarms.
  const double fewest = 1.1 * per_year * kFewestRises / rate;
  const double simulated =
      std::min(kEnoughYears * per_year / std::max(1.0, rate),
               static_cast<double>(kSimulated));
  const size_t count = static_cast<size_t>(
      std::min(std::max({1000.0, fewest, simulated}), most));
  const size_t repeated = static_cast<size_t>(std::min(
      {std::max(1000.0, fewest), static_cast<double>(kSimulated), most}));
  std::vector<size_t> starts(pool.size());
  for (size_t i = 0; i < starts.size(); ++i) starts[i] = i;
  Simulation simulation(pool, steps, block, options);
  // A reference without rare events would give low limits. Those of normal
  // innovations are the least.
  for (const bool normal : {false, true}) {
    simulation.Run(starts, count, 1, normal);
    thresholds->simulated_years = simulation.years();
    thresholds->is_extrapolated = !simulation.Holds(rate);
    const auto raise = [&](double at_rate, ChartLimits* limits) {
      const ChartLimits found = simulation.Limits(at_rate);
      limits->t2 = normal ? std::max(limits->t2, found.t2) : found.t2;
      limits->average =
          normal ? std::max(limits->average, found.average) : found.average;
    };
    raise(rate, &thresholds->alarm);
    raise(std::clamp(kMostNotices * kYear / (options.clear_days * kDay), rate,
                     12.0 * rate),
          &thresholds->notice);
  }

  // The same from other references: blocks of this one, drawn with replacement.
  std::mt19937_64 random(2);
  std::vector<double> t2, average;
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    std::vector<size_t> drawn(pool.size() / block + 1);
    for (size_t& start : drawn) start = random() % pool.size();
    simulation.Run(drawn, repeated, 3 + repetition, false);
    const ChartLimits limits = simulation.Limits(rate);
    t2.push_back(limits.t2);
    average.push_back(limits.average);
  }
  const auto interval = [](const std::vector<double>& values, double centre,
                           double* lower, double* upper) {
    const double spread = StandardDeviationOfPresent(Eigen::Map<const Vector>(
        values.data(), static_cast<Eigen::Index>(values.size())));
    const double half = StudentQuantile(kRepetitions - 1) * spread;
    *lower = centre - half;
    *upper = centre + half;
  };
  interval(t2, thresholds->alarm.t2, &thresholds->lower95.t2,
           &thresholds->upper95.t2);
  interval(average, thresholds->alarm.average, &thresholds->lower95.average,
           &thresholds->upper95.average);
  return true;
}

std::vector<ChartValues> MakeChart(const std::vector<Innovation>& innovations,
                                   const Vector& times,
                                   const NormalModel& model,
                                   const ChartOptions& options) {
  std::vector<ChartValues> chart(innovations.size());
  if (innovations.empty()) return chart;
  const Matrix covariance = CovarianceWithOutside(model);
  ScoreAverage average(model.coefficients.cols(), covariance.rows(),
                       options.memory_days * kDay);
  double last = kNaN;
  for (size_t i = 0; i < innovations.size(); ++i) {
    if (!innovations[i].valid) continue;
    const double time = times[static_cast<Eigen::Index>(i)];
    average.Add(std::isnan(last) ? 0.0 : time - last, innovations[i]);
    last = time;
    chart[i] = {innovations[i].t2_score, average.Score(covariance)};
  }
  return chart;
}

}  // namespace pinode
