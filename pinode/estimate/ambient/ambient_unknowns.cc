// The unknown loads and noise of an ambient record: those of least cost.

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>

#include "pinode/base/constants.h"
#include "pinode/estimate/ambient/ambient_cost.h"
#include "pinode/estimate/solver/information_solver.h"
#include "pinode/problem/load_information.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Of the fit of loads and noise: iterations, and what it may leave of the cost;
// at first, when the groups are still to be found.
constexpr int kMostScoringSteps = 40;
constexpr double kCostLeft = 0.01;
constexpr double kFirstCostLeft = 1.0;
// By how much covariances may fall in a step; how firmly it is held, in lines
// that have seen the loads: at least, at most, and from one to the next.
constexpr double kLargestFall = 0.9;
constexpr double kLeastFirmness = 1e-3;
constexpr double kMostFirmness = 1e8;
constexpr double kFirmer = 4.0;
// Of what a step promises of the cost, so much must come true; and more than so
// much before the next one is held less.
constexpr double kLeastOfPromise = 0.1;
constexpr double kMostOfPromise = 0.7;
// Of the largest information on a combination of groups: less is none.
constexpr double kNoInformation = 1e-12;
// Of the prior's weight, where it should take no part.
constexpr double kPriorLeft = 0.01;
// Lines over whose mean noise is looked for.
constexpr double kLinesOfNoise = 32.0;
// The least of the intensities that covariances are held to beside that at the
// next knot, and beside the mean of all.
constexpr double kLeastOfNeighbour = 0.1;
constexpr double kLeastOfMean = 1e-3;
}  // namespace

void AmbientCost::StartUnknowns() {
  double measured = 0.0;
  double unit = 0.0;
  for (size_t k = 0; k < transfer_.size(); ++k) {
    unit +=
        lines_.count[static_cast<Eigen::Index>(k)] * transfer_[k].squaredNorm();
    measured += lines_.products[k].diagonal().real().sum();
  }
  unknowns_.resize(spectrum_->num_unknowns() + scales_.size());
  unknowns_ << spectrum_->Intensities(
      Matrix::Constant(spectrum_->num_areas(), spectrum_->num_knots(),
                       0.5 * measured / std::max(unit, 1e-300))),
      Vector::Zero(scales_.size());
  // Noise is no more than the least of the density.
  for (Eigen::Index c = 0; c < scales_.size(); ++c) {
    double least = kInfinity;
    double sum = 0.0;
    double count = 0.0;
    for (Eigen::Index k = 0; k < num_lines(); ++k) {
      sum += lines_.products[static_cast<size_t>(k)](c, c).real();
      count += lines_.count[k];
      if (count < kLinesOfNoise) continue;
      least = std::min(least, sum / count);
      sum = count = 0.0;
    }
    if (!std::isfinite(least)) least = sum / std::max(1.0, count);
    unknowns_[spectrum_->num_unknowns() + c] =
        0.5 * std::log(std::max(0.5 * least, smallest_noise_[c]));
  }
}

void AmbientCost::HoldNoise(Sums* sums) const {
  const Eigen::Index loads = spectrum_->num_unknowns();
  const Vector smallest = 0.5 * smallest_noise_.array().log();
  for (Eigen::Index c = loads; c < unknowns_.size(); ++c) {
    if (unknowns_[c] > smallest[c - loads] || sums->gradient[c] < 0.0) continue;
    sums->gradient[c] = 0.0;
    sums->information.row(c).setZero();
    sums->information.col(c).setZero();
    sums->information(c, c) = 1.0;
    if (sums->products.size() == 0) continue;
    sums->products.row(c).setZero();
    sums->products.col(c).setZero();
  }
}

void AmbientCost::AddPrior(double* cost, Sums* sums) const {
  const Eigen::Index per_knot = spectrum_->per_knot();
  for (Eigen::Index b = 0; b < prior_.cols(); ++b) {
    const Matrix root = spectrum_->Root(unknowns_, static_cast<int>(b));
    const Matrix half = root.triangularView<Eigen::Lower>().solve(
        Matrix(prior_.col(b).cwiseSqrt().asDiagonal()));
    const Matrix inverse = root.triangularView<Eigen::Lower>().solve(
        Matrix::Identity(root.rows(), root.cols()));
    *cost += kPriorLines * (2.0 * root.diagonal().array().abs().log().sum() +
                            half.squaredNorm());
    if (sums == nullptr) continue;
    const Matrix precision = inverse.transpose() * inverse;
    const Matrix pull = precision * prior_.col(b).asDiagonal() * precision;
    sums->gradient.segment(b * per_knot, per_knot) +=
        ByLoadEntries(*spectrum_, root, kPriorLines * (precision - pull));
    LoadInformation information(*spectrum_);
    information.Add(precision.cast<Complex>(), kPriorLines, 1.0, 0.0);
    sums->information.block(b * per_knot, b * per_knot, per_knot, per_knot) +=
        information.Finish(root, root).topLeftCorner(per_knot, per_knot);
  }
}

