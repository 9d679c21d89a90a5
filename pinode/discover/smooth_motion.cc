#include "pinode/discover/smooth_motion.h"

#include <ceres/first_order_function.h>
#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

// Smallest noise as a share of each channel's RMS: records without noise
// contain rounding errors.
constexpr double kSmallestNoise = 1e-6;
constexpr int kFewestSamples = 8;
// Limits as natural logarithms, in units of the displacement's RMS and the
// step.
constexpr double kLowestIntensity = -45.0;
constexpr double kHighestIntensity = 5.0;

constexpr int kMaxOrder = 4;
using State = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxOrder, 1>;
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0,
                             kMaxOrder, kMaxOrder>;

double Factorial(int n) {
  double product = 1.0;
  for (int i = 2; i <= n; ++i) product *= i;
  return product;
}

double RmsOfFinite(const Vector& values) {
  double sum = 0.0;
  Eigen::Index count = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value * value;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0;
}

// Kalman filter in units of the displacement's RMS and the step. The state is
// (x, x' step, x'' step^2, ...), of which each sample shows some entries.
class Filter {
 public:
  Filter(int order, const std::vector<MotionChannel>& channels)
      : order_(order), channels_(channels) {
    transition_ = Square::Zero(order, order);
    process_ = Square::Zero(order, order);
    for (int i = 0; i < order; ++i) {
      for (int j = 0; j < order; ++j) {
        if (j >= i) transition_(i, j) = 1.0 / Factorial(j - i);
        process_(i, j) =
            1.0 / ((2 * order - 1 - i - j) * Factorial(order - 1 - i) *
                   Factorial(order - 1 - j));
      }
    }
    // Only the order of magnitude of the first state is known.
    first_ = Square::Zero(order, order);
    for (int i = 0; i < order; ++i) first_(i, i) = 100.0;
  }

  Eigen::Index num_samples() const { return channels_[0].values.size(); }

  // Returns the negative log-likelihood, but for a constant. With `smoothed`
  // also gives mean and variance of the first three entries at each sample.
  double Run(double intensity, const std::vector<double>& noise,
             Matrix* means = nullptr, Matrix* variances = nullptr) const {
    const Eigen::Index n = num_samples();
    const bool smooth = means != nullptr;
    State mean = State::Zero(order_);
    Square covariance = first_;
    std::vector<State> filtered_mean, predicted_mean;
    std::vector<Square> filtered, predicted;
    double cost = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (i > 0) {
        mean = transition_ * mean;
        covariance = transition_ * covariance * transition_.transpose() +
                     intensity * process_;
      }
      if (smooth) {
        predicted_mean.push_back(mean);
        predicted.push_back(covariance);
      }
      for (size_t c = 0; c < channels_.size(); ++c) {
        const double value = channels_[c].values[i];
        if (!std::isfinite(value)) continue;
        const int d = channels_[c].derivative;
        const double r = noise[c] * noise[c];
        const double variance = covariance(d, d) + r;
        const double error = value - mean[d];
        cost += 0.5 * (error * error / variance + std::log(variance));
        const State gain = covariance.col(d) / variance;
        mean += gain * error;
        // Joseph's form keeps the covariance positive.
        Square reduce = Square::Identity(order_, order_);
        reduce.col(d) -= gain;
        covariance = (reduce * covariance * reduce.transpose() +
                      r * gain * gain.transpose())
                         .eval();
      }
      if (smooth) {
        filtered_mean.push_back(mean);
        filtered.push_back(covariance);
      }
    }
    if (!smooth) return cost;
    means->resize(3, n);
    variances->resize(3, n);
    for (Eigen::Index i = n - 1; i >= 0; --i) {
      const size_t k = static_cast<size_t>(i);
      if (i < n - 1) {
        const Square back = predicted[k + 1]
                                .ldlt()
                                .solve(Square(transition_ * filtered[k]))
                                .transpose();
        mean = State(filtered_mean[k] + back * (mean - predicted_mean[k + 1]));
        covariance =
            Square(filtered[k] +
                   back * (covariance - predicted[k + 1]) * back.transpose());
      }
      means->col(i) = mean.head(3);
      variances->col(i) = covariance.diagonal().head(3).cwiseMax(0.0);
    }
    return cost;
  }

 private:
  int order_;
  const std::vector<MotionChannel>& channels_;
  Square transition_, process_, first_;
};

// The likelihood in the logarithms of intensity and unknown noise levels.
class Likelihood final : public ceres::FirstOrderFunction {
 public:
  Likelihood(const Filter& filter, const std::vector<MotionChannel>& channels,
             const std::vector<double>& scales)
      : filter_(filter), scales_(scales) {
    for (size_t c = 0; c < channels.size(); ++c) {
      noise_.push_back(channels[c].sigma);
      if (!(channels[c].sigma > 0.0)) estimated_.push_back(c);
    }
  }

  int NumParameters() const override {
    return 1 + static_cast<int>(estimated_.size());
  }

  bool Evaluate(const double* parameters, double* cost,
                double* gradient) const override {
    std::vector<double> at(parameters, parameters + NumParameters());
    *cost = Cost(at);
    if (gradient != nullptr) {
      constexpr double kStep = 1e-4;
      for (size_t k = 0; k < at.size(); ++k) {
        const double value = at[k];
        at[k] = value + kStep;
        const double above = Cost(at);
        at[k] = value - kStep;
        gradient[k] = (above - Cost(at)) / (2.0 * kStep);
        at[k] = value;
      }
    }
    return std::isfinite(*cost);
  }

