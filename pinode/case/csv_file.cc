#include "pinode/case/csv_file.h"

#include <cmath>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {

std::string CsvCell(const std::string& text) {
  if (text.find_first_of(",;\t\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string CsvCell(double value) {
  return std::isfinite(value) ? FormatNumber(value) : "";
}

bool WriteCsv(const std::string& path, const std::vector<CsvColumn>& columns,
              std::string* error) {
  CHECK(!columns.empty());
  std::string text;
  for (size_t j = 0; j < columns.size(); ++j) {
    CHECK_EQ(columns[j].values.size(), columns[0].values.size())
        << "column '" << columns[j].name << "' differs in length";
    text += (j > 0 ? "," : "") + CsvCell(columns[j].name);
  }
  text += "\n";
  for (Eigen::Index i = 0; i < columns[0].values.size(); ++i) {
    for (size_t j = 0; j < columns.size(); ++j) {
      if (j > 0) text += ",";
      text += CsvCell(columns[j].values[i]);
    }
    text += "\n";
  }
  return WriteFileAtomically(path, text, error);
}

}  // namespace pinode
