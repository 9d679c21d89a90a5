#include "pinode/structure/deck_properties.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/structure/deck_blocks.h"
#include "pinode/structure/deck_geometry.h"
#include "pinode/structure/deck_numbers.h"

namespace pinode {
namespace {

// What stands below *MATERIAL and belongs to it.
constexpr const char* kMaterialKeywords[] = {
    "*ELASTIC",      "*DENSITY",          "*DAMPING",
    "*PLASTIC",      "*CYCLIC HARDENING", "*RATE DEPENDENT",
    "*EXPANSION",    "*CONDUCTIVITY",     "*SPECIFIC HEAT",
    "*CREEP",        "*DEPVAR",           "*DEFORMATION PLASTICITY",
    "*VISCOELASTIC", "*FAIL STRAIN",      "*FAIL STRESS"};
// What may stand behind a material.
constexpr const char* kBehindMaterials[] = {"*MATERIAL",
                                            "*SOLID SECTION",
                                            "*SHELL SECTION",
                                            "*MEMBRANE SECTION",
                                            "*BEAM SECTION",
                                            "*TRUSS SECTION",
                                            "*SPRING",
                                            "*MASS",
                                            "*NONSTRUCTURAL MASS",
                                            "*BOUNDARY",
                                            "*NSET",
                                            "*ELSET",
                                            "*NODE",
                                            "*ELEMENT",
                                            "*ORIENTATION",
                                            "*AMPLITUDE",
                                            "*STEP",
                                            "*INITIAL CONDITIONS",
                                            "*SURFACE",
                                            "*TIE",
                                            "*EQUATION",
                                            "*END ASSEMBLY",
                                            "*END PART"};
constexpr const char* kSections[] = {"*SOLID SECTION", "*SHELL SECTION",
                                     "*MEMBRANE SECTION", "*BEAM SECTION",
                                     "*TRUSS SECTION"};

template <size_t N>
bool IsAmong(const char* const (&names)[N], const std::string& name) {
  return std::any_of(std::begin(names), std::end(names),
                     [&name](const char* own) { return name == own; });
}

// Elements of these keywords have no mass.
constexpr const char* kWithoutMass[] = {"*SPRING", "*DASHPOT", "*GAP"};

// Masses by element set. What is spread over a set is so in proportion to its
// own mass or volume, which factors on all of it leave as it is.
constexpr const char* kMasses[] = {"*MASS", "*NONSTRUCTURAL MASS"};

constexpr size_t kLongestDeckName = 80;

bool EndsWithSection(const std::string& name) {
  const std::string_view end = " SECTION";
  return name.size() > end.size() &&
         name.compare(name.size() - end.size(), end.size(), end) == 0;
}

bool IsQuoted(const std::string& name) {
  return name.size() > 1 && name.front() == '"' && name.back() == '"';
}

std::string WithoutQuotes(const std::string& name) {
  return IsQuoted(name) ? name.substr(1, name.size() - 2) : name;
}

class PropertyDeck {
 public:
  explicit PropertyDeck(std::string* error) : error_(error) {}

  bool Read(const std::string& path, const std::string& content) {
    path_ = path;
    if (!ParseDeckGeometry(path, content, &geometry_, error_) ||
        !ReadDeckBlocks(path, content, &blocks_, error_)) {
      return false;
    }
    for (size_t b = 0; b < blocks_.size(); ++b) {
      const DeckKeyword& keyword = blocks_[b].keyword;
      const bool section = IsAmong(kSections, keyword.name);
      if (keyword.name == "*MATERIAL") {
        if (!AddMaterial(b)) return false;
      } else if (section || keyword.name == "*SPRING" ||
                 IsAmong(kMasses, keyword.name)) {
        AddOwner(b, section);
      }
      NoteSprings(keyword);
    }
    for (size_t b = 0; b < blocks_.size(); ++b) AddOtherUses(b);
    for (const Owner& owner : owners_) {
      if (!owner.material.empty() && materials_.count(owner.material) == 0) {
        return FailInDeckBlock(blocks_[owner.block],
                               "there is no *MATERIAL of that name", error_);
      }
      if (!owner.material.empty() && BlocksOf(owner, true).empty()) {
        without_mass_.insert(owner.elements.begin(), owner.elements.end());
      }
    }
    return true;
  }

