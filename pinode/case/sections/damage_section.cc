#include "pinode/case/sections/damage_section.h"

#include <algorithm>

#include "pinode/base/strings.h"
#include "pinode/case/sections/terms_section.h"
#include "pinode/case/text/parameter_keys.h"

namespace pinode {
namespace {

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
    if (!inner.AllowKeys()) return false;
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
        return inner.Fail("name", "another [[damage.place]] has this name");
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
  if (!table.AllowKeys()) return false;
  std::vector<std::string> kinds = {"mass", "damping", "stiffness",
                                    "nonlinear"};
  if (table.Has("kinds")) {
    for (const std::string& kind : table.Strings("kinds")) {
      if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
        return table.Fail("kinds", "'kinds' has '" + kind +
                                       "', expected some of mass, damping, "
                                       "stiffness and nonlinear, or none" +
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
    return table.Fail("masses", "'masses' needs mass among the 'kinds'");
  }
  if (!asked("nonlinear") && table.Has("place")) {
    return table.Fail("place", "'place' needs nonlinear among the 'kinds'");
  }
  const StructuralModel& model = problem.dynamics->model();
  if (table.Has("masses")) {
    if (!ReadMasses(table, model, search)) return false;
  } else if (asked("mass")) {
    search->masses = PlacesOfMasses(problem);
  }
  search->damping = asked("damping") && HasFixedDamping(*problem.dynamics);
  search->stiffness = asked("stiffness") && problem.num_train_records() > 0;
  if (table.Has("place")) {
    if (!ReadPlaces(table, model, search)) return false;
  } else if (asked("nonlinear")) {
    search->springs = GroupSprings(*problem.dynamics);
  }
  return root.errors()->ok();
}

}  // namespace pinode
