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

bool Feature::Exists(int num_dofs, int num_inputs) const {
  switch (kind) {
    case Kind::kDisplacement:
    case Kind::kVelocity:
      return a >= 0 && a < num_dofs;
    case Kind::kDeformation:
    case Kind::kDeformationRate:
      return a >= kGround && a < num_dofs && b >= kGround && b < num_dofs &&
             a != b;
    case Kind::kTime:
      return true;
    case Kind::kInput:
      return input >= 0 && input < num_inputs;
  }
  return false;
}

RowVector Feature::Selector(int num_dofs) const {
  CHECK(kind == Kind::kInput || Exists(num_dofs, 0))
      << "feature of DOFs " << a << " and " << b << " of " << num_dofs;
  RowVector selector = RowVector::Zero(num_dofs);
  ForEachState(num_dofs, [&](int index, double sign) {
    selector[index % num_dofs] = sign;
  });
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

bool FeaturesExist(const std::string& name,
                   const std::vector<Feature>& features, int num_dofs,
                   int num_inputs, std::string* error) {
  for (const Feature& feature : features) {
    if (!feature.Exists(num_dofs, num_inputs)) {
      *error = "'" + name + "' uses a DOF or an input that does not exist";
      return false;
    }
  }
  return true;
}

}  // namespace pinode