  bool Properties(std::vector<DeckProperty>* properties) const {
    for (const Owner& owner : owners_) {
      DeckProperty property;
      property.set = owner.set;
      for (const bool mass : {false, true}) {
        std::vector<double>& values = mass ? property.mass : property.stiffness;
        for (const size_t b : BlocksOf(owner, mass)) {
          std::vector<DeckNumber> numbers;
          if (!NumbersOf(blocks_[b], &numbers)) return false;
          for (const double v : DeckValues(numbers, blocks_[b])) {
            values.push_back(v);
          }
        }
      }
      properties->push_back(std::move(property));
    }
    return true;
  }

  bool Scale(const std::vector<DeckFactor>& factors) {
    if (!geometry_.notes.empty()) {
      *error_ = path_ + ": " + geometry_.notes.front() +
                " Expected types that are known, where a deck is to be updated";
      return false;
    }
    for (const DeckFactor& factor : factors) {
      if (!Assign(factor)) return false;
    }
    for (const Owner& owner : owners_) {
      if (!owner.material.empty()) continue;
      std::vector<DeckBlock> own = {blocks_[owner.block]};
      if (!ScaleBlocks({owner.stiffness, owner.mass}, &own)) return false;
      blocks_[owner.block] = own[0];
    }
    return ScaleMaterials();
  }

  std::string Text() const { return FormatDeckBlocks(blocks_); }

 private:
  // A section (with a material), springs or masses.
  struct Owner {
    size_t block = 0;
    std::string set;
    std::string material;  // in upper case; empty: none
    double stiffness = 1.0, mass = 1.0;
    std::set<int> elements;
    bool scaled_stiffness = false, scaled_mass = false;
  };
  struct Material {
    size_t first = 0, end = 0;  // blocks
    // Blocks that use it and have no factor.
    std::vector<size_t> sections, unknown_uses;
  };

  bool AddMaterial(size_t b) {
    const std::string* name = blocks_[b].keyword.Find("NAME");
    if (name == nullptr || name->empty()) {
      return FailInDeckBlock(blocks_[b], "*MATERIAL without NAME", error_);
    }
    Material material;
    material.first = b;
    material.end = b + 1;
    while (material.end < blocks_.size() &&
           IsAmong(kMaterialKeywords, blocks_[material.end].keyword.name)) {
      ++material.end;
    }
    if (!materials_.emplace(DeckUpperCase(*name), material).second) {
      return FailInDeckBlock(blocks_[b],
                             "material '" + *name + "' is there twice", error_);
    }
    return true;
  }

  void AddOwner(size_t b, bool section) {
    const DeckKeyword& keyword = blocks_[b].keyword;
    const std::string* material = keyword.Find("MATERIAL");
    const std::vector<int>* elements = ElementsOf(keyword);
    // What has no elements here is changed by nobody.
    if (elements == nullptr || (section && material == nullptr)) return;
    Owner owner;
    owner.block = b;
    owner.set = *keyword.Find("ELSET");
    if (section) owner.material = DeckUpperCase(*material);
    owner.elements.insert(elements->begin(), elements->end());
    owners_.push_back(std::move(owner));
  }

  // Of the set that a keyword names; nullptr: there is none.
  const std::vector<int>* ElementsOf(const DeckKeyword& keyword) const {
    const std::string* set = keyword.Find("ELSET");
    const int index = set == nullptr ? -1 : geometry_.SetIndex(*set);
    return index < 0 ? nullptr
                     : &geometry_.sets[static_cast<size_t>(index)].elements;
  }

