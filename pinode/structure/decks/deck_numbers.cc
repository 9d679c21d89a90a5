#include "pinode/structure/decks/deck_numbers.h"

#include <cmath>
#include <cstdio>
#include <string_view>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

std::vector<std::string_view> FieldsOf(const std::string& line) {
  return Split(line, ',');
}

// Returns a number as text. CalculiX and Abaqus read twenty characters.
// CalculiX distinguishes a number from a direction by its decimal point.
std::string FormatDeckNumber(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.13E", value);
  return text;
}

// Finds the fields that are moduli, for each line of one set of constants.
bool ModuliOf(const DeckBlock& block, std::vector<std::vector<size_t>>* by_line,
              std::string* error) {
  const std::string* given = block.keyword.Find("TYPE");
  const std::string type = given == nullptr ? "ISO" : DeckKey(*given);
  if (type == "ISO" || type == "ISOTROPIC") {
    *by_line = {{0}};
  } else if (block.keyword.Find("DEPENDENCIES") != nullptr) {
    return FailInDeckBlock(block,
                           "*ELASTIC with DEPENDENCIES, expected constants "
                           "that depend on temperature only",
                           error);
  } else if (type == "ENGINEERINGCONSTANTS") {
    *by_line = {{0, 1, 2, 6, 7}, {0}};
  } else if (type == "ORTHO" || type == "ORTHOTROPIC") {
    *by_line = {{0, 1, 2, 3, 4, 5, 6, 7}, {0}};
  } else if (type == "LAMINA") {
    *by_line = {{0, 1, 3, 4, 5}};
  } else if (type == "ANISO" || type == "ANISOTROPIC") {
    *by_line = {
        {0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 2, 3, 4}};
  } else {
    return FailInDeckBlock(block,
                           "*ELASTIC, TYPE=" + *given +
                               ", expected ISO, ENGINEERING CONSTANTS, ORTHO, "
                               "LAMINA or ANISO",
                           error);
  }
  return true;
}

// Returns true for one or two directions of 1 to 6, with or without a comma
// behind them.
bool AreDirections(const std::string& line) {
  std::vector<std::string_view> fields = FieldsOf(line);
  if (fields.size() > 1 && StripBlanks(fields.back()).empty()) {
    fields.pop_back();
  }
  bool directions = fields.size() <= 2;
  for (const std::string_view field : fields) {
    int direction = 0;
    directions = directions && ParseInt(StripBlanks(field), &direction) &&
                 direction >= 1 && direction <= 6;
  }
  return directions;
}

// Finds the lines below *SPRING that have constants or forces.
bool DropDirections(const DeckBlock& block, SpringStart start,
                    std::vector<size_t>* data, std::string* error) {
  if (start == SpringStart::kConstants || data->empty()) return true;
  const std::string& first = block.lines[data->front()];
  const bool must = start == SpringStart::kDirections;
  // A blank line instead of directions means that there are none.
  const bool blank =
      data->front() > 0 && StripBlanks(block.lines[data->front() - 1]).empty();
  const bool maybe =
      !blank && data->size() > 1 &&
      first.find_first_not_of("0123456789, \t\r") == std::string::npos;
  if (!must && !maybe) return true;
  if (!AreDirections(first)) {
    return FailInDeckBlock(block,
                           "*SPRING begins with '" +
                               std::string(StripBlanks(first)) +
                               "', expected directions" +
                               (must ? "" : ", or numbers with a point"),
                           error);
  }
  data->erase(data->begin());
  return true;
}

// Finds, for each line of one set of constants, the fields that are
// proportional to stiffness or mass.
bool ScaledFieldsOf(const DeckBlock& block,
                    std::vector<std::vector<size_t>>* by_line,
                    std::string* error) {
  *by_line = {{0}};
  if (block.keyword.Is("*ELASTIC")) return ModuliOf(block, by_line, error);
  if (block.keyword.Is("*ROTARY INERTIA")) *by_line = {{0, 1, 2, 3, 4, 5}};
  const std::string* type = block.keyword.Find("TYPE");
  if (block.keyword.Is("*MASS") && type != nullptr &&
      DeckKey(*type) != "ISOTROPIC") {
    return FailInDeckBlock(
        block, "*MASS, TYPE=" + *type + ", expected an isotropic one", error);
  }
  return true;
}

}  // namespace

bool FailInDeckBlock(const DeckBlock& block, const std::string& what,
                     std::string* error) {
  *error = block.place + ": " + what;
  return false;
}

bool FindDeckNumbers(const DeckBlock& block, SpringStart start,
                     std::vector<DeckNumber>* numbers, std::string* error) {
  std::vector<size_t> data = block.DataLines();
  std::vector<std::vector<size_t>> by_line;
  if (!ScaledFieldsOf(block, &by_line, error) ||
      (block.keyword.Is("*SPRING") &&
       !DropDirections(block, start, &data, error))) {
    return false;
  }
  if (data.empty()) {
    return FailInDeckBlock(block, block.keyword.name + " has no numbers",
                           error);
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
        return FailInDeckBlock(block,
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

void ScaleDeckNumbers(const std::vector<DeckNumber>& numbers, double factor,
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
    line = Join(fields, ",") + DeckLineEnd(line);
  }
}

std::vector<double> DeckValues(const std::vector<DeckNumber>& numbers,
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

}  // namespace pinode
