// How well a model describes an ambient record.

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/estimate/ambient/ambient_cost.h"

namespace pinode {
namespace {

// Parts of the band that are looked at for themselves, and points of a figure.
constexpr Eigen::Index kMostParts = 40;
constexpr Eigen::Index kGridPoints = 400;

// What the response to measured loads leaves should have nothing in common with
// it. In each part of the band the rest is explained by the response of each
// channel times a complex factor: where the model is right, the squares that
// go, over the power that the whitened rest has there, are a chi^2 of two
// degrees for each channel. What groups take of it is not counted: most is held
// elsewhere, and it is little beside the degrees.
class Coherence {
 public:
  Coherence(const AmbientMean& mean, size_t parts)
      : mean_(mean),
        channels_(mean.rest().rows()),
        grams_(parts, ComplexMatrix::Zero(channels_, channels_)),
        products_(parts, Eigen::VectorXcd::Zero(channels_)),
        powers_(Vector::Zero(static_cast<Eigen::Index>(parts))),
        counts_(powers_) {}

  // Lines first ... end - 1 of a part, whose S_y has the factor `lower`;
  // `weight`: how many independent lines each stands for. The power of the
  // response in each channel.
  template <typename Lower>
  Vector Add(size_t part, Eigen::Index first, Eigen::Index end, double weight,
             const Lower& lower) {
    Vector power = Vector::Zero(channels_);
    ComplexMatrix both(channels_, channels_ + 1);
    for (Eigen::Index line = first; line < end; ++line) {
      const Eigen::VectorXcd run =
          mean_.measured().col(line) - mean_.rest().col(line);
      power += weight * run.cwiseAbs2();
      both.leftCols(channels_) = run.asDiagonal();
      both.col(channels_) = mean_.rest().col(line);
      lower.solveInPlace(both);
      const auto by_channel = both.leftCols(channels_);
      grams_[part].noalias() += weight * by_channel.adjoint() * by_channel;
      products_[part].noalias() +=
          weight * by_channel.adjoint() * both.col(channels_);
      const Eigen::Index place = static_cast<Eigen::Index>(part);
      powers_[place] += weight * both.col(channels_).squaredNorm();
      counts_[place] += weight * static_cast<double>(channels_);
    }
    return power;
  }

  void Finish(AmbientScore* score) const {
    Eigen::Index degrees = 0;
    double chi_square = 0.0;
    for (size_t p = 0; p < grams_.size(); ++p) {
      const Eigen::Index place = static_cast<Eigen::Index>(p);
      if (!(counts_[place] > 0.0)) continue;
      const double power = powers_[place] / counts_[place];
      // Channels that do not move take no part.
      const Vector scale =
          grams_[p].diagonal().real().cwiseMax(1e-300).cwiseSqrt();
      const ComplexMatrix gram = scale.cwiseInverse().asDiagonal() * grams_[p] *
                                 scale.cwiseInverse().asDiagonal();
      const Eigen::SelfAdjointEigenSolver<ComplexMatrix> eigen(gram);
      const Eigen::VectorXcd product =
          eigen.eigenvectors().adjoint() * products_[p].cwiseQuotient(scale);
      for (Eigen::Index i = 0; i < channels_; ++i) {
        if (!(eigen.eigenvalues()[i] > kNothing)) continue;
        chi_square +=
            2.0 * std::norm(product[i]) / (eigen.eigenvalues()[i] * power);
        degrees += 2;
      }
    }
    if (degrees == 0) return;
    score->coherence_probability =
        ChiSquareProbability(chi_square, static_cast<double>(degrees));
  }

 private:
  // Of an eigenvalue: channels that say the same.
  static constexpr double kNothing = 1e-8;

  const AmbientMean& mean_;
  const Eigen::Index channels_;
  std::vector<ComplexMatrix> grams_;
  std::vector<Eigen::VectorXcd> products_;
  Vector powers_, counts_;  // of the whitened rest, in all channels
};

// Of z z^H the mean Q over n neighbouring lines is I but for chance: n |Q -
// I|^2 has the expectation channels^2, and the variance 2 channels^2 of a chi^2
// where n is large; 1 + 2 channels / n times that otherwise, as r times a chi^2
// of channels^2 / r degrees has.
class Whiteness {
 public:
  Whiteness(Eigen::Index parts, Eigen::Index channels, double total_count)
      : channels_(channels),
        square_(static_cast<double>(channels * channels)),
        r_(1.0 + 2.0 * static_cast<double>(channels * parts) / total_count),
        parts_(static_cast<size_t>(parts),
               {ComplexMatrix::Zero(channels, channels), 0.0, kInfinity, 0.0}) {
  }

  // `products`: sum of z z^H, of so many lines at a frequency.
  void Add(size_t part, const ComplexMatrix& products, double count,
           double frequency) {
    Part& own = parts_[part];
    own.products += products;
    own.count += count;
    own.from = std::min(own.from, frequency);
    own.to = std::max(own.to, frequency);
  }

