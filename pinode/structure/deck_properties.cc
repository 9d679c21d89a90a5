#include "pinode/structure/deck_properties.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/structure/deck_blocks.h"
#include "pinode/structure/deck_geometry.h"

namespace pinode {
namespace {

// A number of a block: of `lines`, and of the fields of that line.
struct DeckNumber {
  size_t line = 0;
  size_t field = 0;
};

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

std::vector<std::string_view> FieldsOf(const std::string& line) {
  return Split(line, ',');
}

// CalculiX and Abaqus read twenty characters, and CalculiX tells a number from
// a direction by its point.
std::string FormatDeckNumber(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.13E", value);
  return text;
}

bool FailInBlock(const DeckBlock& block, const std::string& what,
                 std::string* error) {
  *error = block.place + ": " + what;
  return false;
}

// Fields that are moduli, for each of the lines that one set of constants goes
// over.
bool ModuliOf(const DeckBlock& block, std::vector<std::vector<size_t>>* by_line,
              std::string* error) {
  const std::string* given = block.keyword.Find("TYPE");
  const std::string type = given == nullptr ? "ISO" : DeckUpperCase(*given);
  if (type == "ISO" || type == "ISOTROPIC") {
    *by_line = {{0}};
  } else if (block.keyword.Find("DEPENDENCIES") != nullptr) {
    return FailInBlock(block,
                       "*ELASTIC with DEPENDENCIES, expected constants of "
                       "temperature alone",
                       error);
  } else if (type == "ENGINEERING CONSTANTS") {
    *by_line = {{0, 1, 2, 6, 7}, {0}};
  } else if (type == "ORTHO" || type == "ORTHOTROPIC") {
    *by_line = {{0, 1, 2, 3, 4, 5, 6, 7}, {0}};
  } else if (type == "LAMINA") {
    *by_line = {{0, 1, 3, 4, 5}};
  } else if (type == "ANISO" || type == "ANISOTROPIC") {
    *by_line = {
        {0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 2, 3, 4}};
  } else {
    return FailInBlock(block,
                       "*ELASTIC, TYPE=" + type +
                           ", expected ISO, ENGINEERING CONSTANTS, ORTHO, "
                           "LAMINA or ANISO",
                       error);
  }
  return true;
}

// The first data line of a spring that acts along directions has these alone.
bool HasDirectionsAlone(const std::string& line) {
  return line.find_first_not_of("0123456789, \t\r") == std::string::npos;
}

// The numbers of a block that are in proportion to stiffness or mass.
bool NumbersOf(const DeckBlock& block, std::vector<DeckNumber>* numbers,
               std::string* error) {
  std::vector<size_t> data = block.DataLines();
  std::vector<std::vector<size_t>> by_line = {{0}};
  if (block.keyword.name == "*ELASTIC") {
    if (!ModuliOf(block, &by_line, error)) return false;
  } else if (block.keyword.name == "*SPRING") {
    // A blank line in the place of directions says that there are none.
    const bool blank = !data.empty() && data.front() > 0 &&
                       StripBlanks(block.lines[data.front() - 1]).empty();
    if (!blank && data.size() > 1 &&
        HasDirectionsAlone(block.lines[data.front()])) {
      data.erase(data.begin());
    }
  }
  if (data.empty()) {
    return FailInBlock(block, block.keyword.name + " has no numbers", error);
  }
  for (size_t i = 0; i < data.size(); ++i) {
    const std::vector<std::string_view> fields = FieldsOf(block.lines[data[i]]);
    for (const size_t field : by_line[i % by_line.size()]) {
      if (field >= fields.size() || StripBlanks(fields[field]).empty()) {
        continue;
      }
      double value = 0.0;
      if (!ParseDouble(StripBlanks(fields[field]), &value) ||
          !std::isfinite(value)) {
        return FailInBlock(block,
                           block.keyword.name + " has '" +
                               std::string(StripBlanks(fields[field])) +
                               "', expected a number",
                           error);
      }
      numbers->push_back({data[i], field});
    }
  }
  return true;
}

void ScaleNumbers(const std::vector<DeckNumber>& numbers, double factor,
                  DeckBlock* block) {
  for (const DeckNumber& number : numbers) {
    std::string& line = block->lines[number.line];
    std::vector<std::string> fields;
    for (const std::string_view field : FieldsOf(line)) {
      fields.emplace_back(field);
    }
    double value = 0.0;
    if (!ParseDouble(StripBlanks(fields[number.field]), &value)) continue;
    fields[number.field] = FormatDeckNumber(factor * value);
    line = Join(fields, ",");
  }
}

std::vector<double> ValuesOf(const std::vector<DeckNumber>& numbers,
                             const DeckBlock& block) {
  std::vector<double> values;
  for (const DeckNumber& number : numbers) {
    double value = 0.0;
    if (ParseDouble(
            StripBlanks(FieldsOf(block.lines[number.line])[number.field]),
            &value)) {
      values.push_back(value);
    }
  }
  return values;
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
                 keyword.name == "*MASS") {
        if (!AddOwner(b, section)) return false;
      }
    }
    for (const Owner& owner : owners_) {
      if (!owner.material.empty() && materials_.count(owner.material) == 0) {
        return FailInBlock(blocks_[owner.block],
                           "there is no *MATERIAL of that name", error_);
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
          if (!NumbersOf(blocks_[b], &numbers, error_)) return false;
          for (const double v : ValuesOf(numbers, blocks_[b])) {
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
  };

  bool AddMaterial(size_t b) {
    const std::string* name = blocks_[b].keyword.Find("NAME");
    if (name == nullptr || name->empty()) {
      return FailInBlock(blocks_[b], "*MATERIAL without NAME", error_);
    }
    Material material;
    material.first = b;
    material.end = b + 1;
    while (material.end < blocks_.size() &&
           IsAmong(kMaterialKeywords, blocks_[material.end].keyword.name)) {
      ++material.end;
    }
    if (!materials_.emplace(DeckUpperCase(*name), material).second) {
      return FailInBlock(blocks_[b], "material '" + *name + "' is there twice",
                         error_);
    }
    return true;
  }

  bool AddOwner(size_t b, bool section) {
    const DeckKeyword& keyword = blocks_[b].keyword;
    const std::string* set = keyword.Find("ELSET");
    const std::string* material = keyword.Find("MATERIAL");
    const int index = set == nullptr ? -1 : geometry_.SetIndex(*set);
    // What has no elements here is changed by nobody.
    if (index < 0 || (section && material == nullptr)) return true;
    Owner owner;
    owner.block = b;
    owner.set = *set;
    if (section) owner.material = DeckUpperCase(*material);
    const std::vector<int>& elements =
        geometry_.sets[static_cast<size_t>(index)].elements;
    owner.elements.insert(elements.begin(), elements.end());
    owners_.push_back(std::move(owner));
    return true;
  }

  // Of its stiffness or mass; none where it has no such part.
  std::vector<size_t> BlocksOf(const Owner& owner, bool mass) const {
    if (owner.material.empty()) {
      const bool is_mass = blocks_[owner.block].keyword.name == "*MASS";
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
      const ElementShape shape =
          geometry_.elements[static_cast<size_t>(e)].shape;
      // Points have no stiffness; of others the mass may be none.
      const bool matters = factor.is_mass == (shape == ElementShape::kPoint);
      if (covered.count(e) > 0 || !matters) continue;
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
      auto& kinds = by_material[name];
      auto kept = kinds.find({1.0, 1.0});
      if (kept == kinds.end()) kept = kinds.begin();
      const Material material = materials_.at(name);
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
          name == "*ELASTIC" || name == "*SPRING" ? factors.first
          : name == "*DENSITY" || name == "*MASS" ? factors.second
                                                  : 1.0;
      if (factor == 1.0) continue;
      std::vector<DeckNumber> numbers;
      if (!NumbersOf(block, &numbers, error_)) return false;
      ScaleNumbers(numbers, factor, &block);
    }
    return true;
  }

  // Nothing that may belong to it is left behind.
  bool CanBeCopied(const Material& material) const {
    if (material.end >= blocks_.size()) return true;
    const DeckBlock& next = blocks_[material.end];
    return IsAmong(kBehindMaterials, next.keyword.name) ||
           FailInBlock(next,
                       next.keyword.name +
                           " behind a material that several sections share, "
                           "expected one of their own for the sets that differ",
                       error_);
  }

  std::string NewName(const std::string& material, const std::string& set) {
    const std::string wish =
        (material + "_" + DeckUpperCase(set)).substr(0, 74);
    std::string name = wish;
    for (int n = 2; materials_.count(name) > 0; ++n) {
      name = wish + "_" + std::to_string(n);
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
