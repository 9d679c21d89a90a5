#include "pinode/study/damage/damage_search.h"

#include <algorithm>
#include <cctype>

#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/study/explanations/ungrouped_stiffness.h"

namespace pinode {
namespace {

// Returns the node of "node.direction", the names of DOFs in finite-element
// programs; the whole name if it has another form.
std::string NodeOf(const std::string& dof) {
  const size_t dot = dof.rfind('.');
  return dot == std::string::npos || dot == 0 ? dof : dof.substr(0, dot);
}

// True if a DOF "node.direction" is a rotation: 4, 5, 6, or a name with r in
// front.
bool IsRotation(const std::string& dof) {
  const size_t dot = dof.rfind('.');
  if (dot == std::string::npos || dot + 1 >= dof.size()) return false;
  const char c =
      static_cast<char>(std::tolower(static_cast<unsigned char>(dof[dot + 1])));
  return c == 'r' || (dof.size() == dot + 2 && c >= '4' && c <= '6');
}

// Finds the two ends of the only spring in a group's matrix; false for any
// other matrix.
bool IsSpring(const Matrix& matrix, int* from, int* to) {
  std::vector<int> ends;
  for (int j = 0; j < matrix.rows(); ++j) {
    if (matrix.row(j).cwiseAbs().maxCoeff() > 0.0) ends.push_back(j);
  }
  if (ends.empty() || ends.size() > 2) return false;
  *from = ends.size() == 2 ? ends[0] : Feature::kGround;
  *to = ends.back();
  const int size = static_cast<int>(matrix.rows());
  const double stiffness = matrix(*to, *to);
  return (matrix - stiffness * SpringMatrix(size, *from, *to)).norm() <=
         1e-9 * matrix.norm();
}

}  // namespace

bool DamageSearch::IsValid(const StructuralModel& model,
                           std::string* error) const {
  const auto is_dof = [&model](int dof) {
    return dof >= 0 && dof < model.num_dofs();
  };
  for (const MassPlace& place : masses) {
    if (place.dofs.empty() ||
        !std::all_of(place.dofs.begin(), place.dofs.end(), is_dof)) {
      *error = "the place of mass '" + place.name + "' has no DOF of the model";
      return false;
    }
  }
  for (const SpringPlace& place : springs) {
    if (!is_dof(place.to) || place.from == place.to ||
        (place.from != Feature::kGround && !is_dof(place.from))) {
      *error = "the place of force '" + place.name +
               "' is not between two DOFs of the model, or a DOF and the "
               "ground";
      return false;
    }
  }
  return true;
}

DamageSearch::MassPlace PlaceOfMass(const StructuralModel& model,
                                    const std::string& node) {
  DamageSearch::MassPlace place{node, {}};
  for (int j = 0; j < model.num_dofs(); ++j) {
    const std::string& dof = model.dof_names[static_cast<size_t>(j)];
    if (NodeOf(dof) == node && !IsRotation(dof)) place.dofs.push_back(j);
  }
  return place;
}

std::vector<DamageSearch::MassPlace> PlacesOfMasses(
    const IdentificationProblem& problem) {
  const StructuralModel& model = problem.dynamics->model();
  std::vector<DamageSearch::MassPlace> places;
  const auto add = [&](Eigen::Index dof) {
    const DamageSearch::MassPlace place =
        PlaceOfMass(model, NodeOf(model.dof_names[static_cast<size_t>(dof)]));
    const bool known = std::any_of(places.begin(), places.end(),
                                   [&](const DamageSearch::MassPlace& other) {
                                     return other.name == place.name;
                                   });
    if (!known && !place.dofs.empty()) places.push_back(place);
  };
  for (const IdentificationRecord& record : problem.records) {
    for (const MeasuredChannel& channel : record.channels) {
      const Vector& weights = channel.observation.weights;
      if (!channel.fit || (weights.array() != 0.0).count() != 1) continue;
      Eigen::Index dof = 0;
      weights.cwiseAbs().maxCoeff(&dof);
      add(dof);
    }
  }
  // Under ground motion a mass that no sensor is at, and that is no candidate,
  // shows as a loss of all stiffness, damping and other masses.
  if (places.empty() || model.num_dofs() > kMostPlaces) return places;
  for (Eigen::Index j = 0; j < model.num_dofs(); ++j) {
    if (model.mass(j, j) > 0.0) add(j);
  }
  return places;
}

std::vector<DamageSearch::SpringPlace> GroupSprings(
    const StructuralDynamics& dynamics) {
  std::vector<DamageSearch::SpringPlace> places;
  for (const GroupTerm& term : dynamics.groups()) {
    DamageSearch::SpringPlace place;
    place.name = term.group.name;
    if (term.alpha.free &&
        term.group.target == MatrixGroup::Target::kStiffness &&
        IsSpring(term.group.matrix, &place.from, &place.to)) {
      places.push_back(place);
    }
  }
  return places;
}

bool HasFixedDamping(const StructuralDynamics& dynamics) {
  if (dynamics.model().damping.isZero(0.0)) return false;
  const std::vector<GroupTerm>& groups = dynamics.groups();
  return std::none_of(groups.begin(), groups.end(), [](const GroupTerm& term) {
    return term.alpha.free &&
           term.group.target == MatrixGroup::Target::kDamping;
  });
}

DamageSearch LookEverywhere(const IdentificationProblem& problem) {
  return {PlacesOfMasses(problem), GroupSprings(*problem.dynamics),
          HasFixedDamping(*problem.dynamics), problem.num_train_records() > 0};
}

}  // namespace pinode
