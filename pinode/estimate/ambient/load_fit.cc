#include "pinode/estimate/ambient/load_fit.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/constants.h"
#include "pinode/estimate/solver/information_solver.h"

namespace pinode {
namespace {

// Largest number of iterations, and the part of the cost that they may leave;
// at first, when the groups are still to be found.
constexpr int kMostScoringSteps = 40;
constexpr double kCostLeft = 0.01;
constexpr double kFirstCostLeft = 1.0;
// Largest relative fall of a covariance in a step; the firmness that holds it,
// at least, at most, and from one to the next.
constexpr double kLargestFall = 0.9;
constexpr double kLeastFirmness = 1e-3;
constexpr double kMostFirmness = 1e8;
constexpr double kFirmer = 4.0;
// The part of a step's promise that must come true; and the part beyond which
// the next step is held less.
constexpr double kLeastOfPromise = 0.1;
constexpr double kMostOfPromise = 0.7;
// Lines over whose mean noise is looked for.
constexpr double kLinesOfNoise = 32.0;

}  // namespace

LoadFit::LoadFit(const AmbientLikelihood& likelihood,
                 const LoadSpectrum& spectrum)
    : likelihood_(likelihood),
      loads_(spectrum, likelihood.lines().smallest_noise()) {}

void LoadFit::Start() {
  const AmbientLines& lines = likelihood_.lines();
  double measured = 0.0;
  double unit = 0.0;
  for (Eigen::Index k = 0; k < lines.size(); ++k) {
    unit += lines.count(k) * likelihood_.transfer().at(k).squaredNorm();
    measured += lines.products(k).diagonal().real().sum();
  }
  // Noise is no more than the least of the density.
  Vector noise(loads_.num_channels());
  for (Eigen::Index c = 0; c < noise.size(); ++c) {
    double least = kInfinity;
    double sum = 0.0;
    double count = 0.0;
    for (Eigen::Index k = 0; k < lines.size(); ++k) {
      sum += lines.products(k)(c, c).real();
      count += lines.count(k);
      if (count < kLinesOfNoise) continue;
      least = std::min(least, sum / count);
      sum = count = 0.0;
    }
    if (!std::isfinite(least)) least = sum / std::max(1.0, count);
    noise[c] =
        0.5 * std::log(std::max(0.5 * least, loads_.smallest_noise()[c]));
  }
  const LoadSpectrum& spectrum = loads_.spectrum();
  loads_.SetIntensities(
      Matrix::Constant(spectrum.num_areas(), spectrum.num_knots(),
                       0.5 * measured / std::max(unit, 1e-300)),
      noise);
}

bool LoadFit::Step(const LikelihoodSums& sums, double left, double* cost,
                   bool* done) {
  *done = false;
  const Matrix metric = loads_.RelativeMetric();
  firmness_ = std::clamp(firmness_, kLeastFirmness, kMostFirmness / kFirmer);
  const Vector before = loads_.unknowns();
  for (; firmness_ < kMostFirmness; firmness_ *= kFirmer) {
    const InformationSolver solver(sums.information + firmness_ * metric);
    if (!solver.ok()) continue;
    const Vector step = solver.Solve(-sums.gradient);
    if (loads_.LargestFall(before, step) > kLargestFall) continue;
    const double promised = -0.5 * sums.gradient.dot(step);
    if (!(promised > left)) {
      // Not where a step was refused.
      loads_.SetUnknowns(before);
      *cost -= std::max(0.0, promised);
      *done = true;
      return true;
    }
    loads_.SetUnknowns(loads_.Moved(before, step));
    double next = 0.0;
    const double kept =
        loads_.unknowns().allFinite() &&
                likelihood_.Sum(loads_, AmbientDerivatives::kNone, &next,
                                nullptr)
            ? (*cost - next) / promised
            : 0.0;
    if (kept >= kLeastOfPromise) {
      if (kept > kMostOfPromise) firmness_ /= kFirmer * kFirmer;
      *cost = next;
      return true;
    }
  }
  loads_.SetUnknowns(before);
  return false;
}

bool LoadFit::Improve(double* cost) {
  const double left = known_ ? kCostLeft : kFirstCostLeft;
  LikelihoodSums sums;
  if (!likelihood_.Sum(loads_, AmbientDerivatives::kLoads, cost, &sums)) {
    return false;
  }
  for (int iteration = 0; iteration < kMostScoringSteps; ++iteration) {
    loads_.HoldNoise(&sums);
    bool done = false;
    if (!Step(sums, left, cost, &done) || done) break;
    double at_step = 0.0;
    if (!likelihood_.Sum(loads_, AmbientDerivatives::kLoads, &at_step, &sums)) {
      break;
    }
    *cost = at_step;
  }
  return true;
}

bool LoadFit::FindFrom(const Vector& start, double* cost) {
  loads_.SetUnknowns(start);
  return Improve(cost);
}

bool LoadFit::FindFirst(double* cost) {
  const LoadSpectrum spectrum = loads_.spectrum();
  loads_.MakeUncorrelated();
  Start();
  if (!Improve(cost)) {
    loads_.SetSpectrum(spectrum);
    return false;
  }
  loads_.SetPowers();
  if (spectrum.correlated()) loads_.MakeCorrelated(spectrum);
  known_ = Improve(cost);
  return known_;
}

}  // namespace pinode
