// Tables of numbers with named columns, as data loggers write them.

#ifndef PINODE_RECORD_TABLE_H_
#define PINODE_RECORD_TABLE_H_

#include <cstdint>
#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

struct Table {
  // Where it was read from, for messages.
  std::string path;
  std::vector<std::string> columns;
  // rows x columns; NaN where the cell is empty.
  Matrix values;
  // Per row, the line of the file on which it begins (from 1).
  std::vector<int64_t> line_numbers;

  Eigen::Index num_rows() const { return values.rows(); }
  // Position in `columns`, or -1.
  int FindColumn(const std::string& name) const;
};

// Reads a table: a header line with the columns' names, then one line a row.
//
// The delimiter is the one that the header line holds most often: tab,
// semicolon or comma. Cells may be quoted ("..."; a quote inside is doubled).
// Blank lines, lines that begin with '#', a byte order mark and all kinds of
// line ends are accepted. Numbers have a decimal point (see ParseDouble());
// an empty cell or "nan" is a missing value.
//
// Only the columns in `wanted` are kept, in that order (a name twice is kept
// once); text or infinite numbers in other columns do no harm. An empty
// `wanted` means every column of the file.
//
// Refused with `path:line: ...`: an unreadable file, no header or no rows, an
// unknown column (with the nearest name) or one whose name occurs twice, rows
// with more or fewer cells than the header, text in a wanted column (decimal
// commas are explained), stray or unclosed quotes.
[[nodiscard]] bool ReadCsvTable(const std::string& path,
                                const std::vector<std::string>& wanted,
                                Table* table, std::string* error);

// As ReadCsvTable, of a text in memory; `path` serves messages only.
[[nodiscard]] bool ParseCsvTable(std::string text, const std::string& path,
                                 const std::vector<std::string>& wanted,
                                 Table* table, std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_TABLE_H_
