// The time column of a text file: its name, its unit, and times as numbers.

#ifndef PINODE_RECORD_FILES_TEXT_TIME_H_
#define PINODE_RECORD_FILES_TEXT_TIME_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pinode/record/files/text_format.h"
#include "pinode/record/table.h"

namespace pinode {

// Vibration is hardly ever sampled at longer steps, s. Loggers of 1000, 2000
// and 2560 Hz that count milliseconds have steps of 1, 0.5 and 0.39.
constexpr double kLongestStepOfSeconds = 0.3;

// True for names that people and loggers give to the time.
bool IsNameOfTime(const std::string& name);

// True for names with a word of the time, such as "seconds_elapsed" and "Sample
// time". Only the numbers tell that the column is one: "Travel time" may be a
// channel.
bool HasWordOfTime(const std::string& name);

// Returns the unit that a name alone states: "ms", "time_us". Empty if none.
std::string UnitOfTimeName(const std::string& name);

// Returns the unit below a second that a line above the rows states for the
// time, such as "ms" of "# time in ms", with the number of that line; empty:
// none does. The lines `names` are those of names and units.
std::string UnitOfTimeAbove(std::string_view preamble,
                            const std::vector<int64_t>& names, int64_t* line);

// Returns the seconds of one count of a clock since 1970 or the year 1, told by
// the size of its first number; 0 for other numbers.
double SecondsOfTicks(double first);

// Brings the numbers of a time column to a unit that FindTimeGrid can use:
// finds it (*unit is that of the file, or empty), counts ticks of clocks in
// seconds from the first row, and continues counters that start anew. Sets
// table->time_unit and, for clocks, the origin. Appends to *said what was
// assumed. `first` is what was subtracted from all numbers because they are too
// large for a double, or 0. Fails with a sentence for numbers with several
// meanings.
[[nodiscard]] bool ReadTimeNumbers(const TextFormat& format,
                                   const std::string& file_unit, int column,
                                   double first, Table* table,
                                   std::string* said, std::string* error);

// Continues times that start anew after a fixed range: a power of two or ten,
// minutes, hours, days. The range is taken only where the step over each start
// is that of the other rows. *range is 0 without one.
void UnwrapCounter(const std::vector<double>& ranges, Eigen::Ref<Vector> times,
                   double* range);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_TEXT_TIME_H_