Vector AmbientCost::Moved(const Vector& unknowns, const Vector& step) const {
  constexpr double kMostFall = 0.1;  // of a variance
  const Eigen::Index noise = scales_.size();
  const Eigen::Index loads = unknowns.size() - noise;
  Vector moved(unknowns.size());
  moved << spectrum_->Moved(unknowns.head(loads), step.head(loads)),
      (unknowns.tail(noise).array() +
       0.5 * (1.0 + 2.0 * step.tail(noise).array()).max(kMostFall).log())
          .max(0.5 * smallest_noise_.array().log());
  return moved;
}

Matrix AmbientCost::MetricOfKnot(int knot) const {
  const Eigen::Index per_knot = spectrum_->per_knot();
  const Matrix root = spectrum_->Root(unknowns_, knot);
  const Matrix inverse = root.triangularView<Eigen::Lower>().solve(
      Matrix::Identity(root.rows(), root.cols()));
  LoadInformation information(*spectrum_);
  information.Add((inverse.transpose() * inverse).cast<Complex>(), 1.0, 1.0,
                  0.0);
  return information.Finish(root, root).topLeftCorner(per_knot, per_knot);
}

Matrix AmbientCost::RelativeMetric() const {
  const Eigen::Index per_knot = spectrum_->per_knot();
  Matrix metric = Matrix::Zero(num_nuisance(), num_nuisance());
  for (int b = 0; b < spectrum_->num_knots(); ++b) {
    metric.block(b * per_knot, b * per_knot, per_knot, per_knot) =
        MetricOfKnot(b);
  }
  metric.diagonal().tail(scales_.size()).setConstant(kMetricOfNoise);
  return metric;
}

// Fisher scoring. Covariances may not fall by all of themselves in a step: what
// would goes by a part of itself, held by the metric of relative changes, and
// all else by as much as it wants. (Cut off afterwards, such steps are none
// that lower the cost.)
bool AmbientCost::FitUnknowns(double* cost) {
  const double left = unknowns_known_ ? kCostLeft : kFirstCostLeft;
  failure_ = "the spectrum of the channels is not positive definite";
  Sums sums;
  if (!Accumulate(false, cost, &sums)) return false;
  const Eigen::Index loads = spectrum_->num_unknowns();
  double& firmness = firmness_;
  for (int iteration = 0; iteration < kMostScoringSteps; ++iteration) {
    HoldNoise(&sums);
    const Matrix metric = RelativeMetric();
    firmness = std::clamp(firmness, kLeastFirmness, kMostFirmness / kFirmer);
    const Vector before = unknowns_;
    bool is_lower = false;
    double next = 0.0;
    double kept = 0.0;
    while (!is_lower && firmness < kMostFirmness) {
      const InformationSolver solver(sums.information + firmness * metric);
      Vector step;
      if (solver.ok()) step = solver.Solve(-sums.gradient);
      if (!solver.ok() ||
          spectrum_->LargestFall(before, step.head(loads)) > kLargestFall ||
          -2.0 * step.tail(scales_.size()).minCoeff() > kLargestFall) {
        firmness *= kFirmer;
        continue;
      }
      const double promised = -0.5 * sums.gradient.dot(step);
      if (!(promised > left)) {
        // Not where a step was refused.
        unknowns_ = before;
        *cost -= std::max(0.0, promised);
        failure_.clear();
        return true;
      }
      unknowns_ = Moved(before, step);
      kept = unknowns_.allFinite() && Accumulate(false, &next, nullptr)
                 ? (*cost - next) / promised
                 : 0.0;
      is_lower = kept >= kLeastOfPromise;
      if (!is_lower) firmness *= kFirmer;
    }
    if (!is_lower) {
      unknowns_ = before;
      break;
    }
    if (kept > kMostOfPromise) firmness /= kFirmer * kFirmer;
    if (!Accumulate(false, cost, &sums)) {
      *cost = next;
      break;
    }
  }
  failure_.clear();
  return true;
}