  // `fitted`: unknowns of the spectra.
  void Finish(double fitted, AmbientScore* score) const {
    for (size_t p = 0; p < parts_.size(); ++p) {
      const Part& part = parts_[p];
      if (part.count == 0.0) continue;
      const ComplexMatrix off = part.products / part.count -
                                ComplexMatrix::Identity(channels_, channels_);
      const double value = part.count * off.squaredNorm();
      score->chi_square += value / r_;
      const double deviation =
          (value - square_) / std::sqrt(2.0 * r_ * square_);
      if (p == 0 || deviation > score->worst_deviation) {
        score->worst_deviation = deviation;
        score->worst_from = part.from;
        score->worst_to = part.to;
      }
    }
    const double numbers = square_ * static_cast<double>(parts_.size());
    score->degrees_of_freedom = std::max<Eigen::Index>(
        1, static_cast<Eigen::Index>((numbers - fitted) / r_));
    score->probability = ChiSquareProbability(
        score->chi_square, static_cast<double>(score->degrees_of_freedom));
  }

 private:
  struct Part {
    ComplexMatrix products;
    double count = 0.0;
    double from = kInfinity;
    double to = 0.0;
  };

  const Eigen::Index channels_;
  const double square_;
  const double r_;
  std::vector<Part> parts_;
};

}  // namespace

bool AmbientCost::Score(const Vector& free, AmbientScore* score) {
  CondensedSystem ignored;
  double cost = 0.0;
  if (!Linearize(free, &ignored) || !Evaluate(free, &cost)) return false;
  FindTransfer(/*all=*/true);
  *score = BlankScore();
  const Eigen::Index channels = scales_.size();
  const Eigen::Index lines = num_lines();
  const double total_count = lines_.count.sum();
  const Eigen::Index parts =
      std::clamp<Eigen::Index>(lines / (8 * channels + 40), 1, kMostParts);
  const Eigen::Index points = score->frequencies.size();
  const Vector noise =
      (2.0 * unknowns_.tail(channels)).array().exp();  // densities
  Whiteness whiteness(parts, channels, total_count);
  std::optional<Coherence> coherence;
  if (mean_ != nullptr) coherence.emplace(*mean_, static_cast<size_t>(parts));
  const std::vector<Matrix> at_knots = KnotCovariances();
  Eigen::LLT<ComplexMatrix> factor;
  double seen = 0.0;
  Vector total = Vector::Zero(channels);
  for (Eigen::Index k = 0; k < lines; ++k) {
    const double frequency = lines_.frequency[k];
    if (!FactorizeLine(k, LoadCovariance(frequency, at_knots), &factor)) {
      return false;
    }
    const auto lower = factor.matrixL();
    const size_t part = static_cast<size_t>(
        std::min(static_cast<double>(parts - 1),
                 std::floor(seen * static_cast<double>(parts) / total_count)));
    const double count = lines_.count[k];
    seen += count;
    const ComplexMatrix& y = lines_.products[static_cast<size_t>(k)];
    const ComplexMatrix half = lower.solve(y);
    whiteness.Add(part, lower.solve(half.adjoint().eval()), count, frequency);
    const Vector modelled =
        count * factor.reconstructedMatrix().diagonal().real();
    score->explained += modelled - count * noise;
    total += modelled;
    if (coherence.has_value()) {
      const Eigen::Index first = lines_.first[static_cast<size_t>(k)];
      const Eigen::Index end = lines_.first[static_cast<size_t>(k) + 1];
      const Vector response = coherence->Add(
          part, first, end, count / static_cast<double>(end - first), lower);
      score->by_measured_loads += response;
      score->explained += response;
      total += response;
    }
    const Eigen::Index point = k * points / lines;
    score->frequencies[point] += count * frequency;
    score->measured.col(point) += y.diagonal().real();
    score->modelled.col(point) += modelled;
    score->lines[point] += count;
  }
  score->frequencies.array() /= score->lines.array();
  for (Matrix* density : {&score->measured, &score->modelled}) {
    *density = scales_.cwiseAbs2().asDiagonal() * *density *
               score->lines.cwiseInverse().asDiagonal();
  }
  score->explained.array() /= total.array();
  whiteness.Finish(NumFitted(), score);
  if (coherence.has_value()) {
    score->by_measured_loads.array() /= total.array();
    coherence->Finish(score);
  }
  return true;
}

AmbientScore AmbientCost::BlankScore() const {
  const Eigen::Index channels = scales_.size();
  const Eigen::Index points = std::min<Eigen::Index>(num_lines(), kGridPoints);
  AmbientScore score;
  score.name = record_.name;
  score.lowest_frequency = lines_.frequency[0];
  score.highest_frequency = lines_.frequency[num_lines() - 1];
  score.num_lines = static_cast<Eigen::Index>(total_lines_);
  score.num_knots = spectrum_->num_knots();
  for (const Column& column : columns_) {
    score.groups.push_back(layout_.free_parameter(column.free).name);
  }
  score.information_left = information_left_;
  score.most_information_left = most_information_left_;
  for (const Observation& channel : record_.channels) {
    score.channels.push_back(channel.name);
  }
  // A one-sided density up to half the sampling rate.
  score.noise_sigma =
      std::sqrt(0.5 / record_.sampling_step) *
      scales_.cwiseProduct(unknowns_.tail(channels).array().exp().matrix());
  score.explained = Vector::Zero(channels);
  if (mean_ != nullptr) score.by_measured_loads = Vector::Zero(channels);
  score.frequencies = Vector::Zero(points);
  score.measured = Matrix::Zero(channels, points);
  score.modelled = Matrix::Zero(channels, points);
  score.lines = Vector::Zero(points);
  return score;
}

}  // namespace pinode
