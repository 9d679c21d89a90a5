// Clock times in text: dates, times of day, and both.

#ifndef PINODE_RECORD_FILES_CLOCK_H_
#define PINODE_RECORD_FILES_CLOCK_H_

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace pinode {

// Fields of a clock time as written. The order of a date's day and month is
// decided from all rows of a column, see ResolveClock().
struct ClockCell {
  bool has_date = false;
  bool has_time = false;
  // Numbers of the date, in the order of the text; a month's name is its
  // number.
  std::array<int, 3> date = {0, 0, 0};
  std::array<int, 3> digits = {0, 0, 0};
  bool month_is_named = false;
  char separator = 0;
  // Seconds since midnight.
  double seconds = 0.0;
  // Distance of the zone from UTC in minutes, if the text has one.
  bool has_zone = false;
  int zone = 0;
};

// Parses a whole cell: "2024-03-01 12:00:00.005", "01.03.2024 12:00:00,005",
// "20240301T120000Z", "12:00:00.005", "3/1/2024 12:00:00 PM", "01-Mar-2024".
// Fractions follow '.' or ','; three or six digits may also follow ':'. Two
// numbers ("12:30") are not parsed: they are hours or minutes.
[[nodiscard]] bool ParseClock(std::string_view text, ClockCell* cell);

// Parses a cell by a format of strptime (POSIX). A fraction may follow %S, or
// stands where %f is.
[[nodiscard]] bool ParseClockBy(const std::string& format,
                                std::string_view text, ClockCell* cell);

// A column of clock times.
struct ClockColumn {
  // Seconds since the first row.
  std::vector<double> seconds;
  // Time of the first row: seconds since 1970-01-01, in UTC if the text has
  // zones; without dates, since midnight.
  double origin = 0.0;
  bool is_dated = false;
  // False if day and month cannot be told apart, and need not be.
  bool is_order_certain = true;
  // Name of what was read, such as "year-month-day, time of day".
  std::string format;
  // Text of the first row.
  std::string first;
};

// Finds the order of the dates and the seconds since the first row. All cells
// must be of one kind. Where several orders are possible and the times differ,
// the one is taken whose steps are all shorter than a day, else the one whose
// steps are even. If none or several are, *error asks for `time_format`.
// `bad_row` is the row of an error, or -1.
[[nodiscard]] bool ResolveClock(const std::vector<ClockCell>& cells,
                                ClockColumn* column, int64_t* bad_row,
                                std::string* error);

// Returns "2024-03-01 12:00:00.005" or "12:00:00.005".
std::string ClockText(double origin, bool is_dated);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_CLOCK_H_
