#include "pinode/dynamics/prescribed_motion.h"

#include <algorithm>

namespace pinode {
namespace {

// Returns the member for the index of an input; nullptr for other inputs.
int* IndexOf(InputSpec::Kind kind, PrescribedDof* prescribed) {
  switch (kind) {
    case InputSpec::Kind::kPrescribedDisplacement:
      return &prescribed->displacement;
    case InputSpec::Kind::kPrescribedVelocity:
      return &prescribed->velocity;
    case InputSpec::Kind::kPrescribedAcceleration:
      return &prescribed->acceleration;
    case InputSpec::Kind::kGroundAcceleration:
    case InputSpec::Kind::kForce:
    case InputSpec::Kind::kCovariate:
    case InputSpec::Kind::kGroundDisplacement:
    case InputSpec::Kind::kRecordSwitch:
      break;
  }
  return nullptr;
}

Matrix Kept(const Matrix& matrix, const std::vector<int>& rows,
            const std::vector<int>& columns) {
  Matrix kept(static_cast<Eigen::Index>(rows.size()),
              static_cast<Eigen::Index>(columns.size()));
  for (size_t i = 0; i < rows.size(); ++i) {
    for (size_t j = 0; j < columns.size(); ++j) {
      kept(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          matrix(rows[i], columns[j]);
    }
  }
  return kept;
}

}  // namespace

std::vector<PrescribedDof> PrescribedDofs(
    const std::vector<InputSpec>& inputs) {
  std::vector<PrescribedDof> all;
  for (size_t i = 0; i < inputs.size(); ++i) {
    PrescribedDof one;
    if (IndexOf(inputs[i].kind, &one) == nullptr) continue;
    one.dof = inputs[i].index;
    auto at = std::find_if(
        all.begin(), all.end(),
        [&one](const PrescribedDof& other) { return other.dof >= one.dof; });
    if (at == all.end() || at->dof != one.dof) at = all.insert(at, one);
    *IndexOf(inputs[i].kind, &*at) = static_cast<int>(i);
  }
  return all;
}

bool ArePrescribable(const StructuralModel& model,
                     const std::vector<InputSpec>& inputs, std::string* error) {
  const std::vector<PrescribedDof> prescribed = PrescribedDofs(inputs);
  size_t count = 0;
  for (const InputSpec& input : inputs) {
    PrescribedDof unused;
    if (IndexOf(input.kind, &unused) != nullptr) ++count;
  }
  for (const PrescribedDof& p : prescribed) {
    const std::string name =
        "'" + model.dof_names[static_cast<size_t>(p.dof)] + "'";
    if (p.displacement < 0 || p.velocity < 0 || p.acceleration < 0) {
      *error = "the prescribed motion of DOF " + name +
               " needs displacement, velocity and acceleration";
      return false;
    }
    Vector coupling = model.mass.col(p.dof);
    coupling[p.dof] = 0.0;
    if (!coupling.isZero(0.0)) {
      *error = "the motion of DOF " + name +
               " is prescribed, but the mass matrix couples it to others; give "
               "it a lumped mass, or use a ground motion";
      return false;
    }
  }
  if (count != 3 * prescribed.size()) {
    *error = "the prescribed motion of a DOF is given twice";
    return false;
  }
  return true;
}

StructuralModel WithoutPrescribed(
    const StructuralModel& model,
    const std::vector<PrescribedDof>& prescribed) {
  std::vector<int> free;
  for (int i = 0; i < model.num_dofs(); ++i) {
    const bool held =
        std::any_of(prescribed.begin(), prescribed.end(),
                    [i](const PrescribedDof& p) { return p.dof == i; });
    if (!held) free.push_back(i);
  }
  std::vector<int> directions;
  for (int j = 0; j < model.num_directions(); ++j) directions.push_back(j);
  StructuralModel held = model;
  held.dof_names.clear();
  for (int i : free) {
    held.dof_names.push_back(model.dof_names[static_cast<size_t>(i)]);
  }
  held.mass = Kept(model.mass, free, free);
  held.damping = Kept(model.damping, free, free);
  held.stiffness = Kept(model.stiffness, free, free);
  held.influence = Kept(model.influence, free, directions);
  held.support_mass_coupling =
      Kept(model.support_mass_coupling, free, directions);
  return held;
}

}  // namespace pinode
