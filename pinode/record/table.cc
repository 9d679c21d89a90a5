#include "pinode/record/table.h"

#include <csv.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/record/number_rows.h"

namespace pinode {
namespace {

constexpr char kByteOrderMark[] = "\xEF\xBB\xBF";

// Iterates over the rows of a CSV text. libcsv splits a row into cells. Lines
// are passed to it one by one, so that each row's line is known. Blank lines
// and comments are never passed to it.
class CsvRows {
 public:
  CsvRows(std::string_view text, char delimiter)
      : text_(text), delimiter_(delimiter) {
    CHECK_EQ(csv_init(&parser_, CSV_STRICT), 0);
    csv_set_delim(&parser_, static_cast<unsigned char>(delimiter));
  }
  ~CsvRows() { csv_free(&parser_); }
  CsvRows(const CsvRows&) = delete;
  CsvRows& operator=(const CsvRows&) = delete;

  // False at the end of the text, or with *error set (else left alone) if the
  // text is malformed; the message begins with the line number.
  bool Next(std::string* error) {
    cells_.clear();
    row_ended_ = false;
    bool row_began = false;
    while (position_ < text_.size()) {
      const std::string_view line = NextLine();
      if (!row_began) {
        // A line of tabs is a row of missing values.
        const bool has_cells = delimiter_ == '\t' &&
                               line.find('\t') != std::string_view::npos &&
                               StripBlanks(line).empty();
        if (IsNoRow(line) && !has_cells) continue;
        row_began = true;
        first_line_ = line_number_;
      }
      if (!Feed(line) || !Feed("\n")) {
        *error = std::to_string(line_number_) +
                 ": stray quote, expected cells quoted as a whole (\"...\", "
                 "with a quote inside doubled)";
        return false;
      }
      if (row_ended_) return true;
    }
    if (row_began) {
      *error = std::to_string(first_line_) +
               ": a quoted cell begins here and is never closed";
    }
    return false;
  }

  // Reads the next line if it holds plain numbers only. Returns false, and
  // stays in front of the line, if it does not.
  bool NextNumbers(const NumberRow& row, double* values,
                   std::ptrdiff_t stride) {
    const size_t end = std::min(text_.find('\n', position_), text_.size());
    if (end <= position_ ||
        !row.Parse(text_.substr(position_, end - position_), values, stride)) {
      return false;
    }
    position_ = end + 1;
    first_line_ = ++line_number_;
    return true;
  }

  const std::vector<std::string>& cells() const { return cells_; }
  // The line on which the current row begins.
  int64_t line_number() const { return first_line_; }

  static bool IsNoRow(std::string_view line) {
    const std::string_view stripped = StripBlanks(line);
    return stripped.empty() || stripped.front() == '#';
  }

 private:
  std::string_view NextLine() {
    const size_t end = std::min(text_.find('\n', position_), text_.size());
    std::string_view line = text_.substr(position_, end - position_);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    position_ = end + 1;
    ++line_number_;
    return line;
  }

  bool Feed(std::string_view bytes) {
    return csv_parse(&parser_, bytes.data(), bytes.size(), &CsvRows::OnCell,
                     &CsvRows::OnRowEnd, this) == bytes.size();
  }

  static void OnCell(void* cell, size_t size, void* self) {
    static_cast<CsvRows*>(self)->cells_.emplace_back(
        static_cast<const char*>(cell), size);
  }
  static void OnRowEnd(int, void* self) {
    static_cast<CsvRows*>(self)->row_ended_ = true;
  }

