#include "pinode/structure/deck_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/structure/deck_keyword.h"
#include "pinode/structure/matrix_text.h"

namespace pinode {
namespace {

constexpr size_t kMostItems = 2000000;

struct ElementType {
  const char* name;  // without the letters of its formulation
  ElementShape shape;
  int num_nodes;
};

// Corners come first but in lines of three nodes.
constexpr ElementType kElementTypes[] = {
    {"C3D4", ElementShape::kTetrahedron, 4},
    {"C3D10", ElementShape::kTetrahedron, 10},
    {"C3D5", ElementShape::kPyramid, 5},
    {"C3D6", ElementShape::kWedge, 6},
    {"C3D15", ElementShape::kWedge, 15},
    {"C3D8", ElementShape::kHexahedron, 8},
    {"C3D20", ElementShape::kHexahedron, 20},
    {"C3D27", ElementShape::kHexahedron, 27},
    {"SC6", ElementShape::kWedge, 6},
    {"SC8", ElementShape::kHexahedron, 8},
    {"S3", ElementShape::kTriangle, 3},
    {"S6", ElementShape::kTriangle, 6},
    {"STRI3", ElementShape::kTriangle, 3},
    {"STRI65", ElementShape::kTriangle, 6},
    {"M3D3", ElementShape::kTriangle, 3},
    {"M3D6", ElementShape::kTriangle, 6},
    {"CPS3", ElementShape::kTriangle, 3},
    {"CPS6", ElementShape::kTriangle, 6},
    {"CPE3", ElementShape::kTriangle, 3},
    {"CPE6", ElementShape::kTriangle, 6},
    {"S4", ElementShape::kQuadrilateral, 4},
    {"S8", ElementShape::kQuadrilateral, 8},
    {"S9", ElementShape::kQuadrilateral, 9},
    {"M3D4", ElementShape::kQuadrilateral, 4},
    {"M3D8", ElementShape::kQuadrilateral, 8},
    {"CPS4", ElementShape::kQuadrilateral, 4},
    {"CPS8", ElementShape::kQuadrilateral, 8},
    {"CPE4", ElementShape::kQuadrilateral, 4},
    {"CPE8", ElementShape::kQuadrilateral, 8},
    {"B21", ElementShape::kLine, 2},
    {"B22", ElementShape::kLine, 3},
    {"B23", ElementShape::kLine, 2},
    {"B31", ElementShape::kLine, 2},
    {"B32", ElementShape::kLine, 3},
    {"B33", ElementShape::kLine, 2},
    {"PIPE31", ElementShape::kLine, 2},
    {"PIPE32", ElementShape::kLine, 3},
    {"T2D2", ElementShape::kLine, 2},
    {"T2D3", ElementShape::kLine, 3},
    {"T3D2", ElementShape::kLine, 2},
    {"T3D3", ElementShape::kLine, 3},
    {"SPRINGA", ElementShape::kLine, 2},
    {"SPRING2", ElementShape::kLine, 2},
    {"DASHPOTA", ElementShape::kLine, 2},
    {"DASHPOT2", ElementShape::kLine, 2},
    {"GAPUNI", ElementShape::kLine, 2},
    {"CONN3D2", ElementShape::kLine, 2},
    {"MASS", ElementShape::kPoint, 1},
    {"ROTARYI", ElementShape::kPoint, 1},
    {"SPRING1", ElementShape::kPoint, 1},
    {"DASHPOT1", ElementShape::kPoint, 1},
};

// The longest name with nothing but letters of a formulation, as in C3D8I or
// S9R5, behind it; nullptr: not known.
const ElementType* FindType(const std::string& name) {
  const ElementType* best = nullptr;
  for (const ElementType& type : kElementTypes) {
    const std::string_view known(type.name);
    if (name.compare(0, known.size(), known) != 0) continue;
    const bool digit = name.size() > known.size() &&
                       name[known.size()] >= '0' && name[known.size()] <= '9';
    if (digit) continue;
    if (best == nullptr || known.size() > std::string_view(best->name).size()) {
      best = &type;
    }
  }
  return best;
}

class DeckReader {
 public:
  DeckReader(StructureGeometry* geometry, std::string* error)
      : geometry_(geometry), error_(error) {}