  void NoteSprings(const DeckKeyword& keyword) {
    if (IsAmong(kWithoutMass, keyword.name)) {
      if (const std::vector<int>* elements = ElementsOf(keyword)) {
        without_mass_.insert(elements->begin(), elements->end());
      }
    }
    const std::string* type = keyword.Find("TYPE");
    const std::string* set = keyword.Find("ELSET");
    if (keyword.name != "*ELEMENT" || type == nullptr || set == nullptr) return;
    const std::string name = DeckUpperCase(*type);
    const SpringStart start = name == "SPRINGA" ? SpringStart::kConstants
                              : name == "SPRING1" || name == "SPRING2"
                                  ? SpringStart::kDirections
                                  : SpringStart::kUnknown;
    const auto [place, added] =
        spring_starts_.emplace(DeckUpperCase(*set), start);
    if (!added && place->second != start) {
      place->second = SpringStart::kUnknown;
    }
  }

  // Uses of materials by what has no factor: composites and general sections,
  // which need them as they are, and what nobody here knows.
  void AddOtherUses(size_t b) {
    const DeckKeyword& keyword = blocks_[b].keyword;
    const bool known = IsAmong(kSections, keyword.name);
    std::vector<std::string> names;
    if (const std::string* material = keyword.Find("MATERIAL")) {
      names.push_back(*material);
    } else if (known || EndsWithSection(keyword.name)) {
      for (const size_t line : blocks_[b].DataLines()) {
        const std::vector<std::string_view> fields =
            Split(blocks_[b].lines[line], ',');
        // Of composites: thickness, points, material, orientation.
        for (size_t k = known ? 2 : 0; k < (known ? 3 : fields.size()); ++k) {
          if (k < fields.size()) names.emplace_back(StripBlanks(fields[k]));
        }
      }
    } else if (keyword.name.substr(0, 7) == "*CHANGE" &&
               keyword.Find("NAME") != nullptr) {
      names.push_back(*keyword.Find("NAME"));
    }
    const bool owned = known && keyword.Find("MATERIAL") != nullptr &&
                       ElementsOf(keyword) != nullptr;
    if (owned) return;
    for (const std::string& name : names) {
      const auto material = materials_.find(DeckUpperCase(name));
      if (material == materials_.end()) continue;
      std::vector<size_t>& uses = EndsWithSection(keyword.name)
                                      ? material->second.sections
                                      : material->second.unknown_uses;
      uses.push_back(b);
    }
  }

  bool NumbersOf(const DeckBlock& block,
                 std::vector<DeckNumber>* numbers) const {
    const std::string* set = block.keyword.Find("ELSET");
    const auto place = set == nullptr
                           ? spring_starts_.end()
                           : spring_starts_.find(DeckUpperCase(*set));
    return FindDeckNumbers(
        block,
        place == spring_starts_.end() ? SpringStart::kUnknown : place->second,
        numbers, error_);
  }

  // Of its stiffness or mass; none where it has no such part.
  std::vector<size_t> BlocksOf(const Owner& owner, bool mass) const {
    if (owner.material.empty()) {
      const bool is_mass = IsAmong(kMasses, blocks_[owner.block].keyword.name);
      return is_mass == mass ? std::vector<size_t>{owner.block}
                             : std::vector<size_t>();
    }
    const Material& material = materials_.at(owner.material);
    std::vector<size_t> own;
    for (size_t b = material.first; b < material.end; ++b) {
      if (blocks_[b].keyword.name == (mass ? "*DENSITY" : "*ELASTIC")) {
        own.push_back(b);
      }
    }
    return own;
  }

