// Structures and channels shared by tests of integration.

#ifndef TESTS_SUPPORT_INTEGRATE_TESTING_H_
#define TESTS_SUPPORT_INTEGRATE_TESTING_H_

#include <string>
#include <vector>

#include "pinode/base/logging.h"
#include "pinode/base/types.h"
#include "pinode/dynamics/observation.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/integrate/free_run.h"
#include "pinode/integrate/integration_grid.h"

namespace pinode {
namespace testing {

inline const std::vector<InputSpec>& GroundAndForce() {
  static const auto& inputs = *new std::vector<InputSpec>{
      {InputSpec::Kind::kGroundAcceleration, 0, "ground"},
      {InputSpec::Kind::kForce, 1, "force"}};
  return inputs;
}

// Adds `matrix` to the stiffness, damping and mass of `dynamics` as three
// groups.
inline void AddGroupsOfAllKinds(const Matrix& matrix,
                                StructuralDynamics* dynamics,
                                bool free_damping = true) {
  std::string error;
  for (const auto target :
       {MatrixGroup::Target::kStiffness, MatrixGroup::Target::kDamping,
        MatrixGroup::Target::kMass}) {
    GroupTerm group;
    group.alpha.name = group.group.name =
        "g" + std::to_string(dynamics->groups().size());
    group.group.target = target;
    group.group.matrix = matrix;
    group.alpha.value = 0.1;
    group.alpha.free = free_damping || target != MatrixGroup::Target::kDamping;
    CHECK(dynamics->AddGroup(group, &error)) << error;
  }
}

// Runs channels of all kinds on a structure of three DOFs.
struct ChannelRunner {
  explicit ChannelRunner(const StructuralDynamics& d)
      : dynamics(d),
        observation(
            d, {{"x", Quantity::kDisplacement, Vector::Unit(3, 0)},
                {"v", Quantity::kVelocity, Vector::Unit(3, 1)},
                {"a", Quantity::kAbsoluteAcceleration, Vector::Unit(3, 2)},
                {"e", Quantity::kStrain, Eigen::Vector3d(-1.0, 1.0, 0.0)}}) {}

  // Returns channels x samples of the whole grid.
  Matrix Run(const Vector& theta, const Vector& start,
             const IntegrationGrid& grid) const {
    StructuralDynamics::Prepared prepared;
    std::string error;
    CHECK(dynamics.Prepare(theta, &prepared, &error)) << error;
    Trajectory trajectory;
    CHECK(FreeRun(dynamics, prepared, observation, grid, start, 0,
                  grid.num_intervals(), &trajectory));
    return trajectory.channels;
  }

  const StructuralDynamics& dynamics;
  ObservationMap observation;
};

}  // namespace testing
}  // namespace pinode

#endif  // TESTS_SUPPORT_INTEGRATE_TESTING_H_
