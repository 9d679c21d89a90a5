#include "pinode/case/damage_section.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "pinode/base/strings.h"
#include "pinode/case/parameter_keys.h"
#include "pinode/case/terms_section.h"

namespace pinode {
namespace {

// The node of "node.direction", as finite-element programs name DOFs; the whole
// name where it is none of these.
std::string NodeOf(const std::string& dof) {
  const size_t dot = dof.rfind('.');
  return dot == std::string::npos || dot == 0 ? dof : dof.substr(0, dot);
}

// Whether a DOF "node.direction" turns: 4, 5, 6, or a name with r in front.
bool IsRotation(const std::string& dof) {
  const size_t dot = dof.rfind('.');
  if (dot == std::string::npos || dot + 1 >= dof.size()) return false;
  const char c =
      static_cast<char>(std::tolower(static_cast<unsigned char>(dof[dot + 1])));
  return c == 'r' || (dof.size() == dot + 2 && c >= '4' && c <= '6');
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

// The two ends of the only spring in a group's matrix; false for any other.
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

void AddMeasuredMasses(const IdentificationProblem& problem,
                       DamageSearch* search) {
  const StructuralModel& model = problem.dynamics->model();
  for (const IdentificationRecord& record : problem.records) {
    for (const MeasuredChannel& channel : record.channels) {
      const Vector& weights = channel.observation.weights;
      if (!channel.fit || (weights.array() != 0.0).count() != 1) continue;
      Eigen::Index dof = 0;
      weights.cwiseAbs().maxCoeff(&dof);
      const DamageSearch::MassPlace place =
          PlaceOfMass(model, NodeOf(model.dof_names[static_cast<size_t>(dof)]));
      const bool known =
          std::any_of(search->masses.begin(), search->masses.end(),
                      [&](const DamageSearch::MassPlace& other) {
                        return other.name == place.name;
                      });
      if (!known && !place.dofs.empty()) search->masses.push_back(place);
    }
  }
}

void AddGroupSprings(const StructuralDynamics& dynamics, DamageSearch* search) {
  for (const GroupTerm& term : dynamics.groups()) {
    DamageSearch::SpringPlace place;
    place.name = term.group.name;
    if (term.alpha.free &&
        term.group.target == MatrixGroup::Target::kStiffness &&
        IsSpring(term.group.matrix, &place.from, &place.to)) {
      search->springs.push_back(place);
    }
  }
}

bool ReadMasses(const TomlTable& table, const StructuralModel& model,
                DamageSearch* search) {
  for (const std::string& name : table.Strings("masses")) {
    DamageSearch::MassPlace place = PlaceOfMass(model, name);
    const int dof = model.DofIndex(name);
    if (place.dofs.empty() && dof >= 0) place.dofs = {dof};
    if (place.dofs.empty()) {
      return table.Fail("masses", "'" + name + "' is neither a DOF nor a node" +
                                      NameHint(name, model.dof_names));
    }
    search->masses.push_back(std::move(place));
  }
  return table.errors()->ok();
}

bool ReadPlaces(const TomlTable& table, const StructuralModel& model,
                DamageSearch* search) {
  for (TomlTable& inner : table.Tables("place", "damage")) {
    if (!inner.AllowKeys({"name", "between"})) return false;
    DamageSearch::SpringPlace place;
    place.name = inner.RequiredString("name");
    if (!table.errors()->ok()) return false;
    inner.set_name("[[damage.place]] '" + place.name + "'");
    if (!CheckName(inner, "name", place.name) ||
        !inner.RequireKey("between", "two DOFs, or \"ground\" and a DOF") ||
        !ReadBetween(model, inner, &place.from, &place.to)) {
      return false;
    }
    if (place.to < 0) std::swap(place.from, place.to);
    for (const DamageSearch::SpringPlace& other : search->springs) {
      if (other.name == place.name) {
        return inner.Fail("name", "another place has this name");
      }
    }
    search->springs.push_back(std::move(place));
  }
  return table.errors()->ok();
}

}  // namespace

bool ReadDamage(const TomlTable& root, const IdentificationProblem& problem,
                DamageSearch* search) {
  *search = DamageSearch();
  const TomlTable table = root.Table("damage", "[damage]");
  if (!table.AllowKeys({"kinds", "masses", "place"})) return false;
  std::vector<std::string> kinds = {"mass", "nonlinear"};
  if (table.Has("kinds")) {
    for (const std::string& kind : table.Strings("kinds")) {
      if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
        return table.Fail("kinds", "'kinds' has '" + kind +
                                       "', expected mass and nonlinear, one "
                                       "of them or none" +
                                       NameHint(kind, kinds));
      }
    }
    kinds = table.Strings("kinds");
  }
  if (!root.errors()->ok()) return false;
  const auto asked = [&kinds](const char* kind) {
    return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
  };
  if (!asked("mass") && table.Has("masses")) {
    return table.Fail("masses", "'masses' is of no use without the kind mass");
  }
  if (!asked("nonlinear") && table.Has("place")) {
    return table.Fail("place",
                      "'place' is of no use without the kind nonlinear");
  }
  const StructuralModel& model = problem.dynamics->model();
  if (table.Has("masses")) {
    if (!ReadMasses(table, model, search)) return false;
  } else if (asked("mass")) {
    AddMeasuredMasses(problem, search);
  }
  if (table.Has("place")) {
    if (!ReadPlaces(table, model, search)) return false;
  } else if (asked("nonlinear")) {
    AddGroupSprings(*problem.dynamics, search);
  }
  return root.errors()->ok();
}

}  // namespace pinode
