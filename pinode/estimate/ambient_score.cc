// How well a model describes an ambient record.

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/estimate/ambient_cost.h"

namespace pinode {
namespace {

// Parts of the band that are looked at for themselves, and points of a figure.
constexpr Eigen::Index kMostParts = 40;
constexpr Eigen::Index kGridPoints = 400;

// What the response to measured loads leaves should have nothing in common with
// it. In each part of the band the rest is explained by the response of each
// channel times a complex factor: where the model is right, the squares that go
// are a chi^2 of two degrees for each channel.
class Coherence {
 public:
  Coherence(const AmbientMean& mean, size_t parts)
      : mean_(mean),
        channels_(mean.left().rows()),
        grams_(parts, ComplexMatrix::Zero(channels_, channels_)),
        products_(parts, Eigen::VectorXcd::Zero(channels_)) {}

  // Lines first ... end - 1 of a part, whose S_y has the factor `lower`;
  // `weight`: how many independent lines each stands for. Adds what they have
  // of measured power and of that of the response.
  template <typename Lower>
  void Add(size_t part, Eigen::Index first, Eigen::Index end, double weight,
           const Lower& lower, Vector* measured, Vector* response) {
    ComplexMatrix both(channels_, channels_ + 1);
    for (Eigen::Index line = first; line < end; ++line) {
      const Eigen::VectorXcd run =
          mean_.measured().col(line) - mean_.left().col(line);
      *measured += weight * mean_.measured().col(line).cwiseAbs2();
      *response += weight * run.cwiseAbs2();
      both.leftCols(channels_) = run.asDiagonal();
      both.col(channels_) = mean_.left().col(line);
      lower.solveInPlace(both);
      const auto by_channel = both.leftCols(channels_);
      grams_[part].noalias() += weight * by_channel.adjoint() * by_channel;
      products_[part].noalias() +=
          weight * by_channel.adjoint() * both.col(channels_);
    }
  }

  // `fitted`: parameters of the response.
  void Finish(Eigen::Index fitted, AmbientScore* score) const {
    Eigen::Index degrees = -fitted;
    double chi_square = 0.0;
    for (size_t p = 0; p < grams_.size(); ++p) {
      // Channels that do not move take no part.
      const Vector scale =
          grams_[p].diagonal().real().cwiseMax(1e-300).cwiseSqrt();
      const ComplexMatrix gram = scale.cwiseInverse().asDiagonal() * grams_[p] *
                                 scale.cwiseInverse().asDiagonal();
      const Eigen::SelfAdjointEigenSolver<ComplexMatrix> eigen(gram);
      const Eigen::VectorXcd product = eigen.eigenvectors().adjoint() *
                                       products_[p].cwiseQuotient(scale);
      for (Eigen::Index i = 0; i < channels_; ++i) {
        if (!(eigen.eigenvalues()[i] > kNothing)) continue;
        chi_square += 2.0 * std::norm(product[i]) / eigen.eigenvalues()[i];
        degrees += 2;
      }
    }
    if (degrees <= 0) return;
    score->coherence_probability =
        ChiSquareProbability(chi_square, static_cast<int>(degrees));
  }

 private:
  // Of an eigenvalue: channels that say the same.
  static constexpr double kNothing = 1e-8;

  const AmbientMean& mean_;
  const Eigen::Index channels_;
  std::vector<ComplexMatrix> grams_;
  std::vector<Eigen::VectorXcd> products_;
};

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
  std::optional<Coherence> coherence;
  if (mean_ != nullptr) {
    coherence.emplace(*mean_, products.size());
    score->by_measured_loads = Vector::Zero(channels);
  }
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
    if (coherence.has_value()) {
      const Eigen::Index first = lines_.first[static_cast<size_t>(k)];
      const Eigen::Index end = lines_.first[static_cast<size_t>(k) + 1];
      Vector response = Vector::Zero(channels);
      Vector all = Vector::Zero(channels);
      coherence->Add(part, first, end, count / static_cast<double>(end - first),
                     factor.matrixL(), &all, &response);
      score->measured.col(point) += all - y.diagonal().real();
      score->modelled.col(point) += response;
      score->by_measured_loads += response;
      score->explained += response;
      total += response;
    }
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
  if (coherence.has_value()) {
    score->by_measured_loads.array() /= total.array();
    coherence->Finish(mean_->num_free(), score);
  }
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