  // Returns the noise per channel from the parameters, inside its limits.
  std::vector<double> Noise(const std::vector<double>& parameters) const {
    std::vector<double> noise = noise_;
    for (size_t k = 0; k < estimated_.size(); ++k) {
      const size_t c = estimated_[k];
      noise[c] = scales_[c] *
                 std::exp(std::clamp(parameters[k + 1], LowestNoise(), 0.0));
    }
    return noise;
  }
  static double Intensity(const std::vector<double>& parameters) {
    return std::exp(
        std::clamp(parameters[0], kLowestIntensity, kHighestIntensity));
  }

 private:
  static double LowestNoise() { return std::log(kSmallestNoise); }

  double Cost(const std::vector<double>& parameters) const {
    // Outside the limits a slope leads back.
    double outside =
        std::abs(parameters[0] - std::clamp(parameters[0], kLowestIntensity,
                                            kHighestIntensity));
    for (size_t k = 1; k < parameters.size(); ++k) {
      outside += std::abs(parameters[k] -
                          std::clamp(parameters[k], LowestNoise(), 0.0));
    }
    return filter_.Run(Intensity(parameters), Noise(parameters)) +
           outside * outside;
  }

  const Filter& filter_;
  const std::vector<double>& scales_;
  std::vector<double> noise_;
  std::vector<size_t> estimated_;
};

// Returns the RMS of the largest displacement channel with enough values; 0:
// there is none.
double DisplacementUnit(const std::vector<MotionChannel>& channels) {
  double unit = 0.0;
  for (const MotionChannel& channel : channels) {
    CHECK(channel.derivative >= 0 && channel.derivative <= 2)
        << "derivative " << channel.derivative;
    CHECK_EQ(channel.values.size(), channels[0].values.size());
    if (channel.derivative == 0 &&
        channel.values.array().isFinite().count() >= kFewestSamples) {
      unit = std::max(unit, RmsOfFinite(channel.values));
    }
  }
  return unit;
}

// Returns a start of the search. The likelihood may have more than one maximum
// (noise, or motion). The best point of a coarse grid is near the highest.
std::vector<double> StartOfSearch(const Likelihood& likelihood) {
  std::vector<double> start(static_cast<size_t>(likelihood.NumParameters()));
  double start_cost = std::numeric_limits<double>::infinity();
  for (double noise = std::log(1e-5); noise < 0.0; noise += 2.0) {
    for (double intensity = kLowestIntensity; intensity <= 0.0;
         intensity += 3.0) {
      std::vector<double> trial(start.size(), noise);
      trial[0] = intensity;
      double cost;
      if (likelihood.Evaluate(trial.data(), &cost, nullptr) &&
          cost < start_cost) {
        start_cost = cost;
        start = trial;
      }
    }
  }
  return start;
}

// Smooths channels in units of the displacement's RMS and the step, with the
// intensity and the noise levels of the greatest likelihood. `sigma` holds
// variances. Returns the negative log-likelihood.
double SmoothWithOrder(int order, const std::vector<MotionChannel>& channels,
                       const std::vector<double>& scales,
                       SmoothedMotion* smoothed) {
  const Filter filter(order, channels);
  auto* likelihood = new Likelihood(filter, channels, scales);
  const ceres::GradientProblem problem(likelihood);  // takes it over
  std::vector<double> parameters = StartOfSearch(*likelihood);
  ceres::GradientProblemSolver::Options options;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-9;
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(options, problem, parameters.data(), &summary);
  smoothed->order = order - 1;
  smoothed->noise = likelihood->Noise(parameters);
  return filter.Run(Likelihood::Intensity(parameters), smoothed->noise,
                    &smoothed->motion, &smoothed->sigma);
}

}  // namespace

bool SmoothMotion(double step, const std::vector<MotionChannel>& channels,
                  SmoothedMotion* result, std::string* error) {
  CHECK_GT(step, 0.0);
  const double unit = DisplacementUnit(channels);
  if (!(unit > 0.0)) {
    *error = "it has no displacement channel with at least " +
             std::to_string(kFewestSamples) +
             " values that are not all zero, so its displacement is unknown";
    return false;
  }
  const double units[] = {unit, unit / step, unit / (step * step)};
  std::vector<MotionChannel> scaled = channels;
  std::vector<double> scales;
  for (MotionChannel& channel : scaled) {
    channel.values /= units[channel.derivative];
    channel.sigma /= units[channel.derivative];
    scales.push_back(std::max(RmsOfFinite(channel.values), kSmallestNoise));
  }

  double least = std::numeric_limits<double>::infinity();
  SmoothedMotion best;
  for (int order = 3; order <= kMaxOrder; ++order) {
    SmoothedMotion motion;
    const double cost = SmoothWithOrder(order, scaled, scales, &motion);
    if (!(cost < least) || !motion.motion.allFinite()) continue;
    least = cost;
    best = std::move(motion);
  }
  if (!std::isfinite(least)) {
    *error = "its records cannot be smoothed, expected finite values";
    return false;
  }
  for (int d = 0; d < 3; ++d) {
    best.motion.row(d) *= units[d];
    best.sigma.row(d) = best.sigma.row(d).cwiseSqrt() * units[d];
  }
  for (size_t c = 0; c < scaled.size(); ++c) {
    best.noise[c] *= units[scaled[c].derivative];
  }
  *result = std::move(best);
  return true;
}

}  // namespace pinode
