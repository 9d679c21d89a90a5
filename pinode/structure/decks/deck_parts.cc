#include "pinode/structure/decks/deck_parts.h"

#include <cmath>
#include <string_view>

#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {
namespace {

int PositionOf(const std::unordered_map<std::string, int>& index,
               const std::string& name) {
  const auto place = index.find(DeckKey(name));
  return place == index.end() ? -1 : place->second;
}

class DeckReader {
 public:
  DeckReader(const std::string& path, DeckParts* parts, std::string* error)
      : main_path_(path), parts_(parts), error_(error) {}

  // Reads a file. The data of a keyword may be in a file that is included below
  // it.
  bool ReadFile(const std::string& path, const std::string& content,
                int depth) {
    LineReader lines(path, content);
    std::string_view line;
    const bool is_utf8 = FirstInvalidUtf8(content) == std::string::npos;
    while (NextLine(&lines, &line)) {
      if (!is_utf8 && !CheckEncoding(lines, line)) return false;
      if (line[0] != '*') {
        if (!ReadData(lines, line)) return false;
        continue;
      }
      std::string whole(line);
      while (!whole.empty() && whole.back() == ',' && NextLine(&lines, &line)) {
        if (!is_utf8 && !CheckEncoding(lines, line)) return false;
        whole += line;
      }
      const int number = lines.number();
      if (!EndOfSection(lines)) return false;
      const DeckKeyword keyword = ParseDeckKeyword(whole);
      if (keyword.Is("*INCLUDE")) {
        if (!Include(lines, keyword, path, depth)) return false;
      } else if (!Begin(lines, keyword, number)) {
        return false;
      }
    }
    return EndOfSection(lines);
  }

  const DeckIncludes& includes() const { return includes_; }

 private:
  enum class Section { kOther, kHeading, kNodes, kElements, kSet, kInstance };

  // Reads the next line that is neither blank nor a comment.
  static bool NextLine(LineReader* lines, std::string_view* line) {
    while (lines->Next(line)) {
      if (!line->empty() && line->substr(0, 2) != "**") return true;
    }
    return false;
  }

  // Checks that names are UTF-8, as messages need it. Comments and headings may
  // have any encoding.
  bool CheckEncoding(const LineReader& lines, std::string_view line) const {
    if (line[0] != '*' && section_ == Section::kHeading) return true;
    return FirstInvalidUtf8(std::string(line)) == std::string::npos ||
           lines.Fail(
               "the line is not valid UTF-8, expected other encodings only in "
               "comments and the heading",
               error_);
  }

  DeckScope* Scope() {
    switch (place_.kind) {
      case DeckPlace::Kind::kPart:
        return &parts_->parts[static_cast<size_t>(place_.index)];
      case DeckPlace::Kind::kInstance:
        return &parts_->instances[static_cast<size_t>(place_.index)].own;
      case DeckPlace::Kind::kAssembly:
        break;
    }
    return &parts_->assembly;
  }

  bool Begin(const LineReader& lines, const DeckKeyword& keyword, int number) {
    section_ = Section::kOther;
    type_ = nullptr;
    for (const char* refused :
         {"*SYSTEM", "*NGEN", "*NFILL", "*ELGEN", "*NCOPY", "*ELCOPY"}) {
      if (keyword.Is(refused)) {
        return lines.FailAt(number,
                            std::string(refused) +
                                " is not understood, expected a deck with all "
                                "nodes and elements written out",
                            error_);
      }
    }
    const bool is_read =
        keyword.Is("*NODE") || keyword.Is("*ELEMENT") || keyword.Is("*ELSET");
    if (is_read && keyword.Find("INPUT") != nullptr) {
      return lines.FailAt(
          number, keyword.name + " has INPUT, expected its data below it",
          error_);
    }
    if (keyword.Is("*HEADING")) section_ = Section::kHeading;
    if (keyword.Is("*NODE")) return BeginNodes(lines, keyword, number);
    if (keyword.Is("*ELEMENT")) return BeginElements(lines, keyword, number);
    if (keyword.Is("*ELSET")) return BeginSet(lines, keyword, number);
    if (keyword.Is("*PART") || keyword.Is("*INSTANCE")) {
      return BeginScope(lines, keyword, number);
    }
    place_.Pass(keyword);
    return true;
  }

