#include "pinode/structure/decks/bulk_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/structure/decks/deck_keyword.h"
#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {
namespace {

struct BulkElement {
  const char* name;
  ElementShape shape;
  size_t first_node;  // field of it, the card's name being 0
  bool has_property;  // field 2
};

constexpr BulkElement kBulkElements[] = {
    {"CBAR", ElementShape::kLine, 3, true},
    {"CBEAM", ElementShape::kLine, 3, true},
    {"CROD", ElementShape::kLine, 3, true},
    {"CTUBE", ElementShape::kLine, 3, true},
    {"CONROD", ElementShape::kLine, 2, false},
    {"CTRIA3", ElementShape::kTriangle, 3, true},
    {"CTRIA6", ElementShape::kTriangle, 3, true},
    {"CTRIAR", ElementShape::kTriangle, 3, true},
    {"CQUAD4", ElementShape::kQuadrilateral, 3, true},
    {"CQUAD8", ElementShape::kQuadrilateral, 3, true},
    {"CQUADR", ElementShape::kQuadrilateral, 3, true},
    {"CSHEAR", ElementShape::kQuadrilateral, 3, true},
    {"CTETRA", ElementShape::kTetrahedron, 3, true},
    {"CPYRAM", ElementShape::kPyramid, 3, true},
    {"CPENTA", ElementShape::kWedge, 3, true},
    {"CHEXA", ElementShape::kHexahedron, 3, true},
    {"CONM2", ElementShape::kPoint, 2, false},
};

const BulkElement* FindBulkElement(const std::string& name) {
  for (const BulkElement& element : kBulkElements) {
    if (name == element.name) return &element;
  }
  return nullptr;
}

// Returns true for cards that need no note: springs, coordinate systems and
// other cards with C that draw nothing.
bool IsSilent(const std::string& name) {
  return name.substr(0, 5) == "CELAS" || name.substr(0, 4) == "CORD" ||
         name.substr(0, 5) == "CDAMP" || name.substr(0, 5) == "CMASS" ||
         name.substr(0, 5) == "CONM1" || name.substr(0, 5) == "CBUSH";
}

// "1.5-3" is 1.5e-3.
bool ParseBulkNumber(std::string_view text, double* value) {
  std::string number(text);
  for (size_t i = 1; i < number.size(); ++i) {
    const char before = number[i - 1];
    if ((number[i] == '+' || number[i] == '-') &&
        (before == '.' || (before >= '0' && before <= '9'))) {
      number.insert(i, 1, 'e');
      break;
    }
    if (number[i] == 'd' || number[i] == 'D') number[i] = 'e';
  }
  return ParseDouble(number, value) && std::isfinite(*value);
}

struct BulkCard {
  std::string name;
  std::vector<std::string> fields;  // from 0, the name
  int line = 0;
};

class BulkReader {
 public:
  BulkReader(const std::string& path, std::string_view content,
             StructureGeometry* geometry, std::string* error)
      : lines_(path, content),
        path_(path),
        geometry_(geometry),
        error_(error) {}

  bool Read() {
    std::string_view line;
    while (!ended_ && lines_.NextRaw(&line)) {
      line = line.substr(0, line.find('$'));
      if (StripBlanks(line).empty()) continue;
      if (!AddLine(line)) return false;
    }
    return EndCard() && Finish();
  }

 private:
  // Returns the fields of a line behind its first field, which is stored in
  // *name.
  static std::vector<std::string> FieldsOfLine(std::string_view line,
                                               std::string* name) {
    std::vector<std::string> fields;
    if (line.find(',') != std::string_view::npos) {
      const std::vector<std::string_view> parts = Split(line, ',');
      *name = std::string(StripBlanks(parts[0]));
      const bool wide = parts[0].find('*') != std::string_view::npos;
      // Fields left out at the end are blank: the next line starts with its
      // own.
      fields.resize(wide ? 4 : 8);
      for (size_t i = 1; i < parts.size() && i <= fields.size(); ++i) {
        fields[i - 1] = std::string(StripBlanks(parts[i]));
      }
      return fields;
    }
    const auto cut = [&line](size_t from, size_t width) {
      return from < line.size()
                 ? std::string(StripBlanks(line.substr(from, width)))
                 : std::string();
    };
    *name = cut(0, 8);
    const bool wide = name->find('*') != std::string::npos;
    const size_t width = wide ? 16 : 8;
    for (size_t i = 0; i < (wide ? 4u : 8u); ++i) {
      fields.push_back(cut(8 + i * width, width));
    }
    return fields;
  }

  bool AddLine(std::string_view line) {
    std::string name;
    std::vector<std::string> fields = FieldsOfLine(line, &name);
    const bool goes_on = name.empty() || name[0] == '+' || name[0] == '*';
    if (goes_on && !card_.fields.empty()) {
      card_.fields.insert(card_.fields.end(), fields.begin(), fields.end());
      return true;
    }
    if (!EndCard()) return false;
    name.erase(std::remove(name.begin(), name.end(), '*'), name.end());
    card_.name = DeckUpperCase(name);
    card_.fields = {card_.name};
    card_.fields.insert(card_.fields.end(), fields.begin(), fields.end());
    card_.line = lines_.number();
    if (card_.name.substr(0, 7) == "INCLUDE") {
      return lines_.Fail("INCLUDE, expected a file with all nodes and elements",
                         error_);
    }
    ended_ = card_.name == "ENDDATA";
    return true;
  }

