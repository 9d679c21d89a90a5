#include "pinode/case/text/csv_file.h"

#include <cmath>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Number of bytes that are written at a time.
constexpr size_t kChunk = 1 << 20;

// True for a text that spreadsheets take for a formula and run: it begins with
// one of these, and is no number.
bool IsFormula(const std::string& text) {
  double number = 0.0;
  return text.find_first_of("=+-@\t\r") == 0 && !ParseDouble(text, &number);
}

}  // namespace

std::string CsvText(const std::string& text) {
  // Spreadsheets show what follows the apostrophe as it is.
  return IsFormula(text) ? "'" + text : text;
}

std::string CsvCell(const std::string& name) {
  const std::string text = CsvText(name);
  if (text.find_first_of(",;\t\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string CsvCell(double value) {
  return std::isfinite(value) ? FormatNumber(value) : "";
}

CsvColumn::CsvColumn(std::string column_name, Vector values)
    : name(std::move(column_name)),
      size(values.size()),
      value(
          [held = std::move(values)](Eigen::Index row) { return held[row]; }) {}

CsvColumn::CsvColumn(std::string column_name, Eigen::Index num_rows,
                     std::function<double(Eigen::Index row)> value_of)
    : name(std::move(column_name)),
      size(num_rows),
      value(std::move(value_of)) {}

bool WriteCsv(const std::string& path, const std::vector<CsvColumn>& columns,
              std::string* error) {
  CHECK(!columns.empty());
  std::string header;
  for (size_t j = 0; j < columns.size(); ++j) {
    CHECK_EQ(columns[j].size, columns[0].size)
        << "column '" << columns[j].name << "' differs in length";
    header += (j > 0 ? "," : "") + CsvCell(columns[j].name);
  }
  header += "\n";
  Eigen::Index row = 0;
  const auto next = [&](std::string* chunk) {
    std::swap(*chunk, header);
    while (row < columns[0].size && chunk->size() < kChunk) {
      for (size_t j = 0; j < columns.size(); ++j) {
        if (j > 0) *chunk += ",";
        *chunk += CsvCell(columns[j].value(row));
      }
      *chunk += "\n";
      ++row;
    }
  };
  return WriteFileAtomically(path, next, error);
}

}  // namespace pinode
