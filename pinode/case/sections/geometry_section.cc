#include "pinode/case/sections/geometry_section.h"

#include <Eigen/Core>
#include <algorithm>
#include <unordered_map>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/case/sections/model_section.h"
#include "pinode/record/files/universal_file.h"
#include "pinode/structure/decks/bulk_geometry.h"
#include "pinode/structure/decks/deck_geometry.h"

namespace pinode {
namespace {

// Among more names the search for a similar one would take too long.
constexpr size_t kMostHintedNames = 5000;

std::string HintOf(const std::string& name,
                   const std::vector<std::string>& known) {
  return known.size() <= kMostHintedNames ? NameHint(name, known)
                                          : std::string();
}

// Reads chains of nodes as lines; chains of unknown nodes are left out.
bool FromUniversalFile(const std::string& path, StructureGeometry* geometry,
                       std::string* error) {
  UniversalFile file;
  if (!ReadUniversalFile(path, &file, error)) return false;
  if (file.nodes.empty()) {
    *error = path + ": it has no nodes, expected data set 15 or 2411";
    return false;
  }
  std::unordered_map<int, int> index;
  int unknown = 0;
  Eigen::Vector3d position;
  geometry->positions.resize(static_cast<Eigen::Index>(file.nodes.size()), 3);
  for (const UniversalNode& node : file.nodes) {
    const auto place = static_cast<int>(index.size());
    if (!index.emplace(node.label, place).second) {
      *error = path + ": node " + std::to_string(node.label) +
               " is given twice, expected different numbers";
      return false;
    }
    // In some programs the system of set 2411 is that of the position.
    if ((!node.position_is_local && !file.IsGlobal(node.system)) ||
        !file.PositionOf(node, &position)) {
      *error = path + ": node " + std::to_string(node.label) +
               " is in coordinate system " + std::to_string(node.system) +
               ", expected the global one, or in set 15 a Cartesian one of "
               "set 18 or 2420";
      return false;
    }
    geometry->node_names.push_back(std::to_string(node.label));
    geometry->positions.row(place) = position.transpose();
    if (file.IsGlobal(node.displacement_system)) continue;
    Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
    if (!file.AxesAt(node, &axes)) ++unknown;
    geometry->axes[place] = axes;
  }
  if (unknown > 0) {
    geometry->notes.push_back(std::to_string(unknown) +
                              " nodes have local directions that the file does "
                              "not define. Sensors there are not drawn.");
  }
  for (const UniversalLine& line : file.lines) {
    StructureGeometry::Set set;
    set.name = line.name;
    for (size_t i = 1; i < line.nodes.size(); ++i) {
      const auto from = index.find(line.nodes[i - 1]);
      const auto to = index.find(line.nodes[i]);
      // A 0 begins a new line.
      if (from == index.end() || to == index.end()) continue;
      set.elements.push_back(static_cast<int>(geometry->elements.size()));
      geometry->elements.push_back(
          {ElementShape::kLine, {from->second, to->second}});
    }
    geometry->sets.push_back(std::move(set));
  }
  return true;
}

class GeometryReader {
 public:
  GeometryReader(const TomlTable& root, const std::vector<std::string>* dofs,
                 const std::vector<std::string>* groups, PlacedGeometry* placed)
      : table_(root.Table("geometry", "[geometry]")),
        dof_names_(dofs),
        group_names_(groups),
        placed_(placed),
        geometry_(placed->geometry) {}

  bool Read() {
    if (!table_.AllowKeys()) {
      return false;
    }
    if (table_.Has("file") == table_.Has("nodes")) {
      return table_.Fail("file",
                         "expected one of file = \"...\" and nodes = {name = "
                         "[x, y, z], ...}");
    }
    if (!(table_.Has("file") ? ReadFile() : ReadNodes()) || !ReadLines()) {
      return false;
    }
    std::string error;
    if (!geometry_.IsValid(&error)) return table_.Fail("file", error);
    index_ = NodeIndex(geometry_);
    return ReadDofs() && ReadGroups();
  }

 private:
  bool ReadFile() {
    const std::string name = table_.RequiredString("file");
    if (!table_.errors()->ok()) return false;
    const std::string path = ResolvePath(table_.errors()->path(), name);
    std::string error;
    const bool good =
        IsUniversalFile(path) ? FromUniversalFile(path, &geometry_, &error)
        : IsBulkFile(path)    ? ReadBulkGeometry(path, &geometry_, &error)
                              : ReadDeckGeometry(path, &geometry_, &error);
    return good || table_.errors()->FailAsIs(error);
  }

  bool ReadNodes() {
    const TomlTable nodes = table_.Table("nodes", "[geometry] nodes");
    std::vector<std::vector<double>> positions;
    for (const auto& [name, value] : nodes.entries()) {
      (void)value;
      positions.push_back(nodes.Numbers(name, 3, "coordinate"));
      if (!table_.errors()->ok()) return false;
      geometry_.node_names.push_back(name);
    }
    if (positions.empty()) {
      return table_.Fail("nodes", "'nodes' is empty, expected a node");
    }
    geometry_.positions.resize(static_cast<Eigen::Index>(positions.size()), 3);
    for (size_t i = 0; i < positions.size(); ++i) {
      geometry_.positions.row(static_cast<Eigen::Index>(i)) =
          ToVector(positions[i]).transpose();
    }
    return true;
  }