  bool ReadFile(const std::string& path, const std::string& content,
                int depth) {
    LineReader lines(path, content);
    std::string_view line;
    section_ = Section::kOther;
    while (NextLine(&lines, &line)) {
      if (line[0] != '*') {
        if (!ReadData(lines, line)) return false;
        continue;
      }
      std::string whole(line);
      while (!whole.empty() && whole.back() == ',' && NextLine(&lines, &line)) {
        whole += line;
      }
      const int number = lines.number();
      if (!EndOfSection(lines)) return false;
      const DeckKeyword keyword = ParseDeckKeyword(whole);
      if (keyword.name == "*INCLUDE") {
        if (!Include(lines, keyword, path, depth)) return false;
        section_ = Section::kOther;
      } else if (!Begin(lines, keyword, number)) {
        return false;
      }
    }
    return EndOfSection(lines);
  }

  // What elements and sets say of each other, once all is read.
  bool Finish(const std::string& path) {
    const auto nodes = static_cast<Eigen::Index>(positions_.size());
    geometry_->positions.resize(nodes, 3);
    for (Eigen::Index i = 0; i < nodes; ++i) {
      for (int k = 0; k < 3; ++k) {
        geometry_->positions(i, k) =
            positions_[static_cast<size_t>(i)][static_cast<size_t>(k)];
      }
    }
    if (nodes == 0) {
      *error_ = path + ": it has no *NODE, expected an input deck";
      return false;
    }
    for (const auto& [number, index] : element_index_) {
      for (int& node : geometry_->elements[static_cast<size_t>(index)].nodes) {
        const auto place = node_index_.find(node);
        if (place == node_index_.end()) {
          *error_ = path + ": element " + std::to_string(number) +
                    " has node " + std::to_string(node) +
                    ", which no *NODE gives a place";
          return false;
        }
        node = place->second;
      }
    }
    for (Set& set : sets_) {
      std::sort(set.elements.begin(), set.elements.end());
      set.elements.erase(std::unique(set.elements.begin(), set.elements.end()),
                         set.elements.end());
      geometry_->sets.push_back({set.name, std::move(set.elements)});
    }
    for (const auto& [type, count] : unknown_types_) {
      geometry_->notes.push_back(
          std::to_string(count) + " elements of type " + type +
          " are left out of the pictures, which do not know it.");
    }
    return true;
  }

 private:
  enum class Section { kOther, kNodes, kElements, kSet, kInstance };
  struct Set {
    std::string name;
    std::vector<int> elements;
  };

  // Neither blank nor a comment.
  static bool NextLine(LineReader* lines, std::string_view* line) {
    while (lines->Next(line)) {
      if (!line->empty() && line->substr(0, 2) != "**") return true;
    }
    return false;
  }

  Set* SetOf(const std::string& name) {
    const std::string key = DeckUpperCase(name);
    const auto [place, added] = set_index_.emplace(key, sets_.size());
    if (added) sets_.push_back({name, {}});
    return &sets_[place->second];
  }

  bool Begin(const LineReader& lines, const DeckKeyword& keyword, int number) {
    section_ = Section::kOther;
    type_ = nullptr;
    for (const char* refused :
         {"*SYSTEM", "*NGEN", "*NFILL", "*ELGEN", "*NCOPY", "*ELCOPY"}) {
      if (keyword.name == refused) {
        return lines.FailAt(number,
                            std::string(refused) +
                                " is not understood, expected a deck with all "
                                "nodes and elements written out",
                            error_);
      }
    }
    const bool is_read = keyword.name == "*NODE" ||
                         keyword.name == "*ELEMENT" || keyword.name == "*ELSET";
    if (is_read && keyword.Find("INPUT") != nullptr) {
      return lines.FailAt(
          number, keyword.name + " has INPUT, expected its data below it",
          error_);
    }
    if (keyword.name == "*NODE") {
      const std::string* system = keyword.Find("SYSTEM");
      if (system != nullptr && DeckUpperCase(*system) != "R") {
        return lines.FailAt(number,
                            "*NODE has SYSTEM=" + *system +
                                ", expected rectangular coordinates",
                            error_);
      }
      section_ = Section::kNodes;
    } else if (keyword.name == "*ELEMENT") {
      const std::string* type = keyword.Find("TYPE");
      if (type == nullptr || type->empty()) {
        return lines.FailAt(number, "*ELEMENT has no TYPE, expected one",
                            error_);
      }
      section_ = Section::kElements;
      type_ = FindType(DeckUpperCase(*type));
      type_name_ = *type;
      if (const std::string* set = keyword.Find("ELSET"))
        set_name_ = *set;
      else
        set_name_.clear();
      if (type_ != nullptr && !set_name_.empty()) SetOf(set_name_);
    } else if (keyword.name == "*ELSET") {
      const std::string* set = keyword.Find("ELSET");
      if (set == nullptr || set->empty()) {
        return lines.FailAt(number, "*ELSET has no name, expected ELSET=...",
                            error_);
      }
      section_ = Section::kSet;
      set_name_ = *set;
      SetOf(set_name_);
      generate_ = keyword.Find("GENERATE") != nullptr;
    } else if (keyword.name == "*INSTANCE") {
      section_ = Section::kInstance;
    }
    return true;
  }

