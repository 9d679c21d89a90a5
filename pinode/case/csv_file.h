// CSV files of a result folder.

#ifndef PINODE_CASE_CSV_FILE_H_
#define PINODE_CASE_CSV_FILE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// One column of a CSV file; NaN is written as an empty cell.
struct CsvColumn {
  std::string name;
  Vector values;
};

// Columns of equal length under a header line.
[[nodiscard]] bool WriteCsv(const std::string& path,
                            const std::vector<CsvColumn>& columns,
                            std::string* error);

// A cell: quoted where it has to be; at full precision, empty for what is not
// finite.
std::string CsvCell(const std::string& text);
std::string CsvCell(double value);

}  // namespace pinode

#endif  // PINODE_CASE_CSV_FILE_H_
