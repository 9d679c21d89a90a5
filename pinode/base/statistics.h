// What a series of numbers is like: its size, its memory, what is missing.

#ifndef PINODE_BASE_STATISTICS_H_
#define PINODE_BASE_STATISTICS_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Values that are not NaN, which means missing.
Eigen::Index CountPresent(const Vector& values);

// Over the samples that are present; NaN if there are none. The standard
// deviation is that of the population: sqrt(mean((x - mean(x))^2)).
double MeanOfPresent(const Eigen::Ref<const Vector>& values);
double RmsOfPresent(const Vector& values);
double StandardDeviationOfPresent(const Vector& values);

// All of these in one, for those who ask again and again.
struct SeriesStatistics {
  Eigen::Index count = 0;
  double mean = 0.0;
  double rms = 0.0;
  double variation = 0.0;  // sum of (x - mean)^2; 0 without samples

  double StandardDeviation() const;
};
SeriesStatistics StatisticsOfPresent(const Vector& values);

// The middle one of `values` (not empty, not NaN) in ascending order; of an
// even number the upper of two.
double Median(std::vector<double> values);

// Ljung-Box statistic over the lags 1 ... num_lags in standard deviations from
// its mean under white noise (G. M. Ljung and G. E. P. Box, Biometrika 65
// (1978) 297-303).
double LjungBoxExcess(const Vector& residuals, int num_lags);

// 1 + 2 sum rho_k up to the first lag with rho_k < 0.05, in samples.
double AutocorrelationTime(const Vector& residuals);

// Mean square of what has no memory in `residuals`, half that of successive
// differences (J. von Neumann, Annals of Mathematical Statistics 12 (1941)
// 367): the variance of white noise, and next to nothing of a signal that is
// smooth. Zeros stand for missing samples and are passed over; 0 where fewer
// than two are left.
double MemorylessMeanSquare(const Vector& residuals);

// The same of residuals that come one by one.
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

// The variance of white noise, with its standard deviation, from what a series
// has above about a third of its sampling rate: the mean square of its
// differences of order 8 over C(16, 8), and next to nothing of what is below.
// Over runs of samples without a gap (NaN: missing); zero where there is none.
struct DifferencedVariance {
  double value = 0.0;
  double deviation = 0.0;
};
DifferencedVariance VarianceOfDifferences(const Vector& values);

// 0.975 quantile of Student's t with `degrees` degrees of freedom (A&S 26.7.5).
double StudentQuantile(double degrees);

// Probability that chi^2 with `degrees` degrees of freedom is larger than
// `value`, to a few thousandths of it (E. B. Wilson and M. M. Hilferty, PNAS 17
// (1931) 684).
double ChiSquareProbability(double value, double degrees);

}  // namespace pinode

#endif  // PINODE_BASE_STATISTICS_H_