AmbientCost::Sums AmbientCost::PriorSums(double* cost) const {
  Sums prior;
  prior.gradient = Vector::Zero(num_nuisance());
  prior.information = Matrix::Zero(num_nuisance(), num_nuisance());
  double of_prior = 0.0;
  AddPrior(&of_prior, &prior);
  if (cost != nullptr) *cost = of_prior;
  return prior;
}

double AmbientCost::NumFitted() const {
  double ignored = 0.0;
  Sums sums;
  if (!Accumulate(false, &ignored, &sums)) return 0.0;
  const InformationSolver solver(sums.information);
  const double held =
      solver.ok() ? solver.Solve(PriorInformation()).trace() : 0.0;
  return static_cast<double>(num_nuisance()) - held +
         static_cast<double>(columns_.size());
}

void AmbientCost::FindInformationLeft(const Matrix& information) {
  const Eigen::Index nuisance = num_nuisance();
  const Eigen::Index groups = static_cast<Eigen::Index>(columns_.size());
  information_left_ = Vector::Zero(groups);
  most_information_left_ = groups > 0 ? 0.0 : 1.0;
  if (groups == 0) return;
  const Matrix known = information.bottomRightCorner(groups, groups);
  const Matrix cross = information.bottomLeftCorner(groups, nuisance);
  // A little of the prior stays, for what no channel sees.
  const InformationSolver loads(information.topLeftCorner(nuisance, nuisance) -
                                (1.0 - kPriorLeft) * PriorInformation());
  if (!loads.ok()) return;
  const Matrix left = known - cross * loads.Solve(cross.transpose());
  // In units in which the known information is one, but for what no load at
  // all would tell.
  const Vector scale = known.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(
      scale.cwiseInverse().asDiagonal() * known *
      scale.cwiseInverse().asDiagonal());
  const Vector& values = eigen.eigenvalues();
  const Eigen::Index seen = (values.array() > kNoInformation).count();
  if (seen == 0) return;
  const Matrix basis =
      scale.cwiseInverse().asDiagonal() * eigen.eigenvectors().rightCols(seen) *
      values.tail(seen).cwiseSqrt().cwiseInverse().asDiagonal();
  const Matrix part = basis.transpose() * left * basis;
  const Eigen::SelfAdjointEigenSolver<Matrix> parts(0.5 *
                                                    (part + part.transpose()));
  most_information_left_ = std::clamp(parts.eigenvalues()[seen - 1], 0.0, 1.0);
  const Vector variances =
      parts.eigenvalues().cwiseMax(kNoInformation).cwiseInverse();
  const Matrix by_part = basis * parts.eigenvectors();
  for (Eigen::Index g = 0; g < groups; ++g) {
    const Vector row = by_part.row(g).transpose().cwiseAbs2();
    const double with_loads = row.dot(variances);
    information_left_[g] =
        with_loads > 0.0 ? std::min(1.0, row.sum() / with_loads) : 0.0;
  }
}

bool AmbientCost::FirstUnknowns(double* cost) {
  prior_.resize(0, 0);
  LoadSpectrum correlated = *spectrum_;
  *spectrum_ = correlated.Uncorrelated();
  StartUnknowns();
  if (!FitUnknowns(cost)) {
    *spectrum_ = correlated;
    return false;
  }
  spectrum_->SetPowers(unknowns_);
  if (correlated.correlated()) {
    const int knots = spectrum_->num_knots();
    Matrix intensities(spectrum_->num_areas(), knots);
    for (int b = 0; b < knots; ++b) {
      intensities.col(b) = spectrum_->Root(unknowns_, b).diagonal().cwiseAbs2();
    }
    prior_ = intensities;
    for (int b = 0; b < knots; ++b) {
      prior_.col(b) =
          prior_.col(b).cwiseMax(kLeastOfMean * intensities.col(b).mean());
      for (const int next : {b - 1, b + 1}) {
        if (next < 0 || next == knots) continue;
        prior_.col(b) =
            prior_.col(b).cwiseMax(kLeastOfNeighbour * intensities.col(next));
      }
    }
    const Vector noise = unknowns_.tail(scales_.size());
    correlated.SetPowers(*spectrum_);
    *spectrum_ = correlated;
    unknowns_.resize(spectrum_->num_unknowns() + noise.size());
    unknowns_ << spectrum_->Intensities(prior_), noise;
  }
  unknowns_known_ = FitUnknowns(cost);
  return unknowns_known_;
}

}  // namespace pinode
