#include "pinode/case/draft/deck_draft.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/structure/decks/deck_geometry.h"
#include "pinode/structure/model/geometry.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;

constexpr char kMassPrefix[] = "mass_";

// Returns the file `stem` with this ending, compressed or not; empty: none.
std::string FileOf(const fs::path& folder, const std::string& stem,
                   const std::string& ending) {
  for (const char* packed : {"", ".gz"}) {
    const fs::path path = folder / (stem + ending + packed);
    std::error_code status;
    if (fs::is_regular_file(path, status)) return path.string();
  }
  return "";
}

// Adds the group of an export that is called `stem`, or says that there is no
// such set.
void AddGroup(const StructureGeometry& geometry, const std::string& path,
              const std::string& stem, bool is_mass, DeckModel* model) {
  DeckGroup group;
  group.name = stem;
  group.is_mass = is_mass;
  group.file = path;
  const std::string prefix = kMassPrefix;
  int set = geometry.SetIndex(stem);
  if (set < 0 && is_mass && stem.rfind(prefix, 0) == 0) {
    set = geometry.SetIndex(stem.substr(prefix.size()));
  }
  if (set < 0) {
    model->left_out.push_back(path);
    return;
  }
  group.set = geometry.sets[static_cast<size_t>(set)].name;
  model->groups.push_back(group);
}

}  // namespace

bool DeckModel::HasTranslation(const std::string& dof) const {
  std::string node;
  int direction = 0;
  return SplitDofName(dof, &node, &direction) && direction <= 3 &&
         nodes.count(node) > 0;
}

bool FindDeckModel(const std::string& deck, DeckModel* model,
                   std::string* error) {
  StructureGeometry geometry;
  if (!ReadDeckGeometry(deck, &geometry, error)) return false;
  DeckModel result;
  result.deck = deck;
  result.nodes = NodeIndex(geometry);
  const fs::path path(deck);
  const std::string stem = path.stem().string();
  const fs::path beside = path.parent_path();
  fs::path folder = beside;
  std::string own = stem;
  for (const auto& [place, name] :
       {std::pair<fs::path, std::string>{beside, stem},
        {beside / (stem + "_export"), "model"}}) {
    result.stiffness = FileOf(place, name, ".sti");
    result.mass = FileOf(place, name, ".mas");
    folder = place;
    own = name;
    if (!result.stiffness.empty() && !result.mass.empty()) break;
  }
  if (result.stiffness.empty() || result.mass.empty()) {
    *error = deck + ": there are no matrices " + stem + ".sti and " + stem +
             ".mas beside it or in " + stem +
             "_export; export them with pinode.calculix.export "
             "(pinode/python/README.md)";
    return false;
  }
  std::error_code status;
  std::vector<std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(
           folder.empty() ? fs::path(".") : folder, status)) {
    files.push_back((folder / entry.path().filename()).string());
  }
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) {
    const fs::path plain(WithoutGz(file));
    const std::string ending = plain.extension().string();
    const std::string name = plain.stem().string();
    if (name != own && (ending == ".sti" || ending == ".mas")) {
      AddGroup(geometry, file, name, ending == ".mas", &result);
    }
  }
  if (result.groups.empty()) {
    *error = deck +
             ": there is no matrix with a changed property of an element set "
             "beside " +
             result.stiffness +
             ", expected files named like the sets; export them with "
             "pinode.calculix.export (pinode/python/README.md)";
    return false;
  }
  *model = std::move(result);
  return true;
}

}  // namespace pinode