  bool FailAtCard(const std::string& what) const {
    return lines_.FailAt(card_.line, what, error_);
  }

  const std::string& Field(size_t i) const {
    static const auto& none = *new std::string;
    return i < card_.fields.size() ? card_.fields[i] : none;
  }

  bool EndCard() {
    bool good = true;
    if (card_.name == "GRID") {
      good = AddGrid();
    } else if (card_.name == "GRDSET") {
      good = AreBasic("GRDSET");
    } else if (const BulkElement* element = FindBulkElement(card_.name)) {
      good = AddElement(*element);
    } else if (card_.name.size() > 1 && card_.name[0] == 'C' &&
               !IsSilent(card_.name) && !geometry_->node_names.empty()) {
      ++unknown_[card_.name];
    }
    card_ = BulkCard();
    return good;
  }

  // Checks the systems of coordinates and of displacements.
  bool AreBasic(const std::string& what) const {
    for (const size_t system : {2u, 6u}) {
      if (Field(system).empty() || Field(system) == "0") continue;
      return FailAtCard(what + " is in system " + Field(system) +
                        ", expected the basic one");
    }
    return true;
  }

  // GRID, number, system, x, y, z, system of displacements, ...
  bool AddGrid() {
    int number = 0;
    if (!ParseInt(Field(1), &number)) {
      return FailAtCard("GRID has '" + Field(1) + "', expected a number");
    }
    if (!AreBasic("GRID " + std::to_string(number))) return false;
    std::array<double, 3> position = {0.0, 0.0, 0.0};
    for (size_t k = 0; k < 3; ++k) {
      const std::string& field = Field(3 + k);
      if (!field.empty() && !ParseBulkNumber(field, &position[k])) {
        return FailAtCard("GRID " + std::to_string(number) + " has '" + field +
                          "', expected a coordinate");
      }
    }
    if (!index_.emplace(number, static_cast<int>(positions_.size())).second) {
      return FailAtCard("GRID " + std::to_string(number) +
                        " is given twice, expected different numbers");
    }
    geometry_->node_names.push_back(std::to_string(number));
    positions_.push_back(position);
    return true;
  }

  bool AddElement(const BulkElement& type) {
    StructureGeometry::Element element;
    element.shape = type.shape;
    for (int k = 0; k < NumCorners(type.shape); ++k) {
      const std::string& field =
          Field(type.first_node + static_cast<size_t>(k));
      int node = 0;
      if (!ParseInt(field, &node)) {
        return FailAtCard(card_.name + " has '" + field +
                          "', expected the number of a node");
      }
      element.nodes.push_back(node);
    }
    if (type.has_property) {
      // The default is the element's own number.
      const std::string& property = Field(2).empty() ? Field(1) : Field(2);
      sets_[property].push_back(static_cast<int>(geometry_->elements.size()));
    }
    geometry_->elements.push_back(std::move(element));
    element_lines_.push_back(card_.line);
    return true;
  }

  bool Finish() {
    if (positions_.empty()) {
      *error_ = path_ + ": it has no GRID, expected bulk data";
      return false;
    }
    geometry_->positions.resize(static_cast<Eigen::Index>(positions_.size()),
                                3);
    for (size_t i = 0; i < positions_.size(); ++i) {
      for (size_t k = 0; k < 3; ++k) {
        geometry_->positions(static_cast<Eigen::Index>(i),
                             static_cast<Eigen::Index>(k)) = positions_[i][k];
      }
    }
    for (size_t e = 0; e < geometry_->elements.size(); ++e) {
      for (int& node : geometry_->elements[e].nodes) {
        const auto place = index_.find(node);
        if (place == index_.end()) {
          return lines_.FailAt(element_lines_[e],
                               "an element has node " + std::to_string(node) +
                                   ", which has no GRID",
                               error_);
        }
        node = place->second;
      }
    }
    for (auto& [property, elements] : sets_) {
      geometry_->sets.push_back({"PID " + property, std::move(elements)});
    }
    for (const auto& [name, count] : unknown_) {
      geometry_->notes.push_back(
          std::to_string(count) + " cards " + name +
          " are not drawn, because the pictures do not know them.");
    }
    return true;
  }

  LineReader lines_;
  const std::string& path_;
  StructureGeometry* geometry_;
  std::string* error_;
  BulkCard card_;
  bool ended_ = false;
  std::unordered_map<int, int> index_;
  std::vector<std::array<double, 3>> positions_;
  std::vector<int> element_lines_;
  std::map<std::string, std::vector<int>> sets_;
  std::map<std::string, int> unknown_;
};

}  // namespace

bool ParseBulkGeometry(const std::string& path, const std::string& content,
                       StructureGeometry* geometry, std::string* error) {
  *geometry = StructureGeometry();
  return BulkReader(path, content, geometry, error).Read();
}

bool ReadBulkGeometry(const std::string& path, StructureGeometry* geometry,
                      std::string* error) {
  std::string content;
  return ReadTextFile(path, &content, error) &&
         ParseBulkGeometry(path, content, geometry, error);
}

bool IsBulkFile(const std::string& path) {
  const size_t point = path.rfind('.');
  if (point == std::string::npos) return false;
  const std::string extension = DeckUpperCase(path.substr(point));
  return extension == ".BDF" || extension == ".NAS" || extension == ".DAT";
}

}  // namespace pinode
