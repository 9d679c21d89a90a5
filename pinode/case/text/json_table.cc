#include "pinode/case/text/json_table.h"

#include <nlohmann/json.hpp>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/case/text/csv_file.h"

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

std::string Cell(const Json& value) {
  if (value.is_string()) return CsvCell(value.get<std::string>());
  if (value.is_boolean()) return value.get<bool>() ? "1" : "0";
  if (value.is_number()) return CsvCell(value.get<double>());
  if (value.is_array()) {
    return CsvCell(Join(value.get<std::vector<std::string>>(), " "));
  }
  return "";
}

}  // namespace

std::string TableOfEntries(const Json& entries) {
  std::vector<std::string> keys;
  for (const auto& cell : entries.front().items()) {
    keys.push_back(CsvCell(cell.key()));
  }
  std::string text = Join(keys, ",") + "\n";
  for (const Json& entry : entries) {
    std::vector<std::string> cells;
    for (const Json& value : entry) cells.push_back(Cell(value));
    text += Join(cells, ",") + "\n";
  }
  return text;
}

}  // namespace pinode
