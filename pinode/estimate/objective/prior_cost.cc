#include "pinode/estimate/objective/prior_cost.h"

#include <cmath>

#include "pinode/base/logging.h"

namespace pinode {

PriorCost::PriorCost(const ParameterLayout& layout)
    : layout_(layout), decays_(Vector::Zero(layout.num_decay_groups())) {
  int count = static_cast<int>(layout.decay_rows().size());
  for (int j = 0; j < layout.num_free(); ++j) {
    if (layout_.free_parameter(j).HasPrior()) ++count;
  }
  set_num_residuals(count);
  mutable_parameter_block_sizes()->push_back(layout.num_free());
}

void PriorCost::SetDecays(const Vector& decays) {
  CHECK_EQ(decays.size(), layout_.num_decay_groups());
  decays_ = decays;
}

bool PriorCost::Evaluate(double const* const* parameters, double* residuals,
                         double** jacobians) const {
  const int n = layout_.num_free();
  const Vector free = Eigen::Map<const Vector>(parameters[0], n);
  const bool derive = jacobians != nullptr && jacobians[0] != nullptr;
  Eigen::Map<
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
      jacobian(derive ? jacobians[0] : nullptr, derive ? num_residuals() : 0,
               n);
  jacobian.setZero();
  int row = 0;
  for (int j = 0; j < n; ++j) {
    const Parameter& parameter = layout_.free_parameter(j);
    if (!parameter.HasPrior()) continue;
    residuals[row] = (free[j] - parameter.prior_mean) / parameter.prior_sigma;
    if (derive) jacobian(row, j) = 1.0 / parameter.prior_sigma;
    ++row;
  }
  for (const ParameterLayout::DecayRow& decay : layout_.decay_rows()) {
    const double root = std::sqrt(decays_[decay.group]);
    residuals[row] = root * decay.Value(free);
    if (derive) {
      jacobian.row(row).segment(decay.first, decay.weights.size()) =
          root * decay.weights.transpose();
    }
    ++row;
  }
  return true;
}

bool PriorCost::Evaluate(const Vector& free, double* cost) {
  *cost = 0.0;
  for (int j = 0; j < layout_.num_free(); ++j) {
    const Parameter& parameter = layout_.free_parameter(j);
    if (!parameter.HasPrior()) continue;
    const double r = (free[j] - parameter.prior_mean) / parameter.prior_sigma;
    *cost += 0.5 * r * r;
  }
  for (const ParameterLayout::DecayRow& row : layout_.decay_rows()) {
    const double value = row.Value(free);
    *cost += 0.5 * decays_[row.group] * value * value;
  }
  return std::isfinite(*cost);
}

bool PriorCost::Linearize(const Vector& free, CondensedSystem* system) {
  const int n = layout_.num_free();
  system->gradient = Vector::Zero(n);
  system->hessian = Matrix::Zero(n, n);
  for (int j = 0; j < n; ++j) {
    const Parameter& parameter = layout_.free_parameter(j);
    if (!parameter.HasPrior()) continue;
    const double precision =
        1.0 / (parameter.prior_sigma * parameter.prior_sigma);
    system->gradient[j] += precision * (free[j] - parameter.prior_mean);
    system->hessian(j, j) += precision;
  }
  for (const ParameterLayout::DecayRow& row : layout_.decay_rows()) {
    const Eigen::Index count = row.weights.size();
    const Vector weighted = decays_[row.group] * row.weights;
    system->gradient.segment(row.first, count) += row.Value(free) * weighted;
    system->hessian.block(row.first, row.first, count, count).noalias() +=
        weighted * row.weights.transpose();
  }
  return Evaluate(free, &system->cost);
}

}  // namespace pinode
