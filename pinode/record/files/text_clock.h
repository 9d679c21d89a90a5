// Clock times of a text file: the columns that hold them, and their seconds.

#ifndef PINODE_RECORD_FILES_TEXT_CLOCK_H_
#define PINODE_RECORD_FILES_TEXT_CLOCK_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pinode/record/files/clock.h"
#include "pinode/record/files/clock_parts.h"
#include "pinode/record/files/text_format.h"
#include "pinode/record/files/text_layout.h"
#include "pinode/record/table.h"

namespace pinode {

// Columns that make up a time: a clock time in one column, a date, a time of
// day and a fraction of a second, or a column for each part of the clock.
struct TimeParts {
  int date = -1;      // or date and time of day
  int time = -1;      // time of day
  int fraction = -1;  // by its name: "ms"
  double fraction_in_seconds = 0.0;
  // Columns of numbers; complete only without the columns above.
  ClockParts split;

  bool IsClock() const { return date >= 0 || time >= 0 || split.IsComplete(); }
  int Last() const;
  // All columns of the clock; empty: the time is a column of numbers.
  std::vector<int> Columns() const;
  // True if a column is a date, a time of day or a fraction.
  bool Has(int column) const {
    return column >= 0 && (column == date || column == time ||
                           column == fraction || column == split.fraction);
  }
};

// Finds the parts that belong to a column of clock times. A column of numbers
// has none unless it is a part of a complete clock by its name, or the format
// says that it holds clock times. With a unit of the time it is the whole time.
TimeParts FindTimeParts(const TextLayout& layout, const TextFormat& format,
                        int column);

// Clock times of the rows of a file.
class TextClock {
 public:
  // Finds the parts of the time. `layout` and `format` must outlive this.
  TextClock(const TextLayout& layout, const TextFormat& format, int column);

  const TimeParts& parts() const { return parts_; }
  // Times of the rows that were added, as they are written.
  const std::vector<ClockCell>& cells() const { return clock_; }
  // Forgets all rows, and makes room for some.
  void Clear(size_t num_rows);

  // True if a cell beside the time says AM or PM, and the hour of the row is 12
  // at most. Columns of other states may be called so.
  bool HasHalfBeside(const std::vector<std::string_view>& cells, char decimal);

  // Adds the time of a row. The cells must reach to the last part. Fails with a
  // sentence that begins with the column's name.
  [[nodiscard]] bool Add(const std::vector<std::string_view>& cells,
                         char decimal, std::string* error);

  // Converts the times of all rows to seconds from the first one. *row is that
  // of an error. *said describes what was read.
  [[nodiscard]] bool Finish(Vector* times, TimeOrigin* origin,
                            std::string* said, size_t* row,
                            std::string* error) const;

 private:
  const std::string& NameOf(int column) const;
  // Parses the time of a row. On failure *what may say why.
  bool Parse(const std::vector<std::string_view>& cells, char decimal,
             ClockCell* cell, std::string* what) const;
  std::string NamesOfParts() const;
  // Says which keys help if a part of the clock cannot be one.
  std::string RemedyFor(int column) const;

  const TextLayout& layout_;
  const TextFormat& format_;
  const int column_;
  const TimeParts parts_;
  std::vector<ClockCell> clock_;
};

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_TEXT_CLOCK_H_
