#include "pinode/integrate/linear_rate.h"

#include <cmath>

#include "pinode/base/logging.h"

namespace pinode {

ParameterizedMap LinearRate(const StructuralDynamics& dynamics,
                            const StructuralDynamics::Prepared& prepared,
                            bool with_parameters) {
  DCHECK(dynamics.IsLinear());
  const int ns = dynamics.num_states();
  const int ni = dynamics.num_inputs();
  const int np = with_parameters ? dynamics.num_tangent_columns() : 0;
  ParameterizedMap map;
  map.value.resize(ns, ns + ni);
  map.derivatives.assign(static_cast<size_t>(np), Matrix(ns, ns + ni));
  auto at = dynamics.MakeLinearization();
  auto scratch = dynamics.MakeTangentScratch(ns);
  const Matrix left = Matrix::Identity(ns, ns);
  Matrix tangents(ns, np);
  // Column by column.
  for (int k = 0; k < ns + ni; ++k) {
    const Vector point = Vector::Unit(ns + ni, k);
    dynamics.Linearize(prepared, 0.0, point.data() + ns, point.data(), &at);
    map.value.col(k) = at.rate;
    if (np == 0) continue;
    tangents.setZero();
    const StructuralDynamics::Linearization* point_at = &at;
    const Matrix* left_at = &left;
    dynamics.AddParameterTangents(prepared, &point_at, &left_at, 1, &scratch,
                                  tangents.data());
    for (int j = 0; j < np; ++j) {
      map.derivatives[static_cast<size_t>(j)].col(k) = tangents.col(j);
    }
  }
  return map;
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