  bool Assign(const DeckFactor& factor) {
    const std::string what =
        std::string(factor.is_mass ? "mass" : "stiffness") +
        " of element set '" + factor.set + "'";
    const auto fail = [&](const std::string& why) {
      *error_ = path_ + ": the " + what + " cannot be changed: " + why;
      return false;
    };
    const int index = geometry_.SetIndex(factor.set);
    if (index < 0) return fail("there is no such set");
    if (!std::isfinite(factor.factor) || !(factor.factor > 0.0)) {
      return fail("its factor is not positive");
    }
    const std::vector<int>& elements =
        geometry_.sets[static_cast<size_t>(index)].elements;
    const std::set<int> wanted(elements.begin(), elements.end());
    std::set<int> covered;
    for (Owner& owner : owners_) {
      if (owner.elements.empty() || BlocksOf(owner, factor.is_mass).empty()) {
        continue;
      }
      size_t inside = 0;
      for (const int e : owner.elements) inside += wanted.count(e);
      if (inside == 0) continue;
      if (inside < owner.elements.size()) {
        return fail("'" + owner.set +
                    "' has elements outside of it, expected properties of "
                    "whole sets");
      }
      bool& done = factor.is_mass ? owner.scaled_mass : owner.scaled_stiffness;
      if (done) return fail("'" + owner.set + "' has another factor already");
      done = true;
      (factor.is_mass ? owner.mass : owner.stiffness) = factor.factor;
      covered.insert(owner.elements.begin(), owner.elements.end());
    }
    for (const int e : wanted) {
      if (covered.count(e) > 0) continue;
      // Points have no stiffness; of others the mass may be none.
      const bool without =
          factor.is_mass ? without_mass_.count(e) > 0
                         : geometry_.elements[static_cast<size_t>(e)].shape ==
                               ElementShape::kPoint;
      if (without) continue;
      return fail(
          "it has elements without a section with material, spring or "
          "mass");
    }
    return !covered.empty() || fail("it has nothing of that kind");
  }

  // Where the sections of a material differ, all but those with factors of one
  // (or else the first) get a copy.
  bool ScaleMaterials() {
    std::map<std::string,
             std::map<std::pair<double, double>, std::vector<size_t>>>
        by_material;
    for (size_t o = 0; o < owners_.size(); ++o) {
      const Owner& owner = owners_[o];
      if (owner.material.empty()) continue;
      by_material[owner.material][{owner.stiffness, owner.mass}].push_back(o);
    }
    // From behind, so that copies move no block that is still to come.
    std::vector<std::pair<size_t, std::string>> order;
    for (const auto& entry : by_material) {
      order.emplace_back(materials_.at(entry.first).first, entry.first);
    }
    std::sort(order.rbegin(), order.rend());
    std::map<size_t, std::string> renamed;  // owner: new material
    std::vector<std::pair<size_t, std::vector<DeckBlock>>> copies;
    for (const auto& [first, name] : order) {
      const Material material = materials_.at(name);
      auto& kinds = by_material[name];
      if (!material.unknown_uses.empty() &&
          (kinds.size() > 1 || kinds.count({1.0, 1.0}) == 0)) {
        const DeckBlock& user = blocks_[material.unknown_uses[0]];
        return FailInDeckBlock(user,
                               user.keyword.name + " uses material '" + name +
                                   "', which is to be changed, expected "
                                   "sections alone",
                               error_);
      }
      // Composites and general sections keep it as it is.
      if (!material.sections.empty()) kinds[{1.0, 1.0}];
      auto kept = kinds.find({1.0, 1.0});
      if (kept == kinds.end()) kept = kinds.begin();
      if (kinds.size() > 1 && !CanBeCopied(material)) return false;
      std::vector<DeckBlock> added;
      for (const auto& kind : kinds) {
        if (kind.first == kept->first) continue;
        const std::string copy = NewName(name, owners_[kind.second[0]].set);
        std::vector<DeckBlock> blocks(
            blocks_.begin() + static_cast<long>(material.first),
            blocks_.begin() + static_cast<long>(material.end));
        blocks[0].head = {"*MATERIAL,NAME=" + copy};
        if (!ScaleBlocks(kind.first, &blocks)) return false;
        for (DeckBlock& block : blocks) added.push_back(std::move(block));
        for (const size_t o : kind.second) renamed[o] = copy;
      }
      std::vector<DeckBlock> own(
          blocks_.begin() + static_cast<long>(material.first),
          blocks_.begin() + static_cast<long>(material.end));
      if (!ScaleBlocks(kept->first, &own)) return false;
      std::move(own.begin(), own.end(),
                blocks_.begin() + static_cast<long>(material.first));
      copies.emplace_back(material.end, std::move(added));
    }
    for (const auto& [o, name] : renamed) {
      SetMaterial(name, &blocks_[owners_[o].block]);
    }
    for (auto& [end, added] : copies) {
      blocks_.insert(blocks_.begin() + static_cast<long>(end),
                     std::make_move_iterator(added.begin()),
                     std::make_move_iterator(added.end()));
    }
    return true;
  }

