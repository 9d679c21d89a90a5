// CSV files of a result folder.

#ifndef PINODE_CASE_TEXT_CSV_FILE_H_
#define PINODE_CASE_TEXT_CSV_FILE_H_

#include <functional>
#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Column of a CSV file; NaN is written as an empty cell.
struct CsvColumn {
  CsvColumn(std::string column_name, Vector values);
  // Makes a column of a long table, whose values are computed when written.
  CsvColumn(std::string column_name, Eigen::Index num_rows,
            std::function<double(Eigen::Index row)> value_of);

  std::string name;
  Eigen::Index size = 0;
  std::function<double(Eigen::Index row)> value;
};

// Writes columns of equal length under a header line.
[[nodiscard]] bool WriteCsv(const std::string& path,
                            const std::vector<CsvColumn>& columns,
                            std::string* error);

// Return a cell: text quoted if necessary, with an apostrophe before what a
// spreadsheet would run as a formula (=, +, -, @); numbers at full precision,
// empty if not finite.
std::string CsvCell(const std::string& text);
std::string CsvCell(double value);

// Returns the text that a reader finds in such a cell.
std::string CsvText(const std::string& text);

}  // namespace pinode

#endif  // PINODE_CASE_TEXT_CSV_FILE_H_
