// Features: scalar arguments of the terms of the equation of motion.

#ifndef PINODE_DYNAMICS_FEATURE_H_
#define PINODE_DYNAMICS_FEATURE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Scalar selected from the state, the time or the inputs, in the model's units:
//
//   displacement      x[a]
//   velocity          v[a]
//   deformation       x[b] - x[a]
//   deformation rate  v[b] - v[a]
//   time              t
//   input             u[input]   (excitation or covariate)
//
// If `a` or `b` is kGround, its x and v are zero, because motion is relative to
// the ground.
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

  // Return a feature of each kind. DOFs and inputs are counted from 0.
  static Feature Displacement(int dof);
  static Feature Velocity(int dof);
  static Feature Deformation(int from, int to);
  static Feature DeformationRate(int from, int to);
  static Feature Time();
  static Feature Input(int input);

  // True if the feature depends on displacements.
  bool OnDisplacement() const {
    return kind == Kind::kDisplacement || kind == Kind::kDeformation;
  }
  // True if the feature depends on velocities.
  bool OnVelocity() const {
    return kind == Kind::kVelocity || kind == Kind::kDeformationRate;
  }

  // True if the feature's DOFs, or its input, exist in a model of this size.
  [[nodiscard]] bool Exists(int num_dofs, int num_inputs) const;

  // Calls visit(index, sign) for every entry of the state h = [x; v; z] on
  // which the feature depends. The feature is the sum of sign * state[index].
  // Time and inputs depend on no entry.
  template <typename Visitor>
  void ForEachState(int num_dofs, const Visitor& visit) const {
    const int shift = OnVelocity() ? num_dofs : 0;
    switch (kind) {
      case Kind::kDisplacement:
      case Kind::kVelocity:
        visit(shift + a, 1.0);
        break;
      case Kind::kDeformation:
      case Kind::kDeformationRate:
        if (b != kGround) visit(shift + b, 1.0);
        if (a != kGround) visit(shift + a, -1.0);
        break;
      case Kind::kTime:
      case Kind::kInput:
        break;
    }
  }

  // Returns the feature's value for any scalar type. `time` is in the model's
  // unit of time. `inputs` has one entry per input. `state` is h = [x; v; z].
  template <typename T>
  T Value(int num_dofs, double time, const double* inputs,
          const T* state) const {
    if (kind == Kind::kTime) return T(time);
    if (kind == Kind::kInput) return T(inputs[input]);
    T value(0.0);
    ForEachState(num_dofs, [&value, state](int index, double sign) {
      value += sign * state[index];
    });
    return value;
  }

  // Returns the row (num_dofs entries) that maps x, or v for velocities, to the
  // feature. The row is zero for time and inputs.
  RowVector Selector(int num_dofs) const;

  // Returns the feature's name: "x[u1]", "v[u1]", "d[u1,u2]" for a deformation,
  // "w[ground,u1]" for its rate, "t" or "input[temperature]".
  std::string Name(const std::vector<std::string>& dof_names,
                   const std::vector<std::string>& input_names) const;
};

// Writes the values of all features to `values`, which has one entry per
// feature. Feature::Value describes the arguments.
template <typename T>
void GatherFeatures(const std::vector<Feature>& features, int num_dofs,
                    double time, const double* inputs, const T* state,
                    T* values) {
  for (size_t i = 0; i < features.size(); ++i) {
    values[i] = features[i].Value(num_dofs, time, inputs, state);
  }
}

// Checks that all features exist. On failure returns false, and *error names
// the term `name` and the feature.
[[nodiscard]] bool FeaturesExist(const std::string& name,
                                 const std::vector<Feature>& features,
                                 int num_dofs, int num_inputs,
                                 std::string* error);

}  // namespace pinode

#endif  // PINODE_DYNAMICS_FEATURE_H_