  bool BeginNodes(const LineReader& lines, const DeckKeyword& keyword,
                  int number) {
    const std::string* system = keyword.Find("SYSTEM");
    if (system != nullptr && DeckKey(*system) != "R") {
      return lines.FailAt(
          number,
          "*NODE has SYSTEM=" + *system + ", expected rectangular coordinates",
          error_);
    }
    section_ = Section::kNodes;
    return true;
  }

  bool BeginElements(const LineReader& lines, const DeckKeyword& keyword,
                     int number) {
    const std::string* type = keyword.Find("TYPE");
    if (type == nullptr || type->empty()) {
      return lines.FailAt(number, "*ELEMENT has no TYPE, expected one", error_);
    }
    section_ = Section::kElements;
    type_ = FindDeckElementType(DeckKey(*type));
    type_name_ = *type;
    const std::string* set = keyword.Find("ELSET");
    set_name_ = set == nullptr ? std::string() : *set;
    if (!set_name_.empty()) Scope()->SetOf(set_name_);
    return true;
  }

  bool BeginSet(const LineReader& lines, const DeckKeyword& keyword,
                int number) {
    const std::string* set = keyword.Find("ELSET");
    if (set == nullptr || set->empty()) {
      return lines.FailAt(number, "*ELSET has no name, expected ELSET=...",
                          error_);
    }
    section_ = Section::kSet;
    set_name_ = *set;
    Scope()->SetOf(set_name_);
    generate_ = keyword.Find("GENERATE") != nullptr;
    set_instance_ = -1;
    const std::string* instance = keyword.Find("INSTANCE");
    if (instance == nullptr) return true;
    set_instance_ = place_.kind == DeckPlace::Kind::kAssembly
                        ? parts_->FindInstance(*instance)
                        : -1;
    return set_instance_ >= 0 ||
           lines.FailAt(number,
                        "*ELSET has INSTANCE=" + *instance +
                            ", expected an *INSTANCE before it, and both in "
                            "the assembly",
                        error_);
  }

  bool BeginScope(const LineReader& lines, const DeckKeyword& keyword,
                  int number) {
    const bool is_part = keyword.Is("*PART");
    const std::string what = is_part ? "*PART" : "*INSTANCE";
    const std::string* name = keyword.Find("NAME");
    if (place_.kind != DeckPlace::Kind::kAssembly) {
      return lines.FailAt(number,
                          what +
                              " begins within a part or an instance, expected "
                              "its end before that",
                          error_);
    }
    if (name == nullptr || name->empty()) {
      return lines.FailAt(number, what + " has no NAME, expected one", error_);
    }
    place_.Pass(keyword);
    const int known =
        is_part ? parts_->FindPart(*name) : parts_->FindInstance(*name);
    if (known >= 0) {
      return lines.FailAt(number,
                          what + " " + Quote(*name) +
                              " is given twice, expected different names",
                          error_);
    }
    if (is_part) {
      parts_->part_index[DeckKey(*name)] =
          static_cast<int>(parts_->parts.size());
      parts_->parts.emplace_back();
      parts_->parts.back().name = WithoutDeckQuotes(*name);
      return true;
    }
    const std::string* part = keyword.Find("PART");
    DeckInstance instance;
    instance.own.name = WithoutDeckQuotes(*name);
    instance.part = part == nullptr ? -1 : parts_->FindPart(*part);
    if (instance.part < 0) {
      return lines.FailAt(
          number,
          "*INSTANCE " + Quote(*name) +
              (part == nullptr ? " has no PART" : " has PART=" + *part) +
              ", expected a *PART before it",
          error_);
    }
    parts_->instance_index[DeckKey(*name)] =
        static_cast<int>(parts_->instances.size());
    parts_->instances.push_back(std::move(instance));
    section_ = Section::kInstance;
    instance_lines_ = 0;
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
        return ReadMotion(lines, line);
      case Section::kHeading:
      case Section::kOther:
        break;
    }
    return true;
  }

