// What the evidence says of the spectrum of an ambient record's loads.

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>

#include "pinode/estimate/ambient/ambient_cost.h"
#include "pinode/estimate/solver/information_solver.h"

namespace pinode {

bool AmbientCost::PriceOfLoads(Matrix information, double* price) const {
  const Eigen::Index per_knot = spectrum_->per_knot();
  // L^-1 I L^-T, I_0 = L L^T, a knot at a time.
  for (int b = 0; b < spectrum_->num_knots(); ++b) {
    const Eigen::LLT<Matrix> known(kPriorLines * MetricOfKnot(b));
    if (known.info() != Eigen::Success) return false;
    auto rows = information.middleRows(b * per_knot, per_knot);
    known.matrixL().solveInPlace(rows);
    auto columns = information.middleCols(b * per_knot, per_knot);
    known.matrixU().solveInPlace<Eigen::OnTheRight>(columns);
  }
  const double of_noise = 1.0 / std::sqrt(kPriorLines * kMetricOfNoise);
  information.bottomRows(scales_.size()) *= of_noise;
  information.rightCols(scales_.size()) *= of_noise;
  information.diagonal().array() += 1.0;
  // In place, for it may be large.
  const Eigen::LLT<Eigen::Ref<Matrix>> factor(information);
  if (factor.info() != Eigen::Success) return false;
  *price = information.diagonal().array().log().sum();
  return std::isfinite(*price);
}

bool AmbientCost::StepOfLoads(const Sums& sums, Vector* step) const {
  if (prior_.size() > 0) {
    const InformationSolver solver(sums.information);
    if (!solver.ok()) return false;
    *step = solver.Solve(-sums.gradient);
    return true;
  }
  // Loads that the record does not tell would go anywhere.
  Matrix held = sums.information;
  held.topLeftCorner(num_nuisance(), num_nuisance()) +=
      kPriorLines * RelativeMetric();
  const InformationSolver solver(held);
  if (!solver.ok()) return false;
  *step = solver.Solve(-sums.gradient);
  return true;
}

bool AmbientCost::PromiseOfLoads(double* gain, double* price) const {
  double ignored = 0.0;
  Sums sums;
  sums.with_products = false;
  if (!Accumulate(/*with_groups=*/true, &ignored, &sums)) return false;
  HoldNoise(&sums);
  const Eigen::Index nuisance = num_nuisance();
  // The groups are at their best, if only with other records.
  sums.gradient.tail(sums.gradient.size() - nuisance).setZero();
  Vector step;
  if (!StepOfLoads(sums, &step)) return false;
  // Of the likelihood alone.
  {
    const Sums prior = PriorSums(nullptr);
    sums.gradient.head(nuisance) -= prior.gradient;
    sums.information.topLeftCorner(nuisance, nuisance) -= prior.information;
  }
  *gain = -sums.gradient.dot(step) - 0.5 * step.dot(sums.information * step);
  sums.information.conservativeResize(nuisance, nuisance);
  return std::isfinite(*gain) &&
         PriceOfLoads(std::move(sums.information), price);
}

LoadEvidence AmbientCost::JudgeLoads(const Vector& free) {
  LoadEvidence evidence;
  CondensedSystem of_groups;
  double cost = 0.0;
  Sums sums;
  // The slopes of what is measured are then those of this point.
  if (!Linearize(free, &of_groups) || !Evaluate(free, &cost) ||
      !Accumulate(/*with_groups=*/false, &cost, &sums)) {
    return evidence;
  }
  HoldNoise(&sums);
  double of_prior = 0.0;
  sums.information -= PriorSums(&of_prior).information;
  if (!PriceOfLoads(std::move(sums.information), &evidence.price)) {
    return evidence;
  }
  evidence.log_likelihood = offset_ + of_prior - cost;
  if (spectrum_->num_knots() < 2) return evidence;
  Vector unknowns;
  LoadSpectrum finer =
      spectrum_->Refined(unknowns_.head(spectrum_->num_unknowns()), &unknowns);
  if (finer.num_unknowns() > kMostLoadUnknowns) return evidence;
  Matrix prior;
  if (prior_.size() > 0) {
    Vector roots;
    spectrum_->Refined(spectrum_->Intensities(prior_), &roots);
    prior.resize(prior_.rows(), finer.num_knots());
    for (int b = 0; b < finer.num_knots(); ++b) {
      prior.col(b) = finer.Root(roots, b).diagonal().cwiseAbs2();
    }
  }
  const Vector noise = unknowns_.tail(scales_.size());
  unknowns.conservativeResize(unknowns.size() + noise.size());
  unknowns.tail(noise.size()) = noise;
  const auto exchange = [&] {
    std::swap(*spectrum_, finer);
    unknowns_.swap(unknowns);
    prior_.swap(prior);
  };
  exchange();
  double gain = 0.0;
  double price = 0.0;
  const bool known = PromiseOfLoads(&gain, &price);
  const int knots = spectrum_->num_knots();
  exchange();
  if (!known) return evidence;
  evidence.finer_knots = knots;
  evidence.finer_gain = gain;
  evidence.finer_price = price - evidence.price;
  return evidence;
}

}  // namespace pinode
