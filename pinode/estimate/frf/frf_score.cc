#include "pinode/estimate/frf/frf_score.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "pinode/base/statistics.h"

namespace pinode {
namespace {

constexpr int kFrfLags = 20;
// Share of the lines that count as those with a large FRF.
constexpr double kLargeLines = 0.1;
// Largest number of lines in a report.
constexpr Eigen::Index kMostReportedLines = 4000;

// Measured values of a pair over their relative deviations; 0: none.
ComplexVector WeightedMeasured(const FrfCost& cost, Eigen::Index pair) {
  ComplexVector values =
      cost.record().values.col(pair).cwiseQuotient(cost.deviations().col(pair));
  for (std::complex<double>& value : values) {
    if (!std::isfinite(std::abs(value))) value = 0.0;
  }
  return values;
}

// Probability that a series is white.
double WhiteProbability(const Vector& series) {
  const int lags =
      static_cast<int>(std::min<Eigen::Index>(kFrfLags, series.size() / 3));
  const double excess = LjungBoxExcess(series, lags);
  return ChiSquareProbability(lags + excess * std::sqrt(2.0 * lags), lags);
}

// Power of residuals where the FRF is large, against that elsewhere.
struct PowerAtPeaks {
  double probability = 1.0;  // that both are equal
  double excess = 0.0;       // sum of squares beyond that of equal power
};

PowerAtPeaks ComparePowers(const ComplexVector& residuals,
                           const ComplexVector& measured) {
  std::vector<Eigen::Index> order;
  for (Eigen::Index k = 0; k < measured.size(); ++k) {
    if (std::abs(measured[k]) > 0.0) order.push_back(k);
  }
  const auto count = static_cast<Eigen::Index>(order.size());
  const auto large = std::max<Eigen::Index>(
      1, static_cast<Eigen::Index>(kLargeLines * static_cast<double>(count)));
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) {
                     return std::abs(measured[a]) > std::abs(measured[b]);
                   });
  double at_peaks = 0.0;
  double elsewhere = 0.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    (i < large ? at_peaks : elsewhere) +=
        std::norm(residuals[order[static_cast<size_t>(i)]]);
  }
  PowerAtPeaks result;
  const auto rest = static_cast<double>(count - large);
  const auto peaks = static_cast<double>(large);
  if (!(elsewhere > 0.0) || rest < 1.0) return result;
  const double variance = elsewhere / (2.0 * rest);  // of each part
  // The estimate of the variance is as uncertain as a tenth of chi^2.
  const double widened = std::sqrt(1.0 + peaks / rest);
  const double degrees = 2.0 * peaks;
  const double distance = (at_peaks / variance - degrees) / widened;
  const double above = ChiSquareProbability(
      std::max(1e-9, degrees + std::abs(distance)), degrees);
  result.probability = std::min(1.0, 2.0 * above);
  result.excess = std::max(0.0, at_peaks - degrees * variance);
  return result;
}

void AddReportedLines(const FrfCost& cost, FrfScore* score) {
  const FrfRecord& record = cost.record();
  const Eigen::Index stride =
      (record.num_lines() + kMostReportedLines - 1) / kMostReportedLines;
  std::vector<Eigen::Index> lines;
  for (Eigen::Index k = 0; k < record.num_lines(); k += stride) {
    lines.push_back(k);
  }
  score->frequencies = record.frequencies(lines);
  const ComplexMatrix measured = record.values(lines, Eigen::all).transpose();
  const ComplexMatrix modelled = cost.modelled()(lines, Eigen::all).transpose();
  score->measured_real = measured.real();
  score->measured_imaginary = measured.imag();
  score->modelled_real = modelled.real();
  score->modelled_imaginary = modelled.imag();
}

}  // namespace

Vector FrfErrors(const FrfCost& cost) {
  Vector errors(cost.record().num_pairs());
  for (Eigen::Index p = 0; p < errors.size(); ++p) {
    errors[p] =
        cost.residuals().col(p).norm() / WeightedMeasured(cost, p).norm();
  }
  return errors;
}

bool ScoreFrfs(const Vector& free, FrfCost* cost, FrfScore* score) {
  double value = 0.0;
  if (!cost->Evaluate(free, &value)) return false;
  score->log_likelihood = -value;
  score->memory = cost->Memory();
  const FrfRecord& record = cost->record();
  const Eigen::Index pairs = record.num_pairs();
  score->name = record.name;
  score->lowest_frequency = record.frequencies[0];
  score->highest_frequency = record.frequencies[record.num_lines() - 1];
  score->num_lines = record.num_lines();
  score->errors = FrfErrors(*cost);
  score->sigma = cost->sigma();
  score->unexplained.resize(pairs);
  if (record.sigma.size() > 0) score->noise_ratios = Vector::Zero(pairs);
  double least = 1.0;
  score->pairs.clear();
  for (Eigen::Index p = 0; p < pairs; ++p) {
    score->pairs.push_back(record.PairName(p));
    const ComplexVector residuals = cost->residuals().col(p);
    const ComplexVector measured = WeightedMeasured(*cost, p);
    const Vector real = residuals.real();
    const Vector imaginary = residuals.imag();
    const PowerAtPeaks powers = ComparePowers(residuals, measured);
    // The rest of exact data is rounding, which has a form of its own.
    if (score->errors[p] < FrfCost::kLeastNoise) {
      score->unexplained[p] = score->errors[p];
      continue;
    }
    least = std::min({least, WhiteProbability(real),
                      WhiteProbability(imaginary), powers.probability});
    const auto count =
        static_cast<double>((measured.array().abs() > 0.0).count());
    const double noise =
        count * (MemorylessMeanSquare(real) + MemorylessMeanSquare(imaginary));
    const double structured =
        std::max(powers.excess, residuals.squaredNorm() - noise);
    score->unexplained[p] =
        std::sqrt(std::max(0.0, structured)) / measured.norm();
    if (record.sigma.size() > 0) {
      score->noise_ratios[p] =
          std::sqrt(residuals.squaredNorm() / (2.0 * count)) / record.sigma[p];
    }
  }
  score->probability = std::min(1.0, 3.0 * static_cast<double>(pairs) * least);
  AddReportedLines(*cost, score);
  return true;
}

}  // namespace pinode
