// Clocks whose parts stand in columns of their own: year, day, hour, minute and
// second.

#ifndef PINODE_RECORD_FILES_CLOCK_PARTS_H_
#define PINODE_RECORD_FILES_CLOCK_PARTS_H_

#include <string>
#include <string_view>
#include <vector>

#include "pinode/record/files/clock.h"
#include "pinode/record/files/text_layout.h"

namespace pinode {

// Returns the unit of a part of a clock that stands in a column of its own, by
// its name: "day" for "DOY" and "Tag", "s" for "Second", "year", "month" and
// "date". Empty for other names.
std::string UnitOfClockPart(const std::string& name);

// Returns the seconds that a column of fractions of a second counts in, by its
// name: 1e-3 for "ms" and "Milliseconds". 0 for other columns, such as
// "Exposure [ms]".
double FractionOfColumn(const TextColumn& column);

// Columns of the parts; -1: there is none.
struct ClockParts {
  int date = -1;  // text, such as 2024-03-01
  int year = -1;
  int month = -1;
  int day = -1;          // of the month
  int day_of_year = -1;  // from 1
  int hour = -1;
  int minute = -1;
  int second = -1;
  // Whole milliseconds, microseconds or nanoseconds behind the second.
  int fraction = -1;
  double fraction_in_seconds = 0.0;

  // True if the parts are a clock.
  bool IsComplete() const { return second >= 0; }
  // Columns of the parts from the date down, without the fraction.
  std::vector<int> Columns() const;
  // True if `column` is one of Columns().
  bool Has(int column) const;
  // Largest column.
  int Last() const;
};

// Finds the parts by the names of the columns. They are complete with hour,
// minute and second, and either a whole date (a date; year, month and day; year
// and day of the year) or no part of one. Other columns are no clock: a name
// that occurs twice, or a day without its year.
ClockParts FindClockParts(const std::vector<TextColumn>& columns);

// Parses the parts of a row. On failure *bad is the column of the bad part and
// *error says what was expected.
[[nodiscard]] bool ParseClockParts(const std::vector<std::string_view>& cells,
                                   const ClockParts& parts, char decimal,
                                   ClockCell* cell, int* bad,
                                   std::string* error);

// True if a cell says AM or PM: hours beside it count to 12.
bool HasHalfOfDay(const std::vector<std::string_view>& cells);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_CLOCK_PARTS_H_