  // A line "dx, dy, dz", then two points of an axis and an angle.
  bool ReadMotion(const LineReader& lines, std::string_view line) {
    DeckInstance& instance = parts_->instances.back();
    const bool is_shift = instance_lines_++ == 0;
    const size_t wanted =
        is_shift ? instance.shift.size() : instance.turn.size();
    double* values = is_shift ? instance.shift.data() : instance.turn.data();
    std::vector<std::string_view> fields = pinode::Split(line, ',');
    if (fields.size() > 1 && fields.back().empty()) fields.pop_back();
    bool good = instance_lines_ <= 2 && fields.size() <= wanted &&
                (is_shift || fields.size() == wanted);
    for (size_t k = 0; good && k < fields.size(); ++k) {
      good = fields[k].empty() ||
             (ParseDouble(fields[k], &values[k]) && std::isfinite(values[k]));
    }
    if (good && !is_shift) {
      good = values[0] != values[3] || values[1] != values[4] ||
             values[2] != values[5];
    }
    return good ||
           lines.Fail("an instance has the line " + Quote(line) +
                          ", expected a translation 'dx, dy, dz' and below it "
                          "two points of an axis and an angle",
                      error_);
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
          "the line is " + Quote(line) + ", expected 'node, x, y, z'", error_);
    }
    DeckScope* scope = Scope();
    const auto index = static_cast<int>(scope->positions.size());
    if (!scope->node_index.emplace(number, index).second) {
      return lines.Fail(IsThereTwice("node", number), error_);
    }
    if (++num_nodes_ > kMostDeckItems) return TooMany(lines);
    scope->positions.push_back(position);
    scope->node_numbers.push_back(number);
    return true;
  }

  static std::string IsThereTwice(const std::string& what, int number) {
    return what + " " + std::to_string(number) +
           " is given twice, expected different numbers in a part";
  }

  bool TooMany(const LineReader& lines) const {
    return lines.Fail("more than " + std::to_string(kMostDeckItems) +
                          " nodes or elements, expected fewer",
                      error_);
  }

  // A number, or in an assembly "instance.number".
  bool ReadReference(std::string_view field, DeckReference* reference) const {
    reference->instance = -1;
    if (ParseInt(field, &reference->number)) return true;
    const size_t point = field.rfind('.');
    if (place_.kind != DeckPlace::Kind::kAssembly ||
        point == std::string_view::npos) {
      return false;
    }
    reference->instance =
        parts_->FindInstance(std::string(field.substr(0, point)));
    return reference->instance >= 0 &&
           ParseInt(field.substr(point + 1), &reference->number);
  }

  // Reads an element, which may continue over several lines.
  bool ReadElement(const LineReader& lines, std::string_view line) {
    if (type_ == nullptr) {
      // Counts about one line per element: the note gives their number.
      if (line.back() != ',') CountUnknown();
      return true;
    }
    for (const std::string_view field : pinode::Split(line, ',')) {
      if (StripBlanks(field).empty()) continue;
      DeckReference reference;
      if (!ReadReference(field, &reference)) {
        return lines.Fail(
            "an element has " + Quote(field) + ", expected a number", error_);
      }
      numbers_.push_back(reference);
    }
    const auto wanted = static_cast<size_t>(type_->num_nodes) + 1;
    if (numbers_.size() < wanted) return true;
    if (numbers_.size() > wanted) {
      return lines.Fail("element " + std::to_string(numbers_[0].number) +
                            " has " + std::to_string(numbers_.size() - 1) +
                            " nodes, expected " + std::to_string(wanted - 1) +
                            " of type " + type_name_,
                        error_);
    }
    return AddElement(lines);
  }

  bool AddElement(const LineReader& lines) {
    DeckElement element;
    element.type = type_;
    if (type_->shape == ElementShape::kLine) {
      // The node in the middle of three is the second.
      element.nodes = {numbers_[1], numbers_.back()};
    } else {
      element.nodes.assign(numbers_.begin() + 1,
                           numbers_.begin() + 1 + NumCorners(type_->shape));
    }
    DeckScope* scope = Scope();
    const auto index = static_cast<int>(scope->elements.size());
    const int number = numbers_[0].number;
    if (!scope->element_index.emplace(number, index).second) {
      return lines.Fail(IsThereTwice("element", number), error_);
    }
    if (++num_elements_ > kMostDeckItems) return TooMany(lines);
    scope->elements.push_back(std::move(element));
    scope->element_numbers.push_back(number);
    if (!set_name_.empty()) scope->SetOf(set_name_)->own.push_back(index);
    numbers_.clear();
    return true;
  }

  bool EndOfSection(const LineReader& lines) {
    if (section_ != Section::kElements || numbers_.empty()) return true;
    return lines.Fail("element " + std::to_string(numbers_[0].number) +
                          " has too few nodes for type " + type_name_,
                      error_);
  }

  void CountUnknown() {
    for (auto& [type, count] : parts_->unknown_types) {
      if (type != type_name_) continue;
      ++count;
      return;
    }
    parts_->unknown_types.emplace_back(type_name_, 1);
  }

  // The named sets may follow further below.
  bool ReadSet(const LineReader& lines, std::string_view line) {
    DeckSet* set = Scope()->SetOf(set_name_);
    std::vector<int> numbers;
    for (const std::string_view field : pinode::Split(line, ',')) {
      const std::string_view text = StripBlanks(field);
      if (text.empty()) continue;
      int number = 0;
      if (ParseInt(text, &number)) {
        numbers.push_back(number);
      } else if (generate_) {
        return FailRange(lines, line);
      } else {
        set->names.push_back({std::string(text), set_instance_, lines.Place()});
      }
    }
    if (!generate_) {
      for (const int number : numbers) {
        set->ranges.push_back({number, number, 1, set_instance_});
      }
      return true;
    }
    if (numbers.size() == 2) numbers.push_back(1);
    if (numbers.size() != 3 || numbers[2] < 1 || numbers[1] < numbers[0]) {
      return FailRange(lines, line);
    }
    set->ranges.push_back({numbers[0], numbers[1], numbers[2], set_instance_});
    return true;
  }

  bool FailRange(const LineReader& lines, std::string_view line) const {
    return lines.Fail(
        "the line is " + Quote(line) + ", expected 'first, last, step'",
        error_);
  }

  bool Include(const LineReader& lines, const DeckKeyword& keyword,
               const std::string& path, int depth) {
    std::string other, content;
    return includes_.Read(lines, keyword, path, depth, &other, &content,
                          error_) &&
           ReadFile(other, content, depth + 1);
  }

  const std::string main_path_;
  DeckIncludes includes_{main_path_};
  DeckParts* parts_;
  std::string* error_;
  DeckPlace place_;
  Section section_ = Section::kOther;
  const DeckElementType* type_ = nullptr;
  std::string type_name_, set_name_;
  int set_instance_ = -1;
  int instance_lines_ = 0;
  bool generate_ = false;
  size_t num_nodes_ = 0, num_elements_ = 0;
  std::vector<DeckReference> numbers_;  // of the element that is being read
};

}  // namespace