  // By {stiffness, mass}.
  bool ScaleBlocks(const std::pair<double, double>& factors,
                   std::vector<DeckBlock>* blocks) {
    for (DeckBlock& block : *blocks) {
      const std::string& name = block.keyword.name;
      const double factor =
          name == "*ELASTIC" || name == "*SPRING"        ? factors.first
          : name == "*DENSITY" || IsAmong(kMasses, name) ? factors.second
                                                         : 1.0;
      if (factor == 1.0) continue;
      std::vector<DeckNumber> numbers;
      if (!NumbersOf(block, &numbers)) return false;
      ScaleDeckNumbers(numbers, factor, &block);
    }
    return true;
  }

  // Nothing that may belong to it is left behind.
  bool CanBeCopied(const Material& material) const {
    if (material.end >= blocks_.size()) return true;
    const DeckBlock& next = blocks_[material.end];
    return IsAmong(kBehindMaterials, next.keyword.name) ||
           FailInDeckBlock(
               next,
               next.keyword.name +
                   " behind a material that several sections share, "
                   "expected one of their own for the sets that differ",
               error_);
  }

  std::string NewName(const std::string& material, const std::string& set) {
    const std::string quote = IsQuoted(material) || IsQuoted(set) ? "\"" : "";
    const std::string wish =
        WithoutQuotes(material) + "_" + DeckUpperCase(WithoutQuotes(set));
    std::string name;
    for (int n = 1; name.empty() || materials_.count(name) > 0; ++n) {
      const std::string end = n == 1 ? quote : "_" + std::to_string(n) + quote;
      name = quote +
             wish.substr(0, kLongestDeckName - quote.size() - end.size()) + end;
    }
    materials_[name] = Material();
    return name;
  }

  static void SetMaterial(const std::string& name, DeckBlock* section) {
    std::string head = section->keyword.name;
    for (const auto& [key, value] : section->keyword.parameters) {
      head += "," + key;
      if (key == "MATERIAL") {
        head += "=" + name;
      } else if (!value.empty()) {
        head += "=" + value;
      }
    }
    section->head = {head};
  }

  std::string path_;
  StructureGeometry geometry_;
  std::vector<DeckBlock> blocks_;
  std::map<std::string, Material> materials_;
  std::vector<Owner> owners_;
  std::set<int> without_mass_;                        // elements
  std::map<std::string, SpringStart> spring_starts_;  // by set
  std::string* error_;
};

}  // namespace

bool ReadDeckProperties(const std::string& path, const std::string& content,
                        std::vector<DeckProperty>* properties,
                        std::string* error) {
  properties->clear();
  PropertyDeck deck(error);
  return deck.Read(path, content) && deck.Properties(properties);
}

bool ScaleDeck(const std::string& path, const std::string& content,
               const std::vector<DeckFactor>& factors, std::string* scaled,
               std::string* error) {
  PropertyDeck deck(error);
  if (!deck.Read(path, content) || !deck.Scale(factors)) return false;
  *scaled = deck.Text();
  return true;
}

}  // namespace pinode
