// Tables of numbers with named columns, as data loggers write them.

#ifndef PINODE_RECORD_TABLE_H_
#define PINODE_RECORD_TABLE_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Clock time at which the times of a table are zero.
struct TimeOrigin {
  enum class Kind {
    kNone,       // times are numbers
    kTimeOfDay,  // without a date
    kDate,
    kDoubtfulDate,  // the order of day, month and year is open
  };
  Kind kind = Kind::kNone;
  // Seconds since 1970-01-01, or since midnight.
  double seconds = 0.0;
};

struct Table {
  // File of the table, for messages.
  std::string path;
  std::vector<std::string> columns;
  // Values, rows x columns; NaN for an empty cell.
  Matrix values;
  // For each row, the line of the file on which it begins (from 1).
  std::vector<int64_t> line_numbers;
  // Units of the columns as the file states them, by their names in the table
  // of units; empty: none. No entries: none for all columns.
  std::vector<std::string> units;
  // Unit of the time column; empty: not known, that of the caller.
  std::string time_unit;
  TimeOrigin time_origin;
  // Sentence on what was assumed on reading; empty for plain files.
  std::string reading;

  Eigen::Index num_rows() const { return values.rows(); }
  // Returns the position in `columns`, or -1.
  int FindColumn(const std::string& name) const;
};

// Returns the delimiter that the header line contains most often: tab,
// semicolon or comma.
char CsvDelimiter(std::string_view text);

// Reads a table: a header line with the columns' names, then one line per row.
//
// The delimiter is the one that the header line contains most often: tab,
// semicolon or comma. Cells may be quoted ("..."; a quote inside is doubled).
// Blank lines, lines that begin with '#', a byte order mark and all kinds of
// line ends are accepted. Numbers have a decimal point (see ParseDouble()). An
// empty cell or another one by IsMissing() is a missing value.
//
// Only the columns in `wanted` are kept, in that order (a repeated name is kept
// once). Text or infinite numbers in other columns are ignored. An empty
// `wanted` means every column of the file.
//
// Refuses with `path:line: ...`:
//
// - an unreadable file;
// - no header or no rows;
// - an unknown column (with the nearest name), or one whose name occurs twice;
// - rows with more or fewer cells than the header;
// - text in a wanted column (decimal commas are explained);
// - stray or unclosed quotes.
[[nodiscard]] bool ReadCsvTable(const std::string& path,
                                const std::vector<std::string>& wanted,
                                Table* table, std::string* error);

// Does what ReadCsvTable does, for a text in memory. `path` is only used in
// messages.
[[nodiscard]] bool ParseCsvTable(std::string text, const std::string& path,
                                 const std::vector<std::string>& wanted,
                                 Table* table, std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_TABLE_H_
