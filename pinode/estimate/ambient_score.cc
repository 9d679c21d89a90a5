// How well a model describes an ambient record.

#include <algorithm>
#include <cmath>
#include <complex>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/estimate/ambient_cost.h"

namespace pinode {
namespace {

// Parts of the band that are looked at for themselves, and points of a figure.
constexpr Eigen::Index kMostParts = 40;
constexpr Eigen::Index kGridPoints = 400;

}  // namespace

bool AmbientCost::Score(const Vector& free, AmbientScore* score) {
  CondensedSystem ignored;
  double cost = 0.0;
  if (!Linearize(free, &ignored) || !Evaluate(free, &cost)) return false;
  FindTransfer(/*all=*/true);
  const Eigen::Index channels = scales_.size();
  const Eigen::Index lines = num_lines();
  *score = AmbientScore();
  score->name = record_.name;
  score->lowest_frequency = lines_.frequency[0];
  score->highest_frequency = lines_.frequency[lines - 1];
  score->num_lines = static_cast<int>(total_lines_);
  score->num_knots = spectrum_->num_knots();
  score->explained = Vector::Zero(channels);
  const double total_count = lines_.count.sum();
  const Eigen::Index parts =
      std::clamp<Eigen::Index>(lines / (8 * channels + 40), 1, kMostParts);
  const Eigen::Index points = std::min<Eigen::Index>(lines, kGridPoints);
  score->frequencies = Vector::Zero(points);
  score->measured = Matrix::Zero(channels, points);
  score->modelled = Matrix::Zero(channels, points);
  score->lines = Vector::Zero(points);
  std::vector<ComplexMatrix> products(static_cast<size_t>(parts),
                                      ComplexMatrix::Zero(channels, channels));
  std::vector<double> counts(static_cast<size_t>(parts), 0.0);
  std::vector<double> starts(static_cast<size_t>(parts), kInfinity);
  std::vector<double> ends(static_cast<size_t>(parts), 0.0);
  double seen = 0.0;
  Vector total = Vector::Zero(channels);
  for (const Column& column : columns_) {
    score->groups.push_back(layout_.free_parameter(column.free).name);
  }
  score->information_left = information_left_;
  score->most_information_left = most_information_left_;
  const std::vector<Matrix> at_knots = KnotCovariances();
  Eigen::LLT<ComplexMatrix> factor;
  for (Eigen::Index k = 0; k < lines; ++k) {
    if (!FactorizeLine(k, LoadCovariance(lines_.frequency[k], at_knots),
                       &factor)) {
      return false;
    }
    const ComplexMatrix& y = lines_.products[static_cast<size_t>(k)];
    const ComplexMatrix half = factor.matrixL().solve(y);
    const size_t part = std::min(
        products.size() - 1,
        static_cast<size_t>(seen * static_cast<double>(parts) / total_count));
    const double count = lines_.count[k];
    seen += count;
    products[part] += factor.matrixL().solve(half.adjoint().eval());
    counts[part] += count;
    starts[part] = std::min(starts[part], lines_.frequency[k]);
    ends[part] = std::max(ends[part], lines_.frequency[k]);
    const Eigen::Index point = k * points / lines;
    const Vector power = factor.reconstructedMatrix().diagonal().real();
    score->frequencies[point] += count * lines_.frequency[k];
    score->measured.col(point) += y.diagonal().real();
    score->modelled.col(point) += count * power;
    score->lines[point] += count;
    total += count * power;
    for (Eigen::Index c = 0; c < channels; ++c) {
      score->explained[c] +=
          count *
          (power[c] - std::exp(2.0 * unknowns_[spectrum_->num_unknowns() + c]));
    }
  }
  score->frequencies.array() /= score->lines.array();
  for (Matrix* density : {&score->measured, &score->modelled}) {
    for (Eigen::Index point = 0; point < points; ++point) {
      density->col(point) =
          density->col(point).cwiseProduct(scales_.cwiseAbs2()) /
          score->lines[point];
    }
  }
  score->explained.array() /= total.array();
  score->noise_sigma.resize(channels);
  for (Eigen::Index c = 0; c < channels; ++c) {
    score->channels.push_back(record_.channels[static_cast<size_t>(c)].name);
    // A one-sided density up to half the sampling rate.
    score->noise_sigma[c] = scales_[c] *
                            std::exp(unknowns_[spectrum_->num_unknowns() + c]) *
                            std::sqrt(0.5 / record_.sampling_step);
  }
  // n |Q - I|^2 of the mean Q of n products z z^H has the expectation
  // channels^2, and the variance 2 channels^2 of a chi^2 where n is large;
  // 1 + 2 channels / n times that otherwise, as r times a chi^2 of channels^2/r
  // degrees has.
  const double square = static_cast<double>(channels * channels);
  const double r =
      1.0 + 2.0 * static_cast<double>(channels * parts) / total_count;
  for (size_t p = 0; p < products.size(); ++p) {
    if (counts[p] == 0.0) continue;
    const ComplexMatrix off =
        products[p] / counts[p] - ComplexMatrix::Identity(channels, channels);
    const double value = counts[p] * off.squaredNorm();
    score->chi_square += value / r;
    const double deviation = (value - square) / std::sqrt(2.0 * r * square);
    if (p == 0 || deviation > score->worst_deviation) {
      score->worst_deviation = deviation;
      score->worst_from = starts[p];
      score->worst_to = ends[p];
    }
  }
  score->degrees_of_freedom =
      std::max(1, static_cast<int>(
                      (square * static_cast<double>(parts) - NumFitted()) / r));
  score->probability =
      ChiSquareProbability(score->chi_square, score->degrees_of_freedom);
  return true;
}

}  // namespace pinode
