#include "pinode/integrate/linear_rate.h"

#include <cmath>

#include "pinode/base/logging.h"

namespace pinode {

void GetLinearRate(const StructuralDynamics& dynamics,
                   const StructuralDynamics::Prepared& prepared,
                   bool with_parameters, ParameterizedMap* map) {
  DCHECK(dynamics.IsLinear());
  const int ns = dynamics.num_states();
  const int ni = dynamics.num_inputs();
  const int np = with_parameters ? dynamics.num_tangent_columns() : 0;
  // Linear dynamics have constant matrices only.
  map->value.setZero(ns, ns + ni);
  map->value.leftCols(ns) = prepared.linear.state_jacobian;
  map->value.bottomRightCorner(dynamics.num_dofs(), ni) =
      prepared.linear.input_map;
  map->derivatives.resize(static_cast<size_t>(np));
  for (Matrix& derivative : map->derivatives) derivative.setZero(ns, ns + ni);
  if (np > 0) {
    dynamics.linear_dynamics().AddRateDerivatives(prepared.linear,
                                                  &map->derivatives);
  }
}

Vector VelocityUnits(const Matrix& state_matrix) {
  const Eigen::Index n = state_matrix.rows() / 2;
  const double square =
      state_matrix.bottomLeftCorner(state_matrix.rows() - n, n)
          .cwiseAbs()
          .colwise()
          .sum()
          .maxCoeff();
  Vector units = Vector::Ones(state_matrix.rows());
  if (square > 0.0 && std::isfinite(square)) {
    units.head(n).setConstant(std::exp2(std::round(0.5 * std::log2(square))));
  }
  return units;
}

}  // namespace pinode
