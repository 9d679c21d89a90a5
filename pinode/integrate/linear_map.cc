#include "pinode/integrate/linear_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/integrate/exact_forcing.h"
#include "pinode/integrate/forced_exponential.h"

namespace pinode {
namespace {

using Map = ParameterizedMap;

// Returns one stage of Runge-Kutta, the rate at `point`, as a map of the state
// and the inputs at the three nodes of a step. `node` is the node of the stage.
Map Stage(const Map& rate, const Map& point, int ns, int ni, int node) {
  const auto f = rate.value.leftCols(ns);
  Map stage;
  stage.value.noalias() = f * point.value;
  stage.value.middleCols(ns + node * ni, ni) += rate.value.rightCols(ni);
  for (size_t j = 0; j < rate.derivatives.size(); ++j) {
    const Matrix& change = rate.derivatives[j];
    Matrix derivative(ns, ns + 3 * ni);
    derivative.noalias() = change.leftCols(ns) * point.value;
    derivative.noalias() += f * point.derivatives[j];
    derivative.middleCols(ns + node * ni, ni) += change.rightCols(ni);
    stage.derivatives.push_back(std::move(derivative));
  }
  return stage;
}

// Computes *sum += factor * term.
void Add(double factor, const Map& term, Map* sum) {
  sum->value += factor * term.value;
  for (size_t j = 0; j < sum->derivatives.size(); ++j) {
    sum->derivatives[j] += factor * term.derivatives[j];
  }
}

// Returns the map of one step, of the state and the inputs at its three nodes.
Map StepMap(const Map& rate, int ns, int ni, double dt) {
  Map begin;
  begin.value = Matrix::Identity(ns, ns + 3 * ni);
  begin.derivatives.assign(rate.derivatives.size(),
                           Matrix::Zero(ns, ns + 3 * ni));
  Map end = begin;
  const double next[] = {0.5 * dt, 0.5 * dt, dt};
  const double weights[] = {dt / 6.0, dt / 3.0, dt / 3.0, dt / 6.0};
  const int nodes[] = {0, 1, 1, 2};
  Map point = begin;
  for (int s = 0; s < 4; ++s) {
    const Map stage = Stage(rate, point, ns, ni, nodes[s]);
    Add(weights[s], stage, &end);
    if (s == 3) break;
    point = begin;
    Add(next[s], stage, &point);
  }
  return end;
}

Map Columns(const Map& map, Eigen::Index first, Eigen::Index count) {
  Map columns;
  columns.value = map.value.middleCols(first, count);
  for (const Matrix& derivative : map.derivatives) {
    columns.derivatives.push_back(derivative.middleCols(first, count));
  }
  return columns;
}

// Computes the power by squaring: at most twice as many products as `exponent`
// (at least 1) has binary digits.
Map Power(Map base, int exponent) {
  while (exponent % 2 == 0) {
    base = Product(base, base);
    exponent /= 2;
  }
  Map power = base;
  while (exponent /= 2) {
    base = Product(base, base);
    if (exponent % 2 == 1) power = Product(base, power);
  }
  return power;
}

}  // namespace

double LinearMap::TableSize(const StructuralDynamics& dynamics, int substeps) {
  const double ns = dynamics.num_states();
  return ns * dynamics.num_tangent_columns() *
         (ns + 3.0 * substeps * dynamics.num_inputs());
}

LinearMap::LinearMap(const StructuralDynamics& dynamics,
                     const StructuralDynamics::Prepared& prepared,
                     const IntegrationGrid& grid, bool with_parameters) {
  DCHECK(dynamics.IsLinear());
  Map rate;
  GetLinearRate(dynamics, prepared, with_parameters, &rate);
  if (grid.integrator() == Integrator::kExact) {
    ComputeExactly(rate, grid.sampling_step(), grid.substeps());
  } else {
    ComputeSteps(rate, grid.step(), grid.substeps());
  }
  rate_ = std::move(rate.value);
  rate_derivatives_ = std::move(rate.derivatives);
}

void LinearMap::ComputeSteps(const Map& rate, double step, int substeps) {
  const Eigen::Index ns = rate.value.rows();
  const Eigen::Index ni = rate.value.cols() - ns;
  const Map one =
      StepMap(rate, static_cast<int>(ns), static_cast<int>(ni), step);
  const auto np = static_cast<Eigen::Index>(rate.derivatives.size());
  const Map power = Power(Columns(one, 0, ns), substeps);
  transition_ = power.value;
  forcing_.resize(ns, 3 * substeps * ni);
  derivatives_.resize(ns * np, ns + forcing_.cols());
  for (Eigen::Index j = 0; j < np; ++j) {
    derivatives_.block(j * ns, 0, ns, ns) =
        power.derivatives[static_cast<size_t>(j)];
  }
  // Effect of the inputs of a step at the interval's end, from the last step to
  // the first.
  const Map a = Columns(one, 0, ns);
  Map inputs = Columns(one, ns, 3 * ni);
  for (int s = substeps - 1; s >= 0; --s) {
    forcing_.middleCols(3 * s * ni, 3 * ni) = inputs.value;
    for (Eigen::Index j = 0; j < np; ++j) {
      derivatives_.block(j * ns, ns + 3 * s * ni, ns, 3 * ni) =
          inputs.derivatives[static_cast<size_t>(j)];
    }
    if (s > 0) inputs = Product(a, inputs);
  }
}

void LinearMap::ComputeExactly(const Map& rate, double sampling_step,
                               int substeps) {
  const Eigen::Index ns = rate.value.rows();
  const Eigen::Index ni = rate.value.cols() - ns;
  const auto np = static_cast<Eigen::Index>(rate.derivatives.size());
  // The derivatives of the inputs at the beginning, with respect to the
  // fraction of the interval, are j! times the polynomial's coefficients.
  const Matrix polynomial = NodePolynomial(substeps);
  Matrix nodes(polynomial.rows() * ni, polynomial.cols() * ni);
  double factorial = 1.0;
  for (Eigen::Index j = 0; j < polynomial.rows(); ++j) {
    if (j > 1) factorial *= static_cast<double>(j);
    for (Eigen::Index k = 0; k < polynomial.cols(); ++k) {
      nodes.block(j * ni, k * ni, ni, ni) =
          factorial * polynomial(j, k) * Matrix::Identity(ni, ni);
    }
  }
  const Map exponential =
      ForcedExponential(rate, sampling_step, polynomial.rows());
  transition_ = exponential.value.leftCols(ns);
  forcing_ = exponential.value.rightCols(nodes.rows()) * nodes;
  derivatives_.resize(ns * np, ns + forcing_.cols());
  for (Eigen::Index j = 0; j < np; ++j) {
    const Matrix& derivative = exponential.derivatives[static_cast<size_t>(j)];
    derivatives_.middleRows(j * ns, ns) << derivative.leftCols(ns),
        derivative.rightCols(nodes.rows()) * nodes;
  }
}

}  // namespace pinode