  bool ReadData(const LineReader& lines, std::string_view line) {
    switch (section_) {
      case Section::kNodes:
        return ReadNode(lines, line);
      case Section::kElements:
        return ReadElement(lines, line);
      case Section::kSet:
        return ReadSet(lines, line);
      case Section::kInstance:
        return lines.Fail(
            "the instance of a part is moved, expected a part where it is",
            error_);
      case Section::kOther:
        break;
    }
    return true;
  }

  bool ReadNode(const LineReader& lines, std::string_view line) {
    const std::vector<std::string_view> fields = pinode::Split(line, ',');
    int number = 0;
    std::array<double, 3> position = {0.0, 0.0, 0.0};
    bool good = ParseInt(fields[0], &number) && fields.size() >= 2;
    for (size_t k = 1; good && k < fields.size() && k <= 3; ++k) {
      good = StripBlanks(fields[k]).empty() ||
             (ParseDouble(fields[k], &position[k - 1]) &&
              std::isfinite(position[k - 1]));
    }
    if (!good) {
      return lines.Fail(
          "the line is " + Quote(line) + ", and 'node, x, y, z' was expected",
          error_);
    }
    if (!node_index_.emplace(number, static_cast<int>(positions_.size()))
             .second) {
      return lines.Fail("node " + std::to_string(number) +
                            " is there twice, expected one part",
                        error_);
    }
    if (positions_.size() >= kMostItems) return TooMany(lines);
    positions_.push_back(position);
    geometry_->node_names.push_back(std::to_string(number));
    return true;
  }

  bool TooMany(const LineReader& lines) const {
    return lines.Fail("more than " + std::to_string(kMostItems) +
                          " nodes or elements, expected fewer",
                      error_);
  }

  // An element may go on over lines.
  bool ReadElement(const LineReader& lines, std::string_view line) {
    if (type_ == nullptr) {
      // One line an element, about: the note says how many there are.
      if (line.back() != ',') CountUnknown();
      return true;
    }
    for (const std::string_view field : pinode::Split(line, ',')) {
      if (StripBlanks(field).empty()) continue;
      int number = 0;
      if (!ParseInt(field, &number)) {
        return lines.Fail(
            "an element has " + Quote(field) + ", and a number was expected",
            error_);
      }
      numbers_.push_back(number);
    }
    const auto wanted = static_cast<size_t>(type_->num_nodes) + 1;
    if (numbers_.size() < wanted) return true;
    if (numbers_.size() > wanted) {
      return lines.Fail("element " + std::to_string(numbers_[0]) + " has " +
                            std::to_string(numbers_.size() - 1) +
                            " nodes, expected " + std::to_string(wanted - 1) +
                            " of type " + type_name_,
                        error_);
    }
    return AddElement(lines);
  }

