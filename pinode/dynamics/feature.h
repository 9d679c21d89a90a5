// What a term of the equation of motion may look at.

#ifndef PINODE_DYNAMICS_FEATURE_H_
#define PINODE_DYNAMICS_FEATURE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// One scalar picked from the state, the clock or the inputs. With b = kGround
// the relative quantities refer to the ground, whose relative motion is zero.
//
//   displacement      x[a]
//   velocity          v[a]
//   deformation       x[b] - x[a]
//   deformation rate  v[b] - v[a]
//   time              t
//   input             u[input]   (excitation or covariate)
struct Feature {
  enum class Kind {
    kDisplacement,
    kVelocity,
    kDeformation,
    kDeformationRate,
    kTime,
    kInput,
  };
  static constexpr int kGround = -1;

  Kind kind = Kind::kDisplacement;
  int a = kGround;  // DOF index, or kGround for the relative quantities
  int b = kGround;  // DOF index; relative quantities only
  int input = -1;   // index into the inputs; kInput only

  static Feature Displacement(int dof);
  static Feature Velocity(int dof);
  static Feature Deformation(int from, int to);
  static Feature DeformationRate(int from, int to);
  static Feature Time();
  static Feature Input(int input);

  bool OnDisplacement() const {
    return kind == Kind::kDisplacement || kind == Kind::kDeformation;
  }
  bool OnVelocity() const {
    return kind == Kind::kVelocity || kind == Kind::kDeformationRate;
  }

  // Row of the linear map from x (or from v, for velocities) to the feature,
  // size num_dofs; zero for time and inputs.
  RowVector Selector(int num_dofs) const;

  // "x[u1]", "v[u1]", "d[u1,u2]", "w[ground,u1]", "t", "input[temperature]".
  std::string Name(const std::vector<std::string>& dof_names,
                   const std::vector<std::string>& input_names) const;
};

}  // namespace pinode

#endif  // PINODE_DYNAMICS_FEATURE_H_
