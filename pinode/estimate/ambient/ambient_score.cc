#include "pinode/estimate/ambient/ambient_score.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/estimate/solver/information_solver.h"

namespace pinode {
namespace {

// Number of parts of the band that are tested, and of points of a figure.
constexpr Eigen::Index kMostParts = 40;
constexpr Eigen::Index kGridPoints = 400;

// The rest that the response to measured loads leaves should have nothing in
// common with it. In each part of the band the rest is explained by the
// response of each channel times a complex factor: where the model is right,
// the squares that go, over the power that the whitened rest has there, are a
// chi^2 of two degrees for each channel. What groups take of it is not counted:
// most is held elsewhere, and it is little beside the degrees.
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

// The score of what needs no sum over the lines, and room for the rest.
AmbientScore BlankScore(const AmbientCost& cost) {
  const AmbientLines& lines = cost.lines();
  const Eigen::Index channels = lines.scales().size();
  const Eigen::Index points = std::min<Eigen::Index>(lines.size(), kGridPoints);
  AmbientScore score;
  score.name = cost.record().name;
  score.lowest_frequency = lines.frequency(0);
  score.highest_frequency = lines.frequency(lines.size() - 1);
  score.num_lines = lines.num_single();
  score.num_knots = cost.loads().spectrum().num_knots();
  for (const FreeGroup& group : cost.transfer().groups()) {
    score.groups.push_back(group.name);
  }
  score.information_left = cost.information_left().by_group;
  score.most_information_left = cost.information_left().most;
  for (const Observation& channel : cost.record().channels) {
    score.channels.push_back(channel.name);
  }
  // A one-sided density up to half the sampling rate.
  score.noise_sigma =
      std::sqrt(0.5 / cost.record().sampling_step) *
      lines.scales().cwiseProduct(
          cost.loads().unknowns().tail(channels).array().exp().matrix());
  score.explained = Vector::Zero(channels);
  if (lines.mean() != nullptr) score.by_measured_loads = Vector::Zero(channels);
  score.frequencies = Vector::Zero(points);
  score.measured = Matrix::Zero(channels, points);
  score.modelled = Matrix::Zero(channels, points);
  score.lines = Vector::Zero(points);
  return score;
}

// Number of unknowns that the record determines: all, less those that the prior
// does.
double NumFitted(const AmbientCost& cost) {
  const AmbientLoads& loads = cost.loads();
  double ignored = 0.0;
  LikelihoodSums sums;
  if (!cost.likelihood().Sum(loads, AmbientDerivatives::kLoads, &ignored,
                             &sums)) {
    return 0.0;
  }
  const InformationSolver solver(sums.information);
  const double held =
      solver.ok() ? solver.Solve(loads.PriorSums(nullptr).information).trace()
                  : 0.0;
  return static_cast<double>(loads.num_unknowns()) - held +
         static_cast<double>(cost.transfer().num_groups());
}

}  // namespace

bool ScoreAmbient(const Vector& free, AmbientCost* cost, AmbientScore* score) {
  if (!cost->SetPoint(free)) return false;
  cost->CompleteTransfer();
  *score = BlankScore(*cost);
  const AmbientLines& lines = cost->lines();
  const AmbientLoads& loads = cost->loads();
  const Eigen::Index channels = lines.scales().size();
  const double total_count = lines.groups().count.sum();
  const Eigen::Index parts = std::clamp<Eigen::Index>(
      lines.size() / (8 * channels + 40), 1, kMostParts);
  const Eigen::Index points = score->frequencies.size();
  const Vector noise = loads.Noise();
  Whiteness whiteness(parts, channels, total_count);
  std::optional<Coherence> coherence;
  if (lines.mean() != nullptr) {
    coherence.emplace(*lines.mean(), static_cast<size_t>(parts));
  }
  const std::vector<Matrix> at_knots = loads.KnotCovariances();
  ComplexFactor factor;
  double seen = 0.0;
  Vector total = Vector::Zero(channels);
  for (Eigen::Index k = 0; k < lines.size(); ++k) {
    const double frequency = lines.frequency(k);
    if (!cost->likelihood().FactorizeLine(
            k, loads, loads.Covariance(frequency, at_knots), &factor)) {
      return false;
    }
    const auto lower = factor.matrixL();
    const size_t part = static_cast<size_t>(
        std::min(static_cast<double>(parts - 1),
                 std::floor(seen * static_cast<double>(parts) / total_count)));
    const double count = lines.count(k);
    seen += count;
    const ComplexMatrix& y = lines.products(k);
    const ComplexMatrix half = lower.solve(y);
    whiteness.Add(part, lower.solve(half.adjoint().eval()), count, frequency);
    const Vector modelled =
        count * factor.reconstructedMatrix().diagonal().real();
    score->explained += modelled - count * noise;
    total += modelled;
    if (coherence.has_value()) {
      const Eigen::Index first = lines.groups().first[static_cast<size_t>(k)];
      const Eigen::Index end = lines.groups().first[static_cast<size_t>(k) + 1];
      const Vector response = coherence->Add(
          part, first, end, count / static_cast<double>(end - first), lower);
      score->by_measured_loads += response;
      score->explained += response;
      total += response;
    }
    const Eigen::Index point = k * points / lines.size();
    score->frequencies[point] += count * frequency;
    score->measured.col(point) += y.diagonal().real();
    score->modelled.col(point) += modelled;
    score->lines[point] += count;
  }
  score->frequencies.array() /= score->lines.array();
  for (Matrix* density : {&score->measured, &score->modelled}) {
    *density = lines.scales().cwiseAbs2().asDiagonal() * *density *
               score->lines.cwiseInverse().asDiagonal();
  }
  score->explained.array() /= total.array();
  whiteness.Finish(NumFitted(*cost), score);
  if (coherence.has_value()) {
    score->by_measured_loads.array() /= total.array();
    coherence->Finish(score);
  }
  return true;
}

}  // namespace pinode
