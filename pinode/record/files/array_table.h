// Reads records from files that hold arrays by name: MATLAB, NumPy, HDF5.

#ifndef PINODE_RECORD_FILES_ARRAY_TABLE_H_
#define PINODE_RECORD_FILES_ARRAY_TABLE_H_

#include <string>
#include <vector>

#include "pinode/record/files/text_format.h"
#include "pinode/record/table.h"

namespace pinode {

// Reads the arrays of a file (see base/arrays/array_files.h) as a table. An
// array of one dimension becomes the column of its name. An array of two
// dimensions becomes the columns "name[1]", "name[2]" and so on; time runs
// along its longer dimension. NaN is a missing value. `wanted` as for
// ReadCsvTable; empty: all columns of the arrays that have the most samples.
//
// Refuses with `path: ...`: an unreadable file, an unknown column (with the
// nearest name), and wanted arrays of different lengths, of more than two
// dimensions, or with complex or infinite numbers.
[[nodiscard]] bool ReadArrayTable(const std::string& path,
                                  const std::vector<std::string>& wanted,
                                  Table* table, std::string* error);

// Reads any table. Universal files and arrays by name are known by their
// extension, files of loggers by their first bytes or extension
// (FindLoggerFormat). All others are text (ReadTextTable), to which alone
// `format` applies.
[[nodiscard]] bool ReadTable(const std::string& path,
                             const std::vector<std::string>& wanted,
                             const TextFormat& format, Table* table,
                             std::string* error);

// True for the name of a time: "t" or "time", alone or as the last part, as in
// "data.time" and "setup1/t". "T" may be a temperature or a direction.
bool IsTimeOfArrays(const std::string& name);

// Times among the columns of a table: those called so (IsTimeOfArrays) whose
// numbers rise from row to row. NaN is passed over.
struct ArrayTimes {
  // The time; empty: there is none.
  std::string time;
  // Further times, which are no channels.
  std::vector<std::string> others;
  // The first of `others` that is another clock than `time`, as of a second
  // logger; empty: none. Channels may then belong to either.
  std::string other_clock;
};

// Finds the times of a table. The time is `given`, if that is not empty, else
// "t", else "time", else the first one.
ArrayTimes FindArrayTimes(const Table& table, const std::string& given);

// True if ReadTable takes the file for text in columns. A format with header
// lines or a delimiter makes an LVM file one.
bool IsTextFile(const std::string& path, const TextFormat& format = {});

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_ARRAY_TABLE_H_