  bool ReadLines() {
    for (const TomlTable& line : table_.Tables("line", "geometry")) {
      if (!line.AllowKeys()) return false;
      std::vector<int> nodes;
      for (const std::string& name : line.Strings("nodes")) {
        const auto& names = geometry_.node_names;
        const auto place = std::find(names.begin(), names.end(), name);
        if (place == names.end()) {
          return line.Fail(
              "nodes", "'" + name + "' is not a node" + HintOf(name, names));
        }
        nodes.push_back(static_cast<int>(place - names.begin()));
      }
      const std::string set = line.String("set");
      if (!table_.errors()->ok()) return false;
      if (nodes.size() < 2) {
        return line.Fail("nodes", "fewer than two nodes, expected a line");
      }
      for (size_t i = 1; i < nodes.size(); ++i) {
        AddToSet(set, static_cast<int>(geometry_.elements.size()));
        geometry_.elements.push_back(
            {ElementShape::kLine, {nodes[i - 1], nodes[i]}});
      }
    }
    return table_.errors()->ok();
  }

  void AddToSet(const std::string& name, int element) {
    if (name.empty()) return;
    int set = geometry_.SetIndex(name);
    if (set < 0) {
      set = static_cast<int>(geometry_.sets.size());
      geometry_.sets.push_back({name, {}});
    }
    geometry_.sets[static_cast<size_t>(set)].elements.push_back(element);
  }

  static bool IsKnown(const std::string& name,
                      const std::vector<std::string>* names) {
    return names == nullptr ||
           std::find(names->begin(), names->end(), name) != names->end();
  }

  // Returns one text or several.
  static std::vector<std::string> TextsOf(const TomlTable& table,
                                          const std::string& key) {
    const TomlValue* value = table.Find(key);
    return value->type == TomlValue::Type::kString
               ? std::vector<std::string>{value->text}
               : table.Strings(key);
  }

  bool ReadDofs() {
    const TomlTable dofs = table_.Table("dofs", "[geometry] dofs");
    for (const auto& [dof, value] : dofs.entries()) {
      (void)value;
      if (!IsKnown(dof, dof_names_)) {
        return dofs.Fail(
            dof, "'" + dof + "' is not a DOF" + HintOf(dof, *dof_names_));
      }
      for (std::string text : TextsOf(dofs, dof)) {
        PlacedGeometry::Place place;
        if (!text.empty() && text[0] == '-') {
          place.sign = -1.0;
          text.erase(0, 1);
        }
        if (!SplitDofName(text, &place.node, &place.direction) ||
            place.direction > 3 || index_.count(place.node) == 0) {
          return dofs.Fail(dof, "'" + text +
                                    "' is not a place, expected a node of the "
                                    "geometry and 1, 2 or 3, as in \"" +
                                    geometry_.node_names.front() + ".1\"");
        }
        if (geometry_.Direction(index_.at(place.node), place.direction)
                .isZero()) {
          return dofs.Fail(dof,
                           "'" + text +
                               "' has a local direction that the geometry's "
                               "file does not define, expected its coordinate "
                               "system (data set 18 or 2420) in the file");
        }
        placed_->dofs[dof].push_back(std::move(place));
      }
      if (!table_.errors()->ok()) return false;
    }
    return table_.errors()->ok();
  }

  bool ReadGroups() {
    const TomlTable groups = table_.Table("groups", "[geometry] groups");
    std::vector<std::string> set_names;
    for (const StructureGeometry::Set& set : geometry_.sets) {
      set_names.push_back(set.name);
    }
    for (const auto& [group, value] : groups.entries()) {
      (void)value;
      if (!IsKnown(group, group_names_)) {
        return groups.Fail(group, "'" + group + "' is not a group" +
                                      HintOf(group, *group_names_));
      }
      std::vector<std::string> sets = TextsOf(groups, group);
      if (!table_.errors()->ok()) return false;
      for (const std::string& set : sets) {
        if (geometry_.SetIndex(set) >= 0) continue;
        return groups.Fail(group, "'" + set +
                                      "' is not an element set of the "
                                      "geometry" +
                                      HintOf(set, set_names));
      }
      placed_->groups[group] = std::move(sets);
    }
    return table_.errors()->ok();
  }

  const TomlTable table_;
  const std::vector<std::string>* dof_names_;
  const std::vector<std::string>* group_names_;
  PlacedGeometry* placed_;
  StructureGeometry& geometry_;
  std::unordered_map<std::string, int> index_;
};

}  // namespace

bool ReadGeometry(const TomlTable& root, const std::vector<std::string>* dofs,
                  const std::vector<std::string>* groups,
                  std::shared_ptr<const PlacedGeometry>* geometry) {
  geometry->reset();
  if (!root.Has("geometry")) return true;
  auto placed = std::make_shared<PlacedGeometry>();
  if (!GeometryReader(root, dofs, groups, placed.get()).Read()) {
    return false;
  }
  *geometry = std::move(placed);
  return true;
}

}  // namespace pinode
