// Records in files that hold arrays by name: MATLAB, NumPy, HDF5.

#ifndef PINODE_RECORD_FILES_ARRAY_TABLE_H_
#define PINODE_RECORD_FILES_ARRAY_TABLE_H_

#include <string>
#include <vector>

#include "pinode/record/table.h"

namespace pinode {

// The arrays of a file (see base/arrays/array_files.h) as a table: an array of
// one dimension is the column of its name, of one of two dimensions the columns
// are "name[1]", "name[2]" and so on, the longer dimension being that of time.
// NaN is a missing value. `wanted` as for ReadCsvTable; empty: all columns of
// the arrays that have the most samples.
//
// Refused with `path: ...`: an unreadable file, an unknown column (with the
// nearest name), wanted arrays of different lengths, of more than two
// dimensions, with complex or infinite numbers.
[[nodiscard]] bool ReadArrayTable(const std::string& path,
                                  const std::vector<std::string>& wanted,
                                  Table* table, std::string* error);

// Any table, by what the file's extension says: universal files, arrays by
// name, else CSV.
[[nodiscard]] bool ReadTable(const std::string& path,
                             const std::vector<std::string>& wanted,
                             Table* table, std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_ARRAY_TABLE_H_