void DeckPlace::Pass(const DeckKeyword& keyword) {
  if (keyword.Is("*PART")) {
    kind = Kind::kPart;
    index = num_parts++;
  } else if (keyword.Is("*INSTANCE")) {
    kind = Kind::kInstance;
    index = num_instances++;
  } else if (keyword.Is("*END PART") || keyword.Is("*END INSTANCE") ||
             keyword.Is("*ASSEMBLY") || keyword.Is("*END ASSEMBLY")) {
    kind = Kind::kAssembly;
  }
}

DeckSet* DeckScope::SetOf(const std::string& set) {
  const auto [place, added] = set_index.emplace(DeckKey(set), sets.size());
  if (added) {
    sets.emplace_back();
    sets.back().name = set;
  }
  return &sets[place->second];
}

int DeckParts::FindPart(const std::string& name) const {
  return PositionOf(part_index, name);
}

int DeckParts::FindInstance(const std::string& name) const {
  return PositionOf(instance_index, name);
}

bool ReadDeckParts(const std::string& path, const std::string& content,
                   DeckParts* parts, std::string* error) {
  *parts = DeckParts();
  DeckReader reader(path, parts, error);
  if (!reader.ReadFile(path, content, 0)) return false;
  parts->outside = reader.includes().outside();
  return true;
}

}  // namespace pinode
