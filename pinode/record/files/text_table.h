// Tables from text files as data loggers and spreadsheets write them.

#ifndef PINODE_RECORD_FILES_TEXT_TABLE_H_
#define PINODE_RECORD_FILES_TEXT_TABLE_H_

#include <string>
#include <vector>

#include "pinode/record/files/text_format.h"
#include "pinode/record/files/text_layout.h"
#include "pinode/record/table.h"

namespace pinode {

// Reads the columns of a text file. Encoding, delimiter, decimal sign, names,
// units and preamble are found from the text (FindTextLayout), if `format` does
// not give them. Plain CSV is read by ParseCsvTable, as always.
//
// The column `format.time_column` may hold clock times, alone or in columns of
// date, time of day and fractions, or be a part of a clock such as the hour
// beside minutes and seconds. It becomes seconds from the first row. Counters
// that start anew (at 2^14 or 1000, say) and counts of ticks since 1970 or year
// 1 are understood too. Table::time_unit is the unit of the result.
// Table::reading says what was assumed. Table::units are those that the file
// states.
//
// `wanted` as for ReadCsvTable. A name may leave out the unit behind it, and
// has its number behind it if it occurs several times (`a[2]`). An empty
// `wanted` means every column of numbers, and the time.
//
// Refuses, with `path:line: ...` and the key that helps, what has several
// meanings.
[[nodiscard]] bool ReadTextTable(const std::string& path,
                                 const std::vector<std::string>& wanted,
                                 const TextFormat& format, Table* table,
                                 std::string* error);

// Does the same for a text in memory.
[[nodiscard]] bool ParseTextTable(std::string text, const std::string& path,
                                  const std::vector<std::string>& wanted,
                                  const TextFormat& format, Table* table,
                                  std::string* error);

// Columns of a text file, from its beginning alone.
struct TextOutline {
  std::vector<TextColumn> columns;
  // Column that is the time by its name or contents, or -1.
  int time_column = -1;
  // Columns that make up a clock, such as hour, minute and second, or a date
  // and a time of day; empty if the time is a column of numbers.
  std::vector<int> time_parts;
  // Other time columns that differ from it, such as `t2` beside `t1`. The
  // channels may then belong to any of the clocks.
  std::vector<int> other_clocks;
  // Columns of a second clock that says the same as the time, part by part:
  // Hour, Min and Sec beside a time stamp.
  std::vector<int> repeated_parts;
  // True for channels: columns that are not the time or a part of it, another
  // time, row numbers or texts.
  std::vector<bool> is_channel;

  // Returns the names of columns that are no channels, because they are called
  // as times and parts of clocks are, and no part of the time either. `time` is
  // the column that is used as the time; empty: none.
  std::vector<std::string> UnusedTimes(const std::string& time) const;
};

// Reads the outline of a text file.
[[nodiscard]] bool ReadTextOutline(const std::string& path,
                                   const TextFormat& format,
                                   TextOutline* outline, std::string* error);

// Does the same for a text in memory.
[[nodiscard]] bool ParseTextOutline(std::string text, const std::string& path,
                                    const TextFormat& format,
                                    TextOutline* outline, std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_TEXT_TABLE_H_
