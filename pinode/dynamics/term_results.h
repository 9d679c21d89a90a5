// The results of a term, put on the DOFs.

#ifndef PINODE_DYNAMICS_TERM_RESULTS_H_
#define PINODE_DYNAMICS_TERM_RESULTS_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/feature.h"
#include "pinode/dynamics/products.h"
#include "pinode/dynamics/term.h"

namespace pinode {

// dv/dt by the results (num_dofs x results): -M^-1 outputs of a force, outputs
// of an acceleration.
Matrix AccelerationMap(ActsAs acts_as, const Matrix& outputs,
                       const Matrix& mass_inverse);

// Computes acceleration += map * results. For forces it adds the same to
// force_acceleration.
template <typename T>
void AddResults(const Matrix& map, ActsAs acts_as, const T* results,
                T* acceleration, T* force_acceleration) {
  for (Eigen::Index o = 0; o < map.cols(); ++o) {
    AddScaled(map.col(o), results[o], acceleration);
    if (acts_as == ActsAs::kForce) {
      AddScaled(map.col(o), results[o], force_acceleration);
    }
  }
}

inline void AddResults(const Matrix& map, ActsAs acts_as, const double* results,
                       double* acceleration, double* force_acceleration) {
  AddProduct(map, results, acceleration);
  if (acts_as == ActsAs::kForce) AddProduct(map, results, force_acceleration);
}

// Computes jacobian += [0; slope * d feature / d state; 0]. slope has num_dofs
// entries.
inline void AddFeatureColumn(const Feature& feature, const double* slope,
                             Eigen::Index num_dofs, Matrix* jacobian) {
  feature.ForEachState(static_cast<int>(num_dofs), [&](int index, double sign) {
    double* column = jacobian->data() + index * jacobian->rows() + num_dofs;
    for (Eigen::Index i = 0; i < num_dofs; ++i) column[i] += sign * slope[i];
  });
}

// Adds the state's effect through the features: jacobian += [0; map * slope * d
// features / d state; 0]. slope(o, f) is the derivative of result o with
// respect to feature f. jacobian is num_states x num_states. `scratch` has
// num_dofs entries.
template <typename Slope>
void AddFeatureColumns(const Matrix& map, const std::vector<Feature>& features,
                       const Slope& slope, Vector* scratch, Matrix* jacobian) {
  for (size_t f = 0; f < features.size(); ++f) {
    scratch->setZero();
    for (int o = 0; o < map.cols(); ++o) {
      *scratch += map.col(o) * slope(o, static_cast<int>(f));
    }
    AddFeatureColumn(features[f], scratch->data(), scratch->size(), jacobian);
  }
}

}  // namespace pinode

#endif  // PINODE_DYNAMICS_TERM_RESULTS_H_