  std::string_view text_;
  char delimiter_;
  csv_parser parser_;
  size_t position_ = 0;
  int64_t line_number_ = 0;
  int64_t first_line_ = 0;
  bool row_ended_ = false;
  std::vector<std::string> cells_;
};

bool IsDigits(std::string_view cell) {
  cell = StripBlanks(cell);
  if (!cell.empty() && (cell.front() == '-' || cell.front() == '+')) {
    cell.remove_prefix(1);
  }
  return !cell.empty() && std::all_of(cell.begin(), cell.end(), [](char c) {
    return c >= '0' && c <= '9';
  });
}

std::string RaggedRowMessage(const CsvRows& rows, size_t expected,
                             char delimiter) {
  const std::vector<std::string>& cells = rows.cells();
  std::string message =
      std::to_string(cells.size()) + (cells.size() == 1 ? " cell" : " cells") +
      ", expected " + std::to_string(expected) + " as in the header line";
  if (delimiter == ',' && cells.size() > expected &&
      std::all_of(cells.begin(), cells.end(), IsDigits)) {
    message += "; the numbers probably have decimal commas. Use decimal points";
  } else if (cells.size() < expected) {
    message += "; delete the line if it is no row";
  } else if (cells.size() == expected + 1 &&
             StripBlanks(cells.back()).empty()) {
    message +=
        "; the row ends with a delimiter. End the header line with one, too";
  }
  return message;
}

std::string BadCellMessage(const std::string& cell) {
  std::string pointed = cell;
  const size_t comma = pointed.find(',');
  double number = 0.0;
  if (comma != std::string::npos) {
    pointed[comma] = '.';
    if (ParseDouble(pointed, &number)) {
      return "'" + cell + "' has a decimal comma, expected a decimal point ('" +
             std::string(StripBlanks(pointed)) + "')";
    }
  }
  return "'" + cell +
         "' is not a number; write nan for a missing value, and delete lines "
         "that are no rows";
}

// Finds the position of each wanted column in the header.
bool LocateColumns(const std::vector<std::string>& header, int64_t header_line,
                   const std::vector<std::string>& wanted,
                   const std::string& path, std::vector<std::string>* columns,
                   std::vector<size_t>* positions, std::string* error) {
  const std::string where = path + ":" + std::to_string(header_line) + ": ";
  for (const std::string& name : wanted.empty() ? header : wanted) {
    // A name asked for twice is one column; a header's own repetition is
    // caught by the count below.
    if (!wanted.empty() &&
        std::find(columns->begin(), columns->end(), name) != columns->end()) {
      continue;
    }
    const auto found = std::find(header.begin(), header.end(), name);
    if (found == header.end()) {
      std::vector<std::string> named;
      std::copy_if(header.begin(), header.end(), std::back_inserter(named),
                   [](const std::string& known) { return !known.empty(); });
      *error =
          where + "no column is named '" + name + "'" + NameHint(name, named);
      return false;
    }
    const auto again = std::find(found + 1, header.end(), name);
    if (again != header.end()) {
      *error = where + "the name '" + name + "' occurs twice, in columns " +
               std::to_string(found - header.begin() + 1) + " and " +
               std::to_string(again - header.begin() + 1) +
               ", expected it once";
      return false;
    }
    columns->push_back(name);
    positions->push_back(static_cast<size_t>(found - header.begin()));
  }
  return true;
}

}  // namespace

// The first candidate wins a tie: a comma is most likely part of a name.
char CsvDelimiter(std::string_view text) {
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (CsvRows::IsNoRow(line)) continue;
    char best = ',';
    int best_count = 0;
    for (const char candidate : {'\t', ';', ','}) {
      int count = 0;
      bool quoted = false;
      for (const char c : line) {
        if (c == '"') quoted = !quoted;
        if (c == candidate && !quoted) ++count;
      }
      if (count > best_count) {
        best = candidate;
        best_count = count;
      }
    }
    return best;
  }
  return ',';
}

int Table::FindColumn(const std::string& name) const {
  const auto found = std::find(columns.begin(), columns.end(), name);
  return found == columns.end() ? -1
                                : static_cast<int>(found - columns.begin());
}

bool ReadCsvTable(const std::string& path,
                  const std::vector<std::string>& wanted, Table* table,
                  std::string* error) {
  std::string text;
  return ReadTextFile(path, &text, error) &&
         ParseCsvTable(std::move(text), path, wanted, table, error);
}

