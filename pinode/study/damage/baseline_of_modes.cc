#include "pinode/study/damage/baseline_of_modes.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "pinode/base/statistics.h"
#include "pinode/estimate/objective/modal_cost.h"
#include "pinode/estimate/objective/prior_cost.h"
#include "pinode/problem/identified_model.h"
#include "pinode/study/problem/growth.h"

namespace pinode {
namespace {

// Cost of the modes over `variance`, plus that of the priors.
bool LinearizeModes(const IdentificationProblem& problem,
                    const ParameterLayout& layout, const Vector& free,
                    double variance, CondensedSystem* system) {
  ModalCost modes(problem.modal, *problem.dynamics, layout);
  PriorCost priors(layout);
  CondensedSystem of_priors;
  if (!modes.Linearize(free, system) || !priors.Linearize(free, &of_priors)) {
    return false;
  }
  system->cost /= variance;
  system->gradient /= variance;
  system->hessian /= variance;
  system->Add(of_priors);
  return std::isfinite(system->cost) && system->gradient.allFinite() &&
         system->hessian.allFinite();
}

}  // namespace

double VarianceOfModes(const IdentificationProblem& problem,
                       const ParameterLayout& layout, const Vector& free) {
  constexpr double kLeastProbability = 0.01;
  ModalCost modes(problem.modal, *problem.dynamics, layout);
  CondensedSystem own, with_priors;
  if (!modes.Linearize(free, &own) ||
      !LinearizeModes(problem, layout, free, 1.0, &with_priors)) {
    return 1.0;
  }
  const Eigen::LDLT<Matrix> factors(with_priors.hessian);
  const double determined = factors.solve(own.hessian).trace();
  const double left =
      modes.num_residuals() - modes.num_eliminated() - determined;
  if (!(left >= 0.5)) return 1.0;
  const double chi2 = 2.0 * own.cost;
  if (modes.data().HasSigmasOfAll() &&
      ChiSquareProbability(chi2, left) >= kLeastProbability) {
    return 1.0;
  }
  return std::max(chi2 / left, 1e-300);
}

bool BaselineOfModes::IsOne(const Baseline& baseline) {
  if (baseline.fit == nullptr) return false;
  const IdentificationProblem& problem = baseline.fit->problem;
  return problem.num_train_records() == 0 && !problem.HasSpectra() &&
         !problem.modal.modes.empty();
}

BaselineOfModes::BaselineOfModes(const Baseline& baseline,
                                 const std::vector<std::string>& groups)
    : groups_(groups), problem_(baseline.fit->problem), layout_(problem_) {
  IdentifiedModel model;
  model.parameters = baseline.fit->IsFitted() ? baseline.fit->model.parameters
                                              : layout_.InitialValues();
  parameters_ = ParametersByName(problem_, model);
  variance_ =
      VarianceOfModes(problem_, layout_, FreeAt(baseline.groups.values));
}

Vector BaselineOfModes::FreeAt(const Vector& values) const {
  const Vector present = AlreadyPresent(*problem_.dynamics, groups_);
  std::map<std::string, double> parameters = parameters_;
  for (size_t j = 0; j < groups_.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    parameters[groups_[j]] = values[i] - present[i];
  }
  const IdentifiedModel model =
      BeginFrom(parameters, IdentifiedModel(), problem_);
  return layout_.Free(model.parameters);
}

bool BaselineOfModes::Near(const Vector& values,
                           PooledBaselines* pooled) const {
  const Vector free = FreeAt(values);
  CondensedSystem system;
  if (!LinearizeModes(problem_, layout_, free, variance_, &system)) {
    return false;
  }
  std::vector<int> rows(groups_.size(), -1);
  for (const int index : layout_.free()) {
    const auto name = std::find(groups_.begin(), groups_.end(),
                                layout_.parameter(index).name);
    if (name != groups_.end()) {
      rows[static_cast<size_t>(name - groups_.begin())] =
          layout_.FreeIndex(index);
    }
  }
  if (std::find(rows.begin(), rows.end(), -1) != rows.end()) return false;
  const Eigen::LLT<Matrix> factors(system.hessian);
  if (factors.info() != Eigen::Success) return false;
  const Vector step = factors.solve(Vector(-system.gradient));
  const Matrix covariance =
      factors.solve(Matrix::Identity(free.size(), free.size()));
  pooled->state.values = (free + step)(rows);
  pooled->state.values += AlreadyPresent(*problem_.dynamics, groups_);
  pooled->state.covariance = covariance(rows, rows);
  pooled->between = Vector::Zero(static_cast<Eigen::Index>(groups_.size()));
  pooled->num_baselines = 1;
  pooled->cost = system.cost + 0.5 * step.dot(system.gradient);
  pooled->log_volume =
      Matrix(Eigen::LLT<Matrix>(pooled->state.covariance).matrixL())
          .diagonal()
          .array()
          .log()
          .sum();
  return pooled->state.values.allFinite() && std::isfinite(pooled->log_volume);
}

}  // namespace pinode
