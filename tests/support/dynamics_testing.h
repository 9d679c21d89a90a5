// Structures for tests of this layer and the layers above.

#ifndef TESTS_SUPPORT_DYNAMICS_TESTING_H_
#define TESTS_SUPPORT_DYNAMICS_TESTING_H_

#include <memory>

#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {
namespace testing {

// Returns a chain of `n` unit masses on springs k and dampers c, fixed to the
// ground.
StructuralModel MakeChain(int n, double k, double c);

// Returns a three-DOF structure under ground motion and one force with a term
// of every kind: stiffness, damping and mass groups, one that follows time and
// one that follows a covariate, every element type, a network as an
// acceleration with skip path, a network as a force, a gauged network, and a
// linear network. Inputs: ground acceleration, force on DOF 2, covariate.
std::unique_ptr<StructuralDynamics> MakeEverything();

// Returns all derivatives of dh/dt by Jets, num_states x (num_states +
// num_tangent_columns): with respect to the state, then the free parameters.
Matrix JetJacobian(const StructuralDynamics& dynamics,
                   const StructuralDynamics::Prepared& prepared, double time,
                   const double* input, const Vector& state);

}  // namespace testing
}  // namespace pinode

#endif  // TESTS_SUPPORT_DYNAMICS_TESTING_H_
