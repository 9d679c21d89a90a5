#include "pinode/study/terms/segment_proposal.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/discover/equation_values.h"
#include "pinode/discover/stepwise.h"
#include "pinode/estimate/certainty/fitted_cost.h"
#include "pinode/estimate/objective/objective.h"
#include "pinode/estimate/start/initial_states.h"
#include "pinode/estimate/start/stage_schedule.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/terms/discovered_problem.h"
#include "pinode/study/terms/term_proposal.h"
#include "pinode/study/terms/term_worth.h"

namespace pinode {
namespace {

// Gives all terms the coefficients of least squares on the equation's samples,
// without those that miss a value. Returns false without samples, or if a basis
// is no function of the features.
bool RegressAllTerms(DiscoveredEquation* equation) {
  Vector rest = equation->sample_outputs;
  if (rest.size() == 0 || equation->sample_features.rows() != rest.size()) {
    return false;
  }
  DiscoveredEquation single = *equation;
  std::vector<DiscoveredTerm*> free;
  Matrix columns(rest.size(),
                 static_cast<Eigen::Index>(equation->terms.size()));
  for (DiscoveredTerm& term : equation->terms) {
    single.terms = {term};
    if (!term.given) single.terms[0].coefficient = 1.0;
    EquationValues values;
    std::string unused;
    if (!EvaluateAtSamples(single, &values, &unused)) return false;
    if (term.given) {
      rest -= values.sum;
    } else {
      columns.col(static_cast<Eigen::Index>(free.size())) = values.sum;
      free.push_back(&term);
    }
  }
  if (free.empty()) return true;
  columns.conservativeResize(Eigen::NoChange,
                             static_cast<Eigen::Index>(free.size()));
  std::vector<Eigen::Index> present;
  for (Eigen::Index i = 0; i < rest.size(); ++i) {
    if (std::isfinite(rest[i]) && columns.row(i).allFinite()) {
      present.push_back(i);
    }
  }
  if (present.empty()) return false;
  columns = Matrix(columns(present, Eigen::all));
  rest = Vector(rest(present));
  const Vector scales =
      columns.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  const Vector scaled =
      (columns * scales.asDiagonal()).colPivHouseholderQr().solve(rest);
  for (size_t k = 0; k < free.size(); ++k) {
    const Eigen::Index i = static_cast<Eigen::Index>(k);
    const double coefficient = scaled[i] * scales[i];
    if (!std::isfinite(coefficient)) return false;
    free[k]->coefficient =
        free[k]->sign * coefficient < 0.0 ? 0.0 : coefficient;
  }
  return true;
}

// Cost of all candidates over short segments.
class SegmentCost {
 public:
  SegmentCost(const IdentificationProblem& problem, int num_threads)
      : problem_(problem),
        layout_(problem),
        objective_(problem, layout_, OptionsFor(num_threads)) {}

  const ParameterLayout& layout() const { return layout_; }

  // Fits all free parameters from those of `model`. Leaves the last
  // linearisation in *fitted.
  bool Fit(const IdentifiedModel& model, Vector* free, FittedCost* fitted) {
    // Gaps that are firm at once stop the steps before the coefficients have
    // followed. At the last value they leave no room beside the noise.
    constexpr double kFirmness[] = {0.01, 1.0, 100.0};
    constexpr int kSteps = 3;
    if (!Begin(model)) return false;
    *free = layout_.Free(model.parameters);
    CondensedSystem& system = fitted->system;
    for (const double firmness : kFirmness) {
      for (int step = 0; step < kSteps; ++step) {
        if (!objective_.Linearize(*free, &system) ||
            !system.hessian.allFinite()) {
          return false;
        }
        if (step == 0) {
          shooting().SetGapPenalty(
              firmness * std::max(1.0, shooting().state().data_curvature()));
          if (!objective_.Linearize(*free, &system)) return false;
        }
        if (!Step(system, free)) break;
      }
    }
    return objective_.Linearize(*free, &system) && system.hessian.allFinite() &&
           system.gradient.allFinite();
  }

 private:
  static MultipleShooting::Options OptionsFor(int num_threads) {
    MultipleShooting::Options options;
    options.num_threads = num_threads;
    return options;
  }

  MultipleShooting& shooting() { return objective_.shooting(); }

  bool Begin(const IdentifiedModel& model) {
    std::vector<Vector> sigmas;
    for (const int record : shooting().train_records()) {
      const size_t r = static_cast<size_t>(record);
      if (r >= model.sigmas.size() ||
          model.sigmas[r].size() !=
              static_cast<Eigen::Index>(problem_.records[r].channels.size())) {
        return false;
      }
      sigmas.push_back(model.sigmas[r]);
    }
    shooting().SetSigmas(sigmas);
    objective_.priors().SetDecays(Vector::Zero(layout_.num_decay_groups()));
    const StageTuning tuning;
    TrajectoryOutlines trajectories;
    return InitialTrajectories(problem_, FirstSegmentSamples(problem_, tuning),
                               layout_.Free(model.parameters), tuning,
                               &shooting(), &trajectories);
  }

  // Takes a step of Gauss and Newton, shortened until the cost falls. Returns
  // false if it does not, or hardly.
  bool Step(const CondensedSystem& system, Vector* free) {
    constexpr int kHalvings = 4;
    constexpr double kSmallest = 1e-3;
    Matrix hessian = system.hessian;
    hessian.diagonal() *= 1.0 + 1e-9;
    const Vector step = -hessian.ldlt().solve(system.gradient);
    if (!step.allFinite()) return false;
    double length = 1.0;
    for (int k = 0; k < kHalvings; ++k, length *= 0.5) {
      const Vector moved = *free + length * step;
      double cost = 0.0;
      if (!objective_.Evaluate(moved, &cost) || !(cost < system.cost)) continue;
      *free = moved;
      return system.cost - cost > kSmallest * system.cost;
    }
    return false;
  }

  const IdentificationProblem& problem_;
  const ParameterLayout layout_;
  Objective objective_;
};

}  // namespace

bool ProposeFromSegments(const IdentificationProblem& problem,
                         const IdentifiedModel& model,
                         const std::vector<DiscoveredEquation>& equations,
                         const DiscoveryOptions& options,
                         const TermPrices& prices, int num_threads,
                         std::vector<DiscoveredEquation>* proposed,
                         std::string* error) {
  proposed->clear();
  std::vector<DiscoveredEquation> wide = WithAllCandidates(equations);
  for (DiscoveredEquation& equation : wide) {
    if (!RegressAllTerms(&equation)) return true;
  }
  IdentificationProblem with_all;
  IdentifiedModel initial;
  if (!MakeDiscoveredProblem(problem, model, wide, {}, &with_all, &initial,
                             error)) {
    return false;
  }
  SegmentCost cost(with_all, num_threads);
  Vector free;
  FittedCost fitted;
  if (!cost.Fit(initial, &free, &fitted)) return true;
  ChooseTerms({wide, equations, options, prices}, cost.layout(), free, fitted,
              proposed);
  return true;
}

}  // namespace pinode