bool ParseCsvTable(std::string text, const std::string& path,
                   const std::vector<std::string>& wanted, Table* table,
                   std::string* error) {
  CHECK(table != nullptr);
  CHECK(error != nullptr);
  if (text.rfind(kByteOrderMark, 0) == 0) text.erase(0, 3);
  // Files of some old instruments have lines that end with a carriage return
  // alone.
  if (text.find('\n') == std::string::npos) {
    std::replace(text.begin(), text.end(), '\r', '\n');
  }

  const char delimiter = CsvDelimiter(text);
  CsvRows rows(text, delimiter);
  std::string malformed;
  if (!rows.Next(&malformed)) {
    *error = malformed.empty()
                 ? path +
                       ": is empty, expected a header line with the "
                       "columns' names and one line a sample"
                 : path + ":" + malformed;
    return false;
  }
  std::vector<std::string> header;
  bool all_numbers = true;
  double number = 0.0;
  for (const std::string& cell : rows.cells()) {
    header.emplace_back(StripBlanks(cell));
    if (!ParseDouble(header.back(), &number)) all_numbers = false;
  }
  const int64_t header_line = rows.line_number();
  if (all_numbers) {
    *error = path + ":" + std::to_string(header_line) +
             ": the first line holds numbers, expected the columns' names "
             "(lines that begin with '#' are comments)";
    return false;
  }

  Table result;
  result.path = path;
  std::vector<size_t> positions;
  if (!LocateColumns(header, header_line, wanted, path, &result.columns,
                     &positions, error)) {
    return false;
  }

  // Long records are read directly into their final memory.
  const Eigen::Index lines = std::count(text.begin(), text.end(), '\n') +
                             (text.back() == '\n' ? 0 : 1);
  result.values.resize(lines - header_line,
                       static_cast<Eigen::Index>(positions.size()));
  result.line_numbers.reserve(static_cast<size_t>(result.values.rows()));
  std::vector<int> columns(header.size(), -1);
  for (size_t j = 0; j < positions.size(); ++j) {
    columns[positions[j]] = static_cast<int>(j);
  }
  const NumberRow numbers(delimiter, '.', std::move(columns));
  Eigen::Index row = 0;
  while (true) {
    if (row < result.values.rows() &&
        rows.NextNumbers(numbers, result.values.data() + row,
                         result.values.rows())) {
      ++row;
      result.line_numbers.push_back(rows.line_number());
      continue;
    }
    if (!rows.Next(&malformed)) break;
    const std::string where =
        path + ":" + std::to_string(rows.line_number()) + ": ";
    if (rows.cells().size() != header.size()) {
      *error = where + RaggedRowMessage(rows, header.size(), delimiter);
      return false;
    }
    for (size_t j = 0; j < positions.size(); ++j) {
      const std::string& cell = rows.cells()[positions[j]];
      double value = std::numeric_limits<double>::quiet_NaN();
      if (!IsMissing(StripBlanks(cell)) && !ParseDouble(cell, &value)) {
        *error = where + "column '" + result.columns[j] +
                 "': " + BadCellMessage(cell);
        return false;
      }
      if (std::isinf(value)) {
        *error = where + "column '" + result.columns[j] + "': '" + cell +
                 "' is not finite; write nan for a missing value";
        return false;
      }
      result.values(row, static_cast<Eigen::Index>(j)) = value;
    }
    ++row;
    result.line_numbers.push_back(rows.line_number());
  }
  if (!malformed.empty()) {
    *error = path + ":" + malformed;
    return false;
  }
  if (result.line_numbers.empty()) {
    *error = path + ":" + std::to_string(header_line) +
             ": no rows of numbers below the header line";
    return false;
  }
  if (row < result.values.rows()) {
    result.values.conservativeResize(row, Eigen::NoChange);
  }
  *table = std::move(result);
  return true;
}

}  // namespace pinode
