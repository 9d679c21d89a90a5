#include "pinode/dynamics/feature.h"

#include "pinode/base/logging.h"

namespace pinode {
namespace {

Feature Make(Feature::Kind kind, int a, int b, int input) {
  Feature feature;
  feature.kind = kind;
  feature.a = a;
  feature.b = b;
  feature.input = input;
  return feature;
}

}  // namespace

Feature Feature::Displacement(int dof) {
  return Make(Kind::kDisplacement, dof, kGround, -1);
}

Feature Feature::Velocity(int dof) {
  return Make(Kind::kVelocity, dof, kGround, -1);
}

Feature Feature::Deformation(int from, int to) {
  return Make(Kind::kDeformation, from, to, -1);
}

Feature Feature::DeformationRate(int from, int to) {
  return Make(Kind::kDeformationRate, from, to, -1);
}

Feature Feature::Time() { return Make(Kind::kTime, kGround, kGround, -1); }

Feature Feature::Input(int input) {
  return Make(Kind::kInput, kGround, kGround, input);
}

RowVector Feature::Selector(int num_dofs) const {
  RowVector selector = RowVector::Zero(num_dofs);
  switch (kind) {
    case Kind::kDisplacement:
    case Kind::kVelocity:
      CHECK(a >= 0 && a < num_dofs)
          << "feature on DOF " << a << " of " << num_dofs;
      selector[a] = 1.0;
      break;
    case Kind::kDeformation:
    case Kind::kDeformationRate:
      CHECK(a < num_dofs && b < num_dofs && a != b)
          << "feature between DOFs " << a << " and " << b << " of " << num_dofs;
      if (a != kGround) selector[a] = -1.0;
      if (b != kGround) selector[b] = 1.0;
      break;
    case Kind::kTime:
    case Kind::kInput:
      break;
  }
  return selector;
}

std::string Feature::Name(const std::vector<std::string>& dof_names,
                          const std::vector<std::string>& input_names) const {
  const auto dof = [&](int index) {
    return index == kGround ? std::string("ground")
                            : dof_names[static_cast<size_t>(index)];
  };
  switch (kind) {
    case Kind::kDisplacement:
      return "x[" + dof(a) + "]";
    case Kind::kVelocity:
      return "v[" + dof(a) + "]";
    case Kind::kDeformation:
      return "d[" + dof(a) + "," + dof(b) + "]";
    case Kind::kDeformationRate:
      return "w[" + dof(a) + "," + dof(b) + "]";
    case Kind::kTime:
      return "t";
    case Kind::kInput:
      return "input[" + input_names[static_cast<size_t>(input)] + "]";
  }
  return "";
}

}  // namespace pinode