  bool AddElement(const LineReader& lines) {
    StructureGeometry::Element element;
    element.shape = type_->shape;
    if (type_->shape == ElementShape::kLine) {
      // The node in the middle of three is the second.
      element.nodes = {numbers_[1], numbers_.back()};
    } else {
      element.nodes.assign(numbers_.begin() + 1,
                           numbers_.begin() + 1 + NumCorners(type_->shape));
    }
    const auto index = static_cast<int>(geometry_->elements.size());
    if (!element_index_.emplace(numbers_[0], index).second) {
      return lines.Fail("element " + std::to_string(numbers_[0]) +
                            " is there twice, expected one part",
                        error_);
    }
    if (geometry_->elements.size() >= kMostItems) return TooMany(lines);
    geometry_->elements.push_back(std::move(element));
    if (!set_name_.empty()) SetOf(set_name_)->elements.push_back(index);
    numbers_.clear();
    return true;
  }

  bool EndOfSection(const LineReader& lines) {
    if (section_ != Section::kElements || numbers_.empty()) return true;
    return lines.Fail("element " + std::to_string(numbers_[0]) +
                          " has too few nodes for type " + type_name_,
                      error_);
  }

  void CountUnknown() {
    for (auto& [type, count] : unknown_types_) {
      if (type != type_name_) continue;
      ++count;
      return;
    }
    unknown_types_.emplace_back(type_name_, 1);
  }

  bool ReadSet(const LineReader& lines, std::string_view line) {
    Set* set = SetOf(set_name_);
    std::vector<int> numbers;
    for (const std::string_view field : pinode::Split(line, ',')) {
      const std::string_view text = StripBlanks(field);
      if (text.empty()) continue;
      int number = 0;
      if (ParseInt(text, &number)) {
        numbers.push_back(number);
        continue;
      }
      const auto other = set_index_.find(DeckUpperCase(text));
      if (generate_ || other == set_index_.end()) {
        return lines.Fail("set '" + set_name_ + "' has " + Quote(text) +
                              ", and elements or a set before it were expected",
                          error_);
      }
      const std::vector<int> copy = sets_[other->second].elements;
      set->elements.insert(set->elements.end(), copy.begin(), copy.end());
    }
    if (!generate_) {
      for (const int number : numbers) AddToSet(number, set);
      return true;
    }
    if (numbers.size() == 2) numbers.push_back(1);
    if (numbers.size() != 3 || numbers[2] < 1 || numbers[1] < numbers[0]) {
      return lines.Fail("the line is " + Quote(line) +
                            ", and 'first, last, step' was expected",
                        error_);
    }
    // Elements that are there, however far the numbers go.
    for (const auto& [number, index] : element_index_) {
      if (number >= numbers[0] && number <= numbers[1] &&
          (number - numbers[0]) % numbers[2] == 0) {
        set->elements.push_back(index);
      }
    }
    return true;
  }

  // Those of unknown types are not there.
  void AddToSet(int number, Set* set) {
    const auto place = element_index_.find(number);
    if (place != element_index_.end()) set->elements.push_back(place->second);
  }

  bool Include(const LineReader& lines, const DeckKeyword& keyword,
               const std::string& path, int depth) {
    std::string other, content;
    return ReadDeckInclude(lines, keyword, path, depth, &other, &content,
                           error_) &&
           ReadFile(other, content, depth + 1);
  }

  StructureGeometry* geometry_;
  std::string* error_;
  Section section_ = Section::kOther;
  const ElementType* type_ = nullptr;
  std::string type_name_, set_name_;
  bool generate_ = false;
  std::vector<int> numbers_;  // of the element that is being read
  std::vector<std::array<double, 3>> positions_;
  std::unordered_map<int, int> node_index_, element_index_;
  std::vector<Set> sets_;
  std::unordered_map<std::string, size_t> set_index_;
  std::vector<std::pair<std::string, int>> unknown_types_;
};

}  // namespace

bool ParseDeckGeometry(const std::string& path, const std::string& content,
                       StructureGeometry* geometry, std::string* error) {
  StructureGeometry result;
  DeckReader reader(&result, error);
  if (!reader.ReadFile(path, content, 0) || !reader.Finish(path)) return false;
  *geometry = std::move(result);
  return true;
}

bool ReadDeckGeometry(const std::string& path, StructureGeometry* geometry,
                      std::string* error) {
  std::string content;
  return ReadTextFile(path, &content, error) &&
         ParseDeckGeometry(path, content, geometry, error);
}

}  // namespace pinode
