#include "pinode/estimate/ambient/ambient_evidence.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>

#include "pinode/estimate/solver/information_solver.h"

namespace pinode {
namespace {

// Price in the evidence of loads and noise on which the likelihood has
// this information. False where it is none.
[[nodiscard]] bool PriceOfLoads(const AmbientLoads& loads, Matrix information,
                                double* price) {
  const LoadSpectrum& spectrum = loads.spectrum();
  const Eigen::Index per_knot = spectrum.per_knot();
  // L^-1 I L^-T, I_0 = L L^T, a knot at a time.
  for (int b = 0; b < spectrum.num_knots(); ++b) {
    const Eigen::LLT<Matrix> known(
        Matrix(AmbientLoads::kPriorLines * loads.MetricOfKnot(b)));
    if (known.info() != Eigen::Success) return false;
    auto rows = information.middleRows(b * per_knot, per_knot);
    known.matrixL().solveInPlace(rows);
    auto columns = information.middleCols(b * per_knot, per_knot);
    known.matrixU().solveInPlace<Eigen::OnTheRight>(columns);
  }
  const double of_noise =
      1.0 / std::sqrt(AmbientLoads::kPriorLines * AmbientLoads::kMetricOfNoise);
  information.bottomRows(loads.num_channels()) *= of_noise;
  information.rightCols(loads.num_channels()) *= of_noise;
  information.diagonal().array() += 1.0;
  // In place, for it may be large.
  const Eigen::LLT<Eigen::Ref<Matrix>> factor(information);
  if (factor.info() != Eigen::Success) return false;
  *price = information.diagonal().array().log().sum();
  return std::isfinite(*price);
}

// The step of loads, noise and groups from where `sums` are, held as far as
// they have to be.
[[nodiscard]] bool StepOfLoads(const AmbientLoads& loads,
                               const LikelihoodSums& sums, Vector* step) {
  if (loads.has_prior()) {
    const InformationSolver solver(sums.information);
    if (!solver.ok()) return false;
    *step = solver.Solve(-sums.gradient);
    return true;
  }
  // Loads that the record does not tell would go anywhere.
  Matrix held = sums.information;
  held.topLeftCorner(loads.num_unknowns(), loads.num_unknowns()) +=
      AmbientLoads::kPriorLines * loads.RelativeMetric();
  const InformationSolver solver(held);
  if (!solver.ok()) return false;
  *step = solver.Solve(-sums.gradient);
  return true;
}

// Gain and price of these loads, which are a finer description of the fitted
// ones. False where they cannot be told.
[[nodiscard]] bool PromiseOfLoads(const AmbientLikelihood& likelihood,
                                  const AmbientLoads& loads, double* gain,
                                  double* price) {
  double ignored = 0.0;
  LikelihoodSums sums;
  if (!likelihood.Sum(loads, AmbientDerivatives::kGroups, &ignored, &sums)) {
    return false;
  }
  loads.HoldNoise(&sums);
  const Eigen::Index nuisance = loads.num_unknowns();
  // The groups are at their best, if only with other records.
  sums.gradient.tail(sums.gradient.size() - nuisance).setZero();
  Vector step;
  if (!StepOfLoads(loads, sums, &step)) return false;
  // The likelihood alone, without the prior.
  {
    const LikelihoodSums prior = loads.PriorSums(nullptr);
    sums.gradient.head(nuisance) -= prior.gradient;
    sums.information.topLeftCorner(nuisance, nuisance) -= prior.information;
  }
  *gain = -sums.gradient.dot(step) - 0.5 * step.dot(sums.information * step);
  sums.information.conservativeResize(nuisance, nuisance);
  return std::isfinite(*gain) &&
         PriceOfLoads(loads, std::move(sums.information), price);
}

}  // namespace

LoadEvidence JudgeLoads(const Vector& free, AmbientCost* cost) {
  LoadEvidence evidence;
  const AmbientLikelihood& likelihood = cost->likelihood();
  const AmbientLoads& loads = cost->loads();
  double value = 0.0;
  LikelihoodSums sums;
  // The derivatives by measured loads are then those of this point.
  if (!cost->SetPoint(free) ||
      !likelihood.Sum(loads, AmbientDerivatives::kLoads, &value, &sums)) {
    return evidence;
  }
  loads.HoldNoise(&sums);
  double of_prior = 0.0;
  sums.information -= loads.PriorSums(&of_prior).information;
  if (!PriceOfLoads(loads, std::move(sums.information), &evidence.price)) {
    return evidence;
  }
  evidence.log_likelihood = cost->lines().offset() + of_prior - value;
  const LoadSpectrum& spectrum = loads.spectrum();
  if (spectrum.num_knots() < 2) return evidence;
  const int finer_knots = 2 * spectrum.num_knots() - 1;
  if (finer_knots * spectrum.per_knot() > kMostLoadUnknowns) return evidence;
  const AmbientLoads finer = loads.Refined();
  double gain = 0.0;
  double price = 0.0;
  if (!PromiseOfLoads(likelihood, finer, &gain, &price)) return evidence;
  evidence.finer_knots = finer_knots;
  evidence.finer_gain = gain;
  evidence.finer_price = price - evidence.price;
  return evidence;
}

}  // namespace pinode
