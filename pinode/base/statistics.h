// Statistics of a series of numbers: size, autocorrelation, noise and missing
// samples.

#ifndef PINODE_BASE_STATISTICS_H_
#define PINODE_BASE_STATISTICS_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Returns the number of values that are not NaN. NaN means missing.
Eigen::Index CountPresent(const Vector& values);

// Return the mean, the root mean square and the standard deviation of the
// samples that are present, or NaN if there are none. The standard deviation
// is that of the population: sqrt(mean((x - mean(x))^2)).
double MeanOfPresent(const Eigen::Ref<const Vector>& values);
double RmsOfPresent(const Vector& values);
double StandardDeviationOfPresent(const Vector& values);

// All these statistics in one structure, for callers that need them repeatedly.
struct SeriesStatistics {
  Eigen::Index count = 0;
  double mean = 0.0;
  double rms = 0.0;
  double variation = 0.0;  // sum of (x - mean)^2; 0 without samples

  double StandardDeviation() const;
};
SeriesStatistics StatisticsOfPresent(const Vector& values);

// Returns the median of `values` (not empty, no NaN). For an even number of
// values it is the upper of the two middle ones.
double Median(std::vector<double> values);

// Returns the Ljung-Box statistic over the lags 1 ... num_lags, as its distance
// from the mean under white noise in standard deviations (G. M. Ljung and G. E.
// P. Box, Biometrika 65 (1978) 297-303).
double LjungBoxExcess(const Vector& residuals, int num_lags);

// Returns 1 + 2 sum rho_k up to the first lag with rho_k < 0.05, in samples.
double AutocorrelationTime(const Vector& residuals);

// Returns the mean square of the uncorrelated part of `residuals`: half the
// mean square of successive differences (J. von Neumann, Annals of Mathematical
// Statistics 12 (1941) 367). It equals the variance of white noise and is
// almost zero for a smooth signal. Zeros mean missing samples and are skipped.
// The result is 0 if fewer than two samples are left.
double MemorylessMeanSquare(const Vector& residuals);

// Computes MemorylessMeanSquare of residuals that arrive one by one.
class MemorylessPart {
 public:
  void Add(double residual);
  double MeanSquare() const {
    return count_ > 0 ? sum_ / static_cast<double>(count_) : 0.0;
  }

 private:
  double last_ = 0.0;
  double sum_ = 0.0;
  Eigen::Index count_ = 0;
};

// Variance of white noise, with its standard deviation, estimated from the
// content of a series above about a third of its sampling rate. It is the mean
// square of the differences of order 8 over C(16, 8). Content below that
// frequency adds almost nothing. Differences are taken over runs of samples
// without a gap (NaN: missing). Zero if there is no such run.
struct DifferencedVariance {
  double value = 0.0;
  double deviation = 0.0;
};
DifferencedVariance VarianceOfDifferences(const Vector& values);

// Returns the 0.975 quantile of Student's t with `degrees` degrees of freedom
// (A&S 26.7.5).
double StudentQuantile(double degrees);

// Returns the probability that chi^2 with `degrees` degrees of freedom is
// larger than `value`, to a few thousandths of it (E. B. Wilson and M. M.
// Hilferty, PNAS 17 (1931) 684).
double ChiSquareProbability(double value, double degrees);

}  // namespace pinode

#endif  // PINODE_BASE_STATISTICS_H_
