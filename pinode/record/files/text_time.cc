#include "pinode/record/files/text_time.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "pinode/base/file_text.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/base/unit_names.h"
#include "pinode/base/units.h"
#include "pinode/record/files/clock.h"
#include "pinode/record/files/clock_parts.h"

namespace pinode {
namespace {

constexpr double kSecondsOfOneDay = 86400.0;

// Counts of clocks that are told by their size, between the years 1998 and
// 2042.
struct Ticks {
  double lowest;
  double highest;
  double seconds;
  double zero;  // seconds since 1970-01-01
  const char* name;
};
constexpr Ticks kTicks[] = {
    {9e11, 2.3e12, 1e-3, 0.0, "milliseconds since 1970"},
    {9e14, 2.3e15, 1e-6, 0.0, "microseconds since 1970"},
    {9e17, 2.3e18, 1e-9, 0.0, "nanoseconds since 1970"},
    // .NET: 100 ns since the year 1.
    {6.3e17, 6.45e17, 1e-7, -62135596800.0, "ticks of 100 ns since year 1"}};

// Days as spreadsheets (since 1900) and MATLAB (since year 0) count them are of
// the size of seconds; only their small steps tell.
constexpr double kDays[][2] = {{36000.0, 60000.0}, {7.2e5, 7.8e5}};
constexpr double kLargestStepOfDays = 1e-3;
// Seconds since 1970, between the years 1998 and 2042. With a step of at most a
// minute they are no counts of microseconds.
constexpr double kEpochSeconds[] = {9e8, 2.3e9};
constexpr double kLargestStepOfEpoch = 60.0;

// Parts of a day as spreadsheets count them are below 1. Read as seconds, no
// logger of vibration has such a rate, in Hz.
constexpr double kHighestLoggerRate = 200e3;
// Records in seconds begin near 0; those in parts of a day anywhere. The times
// begin late after this many steps, and then steps below the limit are few
// seconds of a day.
constexpr double kLateSteps = 100.0;
constexpr double kLargestStepOfLate = 1e-4;
// Rounding of such a step, in parts of it.
constexpr double kRounding = 1e-6;

// Seconds between 59 and the next minute, and the next hour, of numbers such as
// 125959 that are written without signs between.
constexpr double kPackedSteps[] = {40.0, 4040.0};

double MedianStep(const Eigen::Ref<const Vector>& times) {
  std::vector<double> steps;
  for (Eigen::Index i = 1; i < times.size(); ++i) {
    const double step = times[i] - times[i - 1];
    if (step > 0.0) steps.push_back(step);
  }
  return steps.empty() ? 0.0 : Median(steps);
}

// True for whole seconds of clocks, by their size.
bool AreEpochSeconds(const Eigen::Ref<const Vector>& times) {
  return times[0] >= kEpochSeconds[0] && times[0] <= kEpochSeconds[1] &&
         MedianStep(times) <= kLargestStepOfEpoch;
}

// True for hours, minutes and seconds in one number each: no part reaches 60,
// and 59 s are followed by the next minute.
bool ArePackedClocks(const Eigen::Ref<const Vector>& times, Eigen::Index* row) {
  std::vector<Eigen::Index> jumps;
  for (Eigen::Index i = 0; i < times.size(); ++i) {
    if (!(times[i] >= 0.0) || std::fmod(times[i], 100.0) >= 60.0 ||
        std::fmod(std::floor(times[i] / 100.0), 100.0) >= 60.0) {
      return false;
    }
    if (i > 0 && times[i] - times[i - 1] >= kPackedSteps[0]) jumps.push_back(i);
  }
  if (jumps.empty()) return false;
  // Larger steps need a unit anyway.
  const double step = MedianStep(times);
  if (step > kLongestStepOfSeconds) return false;
  for (const Eigen::Index i : jumps) {
    for (const double gap : kPackedSteps) {
      const double over = times[i] - times[i - 1] - gap;
      if (std::abs(over - step) >= 0.5 * step) continue;
      *row = i;
      return true;
    }
  }
  return false;
}

// True for times between 0 and 1 that may be parts of a day.
bool MayBePartsOfADay(const Eigen::Ref<const Vector>& times) {
  Eigen::Index last = times.size() - 1;
  while (last > 0 && !std::isfinite(times[last])) --last;
  if (!(times[0] >= 0.0 && times[last] > times[0] && times[last] <= 1.0)) {
    return false;
  }
  const double step = MedianStep(times);
  const bool is_late = times[0] > kLateSteps * step;
  return step * kHighestLoggerRate < 1.0 ||
         (is_late && step < kLargestStepOfLate * (1.0 - kRounding));
}

// Why numbers without a unit are not read as seconds; empty: they are.
std::string WhyNoSeconds(const Eigen::Ref<const Vector>& times,
                         const std::string& name) {
  if (MayBePartsOfADay(times)) {
    return "column '" + name +
           "' may be parts of a day (as in spreadsheets) or seconds; set "
           "`time_unit` to \"day\" or \"s\", or give `sampling_rate_hz`";
  }
  Eigen::Index row = 0;
  if (!ArePackedClocks(times, &row)) return "";
  const char* format = times[row] < 1e4   ? "%M%S"
                       : times[row] < 1e6 ? "%H%M%S"
                                          : "%Y%m%d%H%M%S";
  return "column '" + name + "' has minutes and seconds in one number: " +
         FormatNumber(times[row - 1], 15) + " is followed by " +
         FormatNumber(times[row], 15) + ". Set `time_format`, such as \"" +
         format +
         "\", or give `sampling_rate_hz`; set `time_unit` to \"s\" if they "
         "are seconds";
}

// Returns the next word of letters, with its end in *at; empty: there is none.
std::string NextWord(std::string_view line, size_t* at) {
  const auto is_letter = [&line](size_t i) {
    return std::isalpha(static_cast<unsigned char>(line[i])) != 0 ||
           static_cast<unsigned char>(line[i]) >= 0x80;
  };
  while (*at < line.size() && !is_letter(*at)) {
    if (std::isdigit(static_cast<unsigned char>(line[*at])) != 0) return "";
    ++*at;
  }
  const size_t begin = *at;
  while (*at < line.size() && is_letter(*at)) ++*at;
  return LowerCase(line.substr(begin, *at - begin));
}

// True if a unit of the time ends at `end`: in brackets, behind "in" or "unit",
// or as the last word. Others are words beside: "(ms resolution)".
bool IsWholeUnit(std::string_view line, size_t begin, size_t end,
                 bool is_behind_in) {
  const std::string_view before = StripBlanks(line.substr(0, begin));
  const std::string_view after = StripBlanks(line.substr(end));
  if (after.empty()) return true;
  // "in US units" is no time.
  if (is_behind_in) return line.substr(begin, 2) != "US";
  return !before.empty() && ((before.back() == '[' && after.front() == ']') ||
                             (before.back() == '(' && after.front() == ')'));
}

// Returns "ms" for "time in ms" and the like; empty for other lines.
std::string SmallUnitOfTime(std::string_view line) {
  size_t at = 0;
  bool is_time = false;
  bool is_behind_in = false;
  while (at < line.size()) {
    const std::string word = NextWord(line, &at);
    if (word.empty()) {
      // A number.
      is_time = false;
      at = std::min(line.find_first_not_of("0123456789", at), line.size());
      continue;
    }
    const std::string unit = CanonicalUnit(word);
    if (is_time && (unit == "ms" || unit == "us" || unit == "ns") &&
        IsWholeUnit(line, at - word.size(), at, is_behind_in)) {
      // "Sampling time [ms]: 10" is a step.
      return line.find_first_of("0123456789", at) == std::string_view::npos
                 ? unit
                 : "";
    }
    is_behind_in =
        word == "in" || word == "unit" || word == "units" || word == "einheit";
    is_time = IsNameOfTime(word) || (is_time && is_behind_in);
  }
  return "";
}

// Returns the seconds of a unit, or 0 if it is none of a time.
double SecondsOf(const std::string& unit) {
  double factor = 0.0;
  std::string error;
  return UnitFactor(unit, Dimension::kTime, UnitSystem(), &factor, &error)
             ? factor
             : 0.0;
}

// Why a part of a clock, whose unit is `part`, is not taken for the time.
std::string WhyNoTime(const std::string& name, const std::string& part) {
  return "column '" + name +
         "' is a part of a clock by its name, and the other parts down "
         "to hour, minute and second are not all there. " +
         (part == "h" || part == "min" || part == "day"
              ? "Set `time_unit = \"" + part +
                    "\"` if it is the whole time, or give `sampling_rate_hz`"
              : "Set `time` to a column of the whole time, or give "
                "`sampling_rate_hz`");
}

// Ranges of counters in seconds and in their own counts.
std::vector<double> CounterRanges(double second) {
  std::vector<double> ranges;
  for (int power = 8; power <= 48; ++power) {
    ranges.push_back(std::ldexp(1.0, power));
  }
  for (int power = 2; power <= 12; ++power) {
    ranges.push_back(std::pow(10.0, power));
  }
  for (const double seconds : {60.0, 3600.0, kSecondsOfOneDay}) {
    ranges.push_back(seconds / second);
  }
  return ranges;
}

}  // namespace

bool IsNameOfTime(const std::string& name) {
  std::string lower = LowerCase(name);
  for (const char* drop : {"_s", "_ms", "_us", "_ns", "_sec"}) {
    const std::string end = drop;
    if (lower.size() > end.size() &&
        lower.compare(lower.size() - end.size(), end.size(), end) == 0) {
      lower.resize(lower.size() - end.size());
    }
  }
  ReplaceAll("_", " ", &lower);
  for (const char* known :
       {"t", "time", "times", "zeit", "timestamp", "time stamp", "zeitstempel",
        "datetime", "date time", "date/time", "datum/zeit", "uhrzeit", "temps",
        "tiempo", "tempo", "elapsed", "elapsed time", "rel. time",
        "relative time", "x value", "ms", "us", "msec", "usec", "sec",
        "seconds", "milliseconds", "millis", "micros",
        // Other languages. The case of their letters stays as it is.
        "czas", "tid", "tijd", "aika", "zaman", "čas", "Čas", "idő", "Idő",
        "Время", "время", "ВРЕМЯ", "Час", "час", "Χρόνος", "χρόνος", "时间",
        "時間", "時刻", "日時", "시간", "경과시간", "経過時間"}) {
    if (lower == known) return true;
  }
  return false;
}

bool HasWordOfTime(const std::string& name) {
  size_t at = 0;
  while (at < name.size()) {
    const std::string word = NextWord(name, &at);
    for (const char* known :
         {"time", "timestamp", "elapsed", "seconds", "zeit", "zeitstempel"}) {
      if (word == known) return true;
    }
    // NextWord() stops at a number.
    if (word.empty()) ++at;
  }
  return false;
}

std::string UnitOfTimeName(const std::string& name) {
  std::string unit = CanonicalUnit(name);
  const size_t at = name.rfind('_');
  if (unit.empty() && at != std::string::npos) {
    unit = CanonicalUnit(name.substr(at + 1));
  }
  // One letter may be any name.
  if (unit == "s" && at == std::string::npos && name.size() < 2) return "";
  if (unit == "h" || unit == "min" || unit == "day") return "";
  return SecondsOf(unit) > 0.0 ? unit : "";
}

void UnwrapCounter(const std::vector<double>& ranges, Eigen::Ref<Vector> times,
                   double* range) {
  *range = 0.0;
  std::vector<Eigen::Index> starts;
  double highest = times[0];
  for (Eigen::Index i = 1; i < times.size(); ++i) {
    if (std::isnan(times[i])) return;
    highest = std::max(highest, times[i]);
    if (times[i] < times[i - 1]) starts.push_back(i);
  }
  if (starts.empty()) return;
  const double step = MedianStep(times);
  if (step <= 0.0) return;
  for (const double candidate : ranges) {
    if (candidate <= highest) continue;
    const bool fits =
        std::all_of(starts.begin(), starts.end(), [&](Eigen::Index i) {
          const double over = times[i] + candidate - times[i - 1];
          return std::abs(over - step) < 0.5 * step;
        });
    if (!fits) continue;
    // Two ranges that fit leave it open.
    if (*range != 0.0 && std::abs(*range - candidate) > 1e-9 * candidate) {
      *range = 0.0;
      return;
    }
    *range = candidate;
  }
  if (*range == 0.0) return;
  double added = 0.0;
  size_t next = 0;
  for (Eigen::Index i = 0; i < times.size(); ++i) {
    if (next < starts.size() && starts[next] == i) {
      added += *range;
      ++next;
    }
    times[i] += added;
  }
}

double SecondsOfTicks(double first) {
  if (first >= kEpochSeconds[0] && first <= kEpochSeconds[1]) return 1.0;
  for (const Ticks& ticks : kTicks) {
    if (first >= ticks.lowest && first <= ticks.highest) return ticks.seconds;
  }
  return 0.0;
}

std::string UnitOfTimeAbove(std::string_view preamble,
                            const std::vector<int64_t>& names, int64_t* line) {
  *line = 0;
  for (const std::string_view text : Split(preamble, '\n')) {
    ++*line;
    if (std::find(names.begin(), names.end(), *line) != names.end()) continue;
    const std::string unit = SmallUnitOfTime(text);
    if (!unit.empty()) return unit;
  }
  return "";
}

bool ReadTimeNumbers(const TextFormat& format, const std::string& file_unit,
                     int column, double first, Table* table, std::string* said,
                     std::string* error) {
  auto times = table->values.col(column);
  const std::string& name = table->columns[static_cast<size_t>(column)];
  const auto say = [said](const std::string& text) {
    *said += (said->empty() ? "" : ", ") + text;
  };
  std::string unit = format.time_unit;
  if (unit.empty()) unit = file_unit;
  if (unit.empty()) unit = UnitOfTimeName(name);
  if (!unit.empty() && SecondsOf(unit) == 0.0) {
    *error = "column '" + name + "' is named like the time, but its unit is " +
             unit + "; set `time` to the column of the time, or `time_unit`";
    return false;
  }
  if (!format.time_unit.empty() && !file_unit.empty() &&
      std::abs(SecondsOf(file_unit) - SecondsOf(format.time_unit)) > 0.0) {
    say("time in " + format.time_unit +
        " as in the case, although the file says " + file_unit);
  }
  if (unit.empty() && times.size() > 1) {
    for (const Ticks& ticks : kTicks) {
      const double begin = first != 0.0 ? first : times[0];
      // A missing first time is none of these.
      if (!(begin >= ticks.lowest && begin <= ticks.highest)) continue;
      times = (ticks.seconds * (times.array() - times[0])).matrix().eval();
      table->time_origin.kind = TimeOrigin::Kind::kDate;
      table->time_origin.seconds = ticks.zero + begin * ticks.seconds;
      table->time_unit = "s";
      say("time '" + name + "' in " + ticks.name + "; 0 s is " +
          ClockText(table->time_origin.seconds, true));
      return true;
    }
    for (const auto& days : kDays) {
      if (!(times[0] >= days[0] && times[0] <= days[1]) ||
          MedianStep(times) > kLargestStepOfDays) {
        continue;
      }
      *error = "column '" + name +
               "' may be days (as in spreadsheets) or seconds; set `time_unit` "
               "to \"day\" or \"s\", or name the column '" +
               name + " [s]', or give `sampling_rate_hz`";
      return false;
    }
  }
  if (unit.empty() && times.size() > 1) {
    *error = WhyNoSeconds(times, name);
    if (!error->empty()) return false;
  }
  const std::string part = UnitOfClockPart(name);
  if (unit.empty() && !part.empty() && part != "s" && !AreEpochSeconds(times)) {
    *error = WhyNoTime(name, part);
    return false;
  }
  if (unit.empty() && times.size() > 1 &&
      MedianStep(times) > kLongestStepOfSeconds) {
    if (!AreEpochSeconds(times)) {
      *error = "column '" + name + "' states no unit, and its step of " +
               FormatNumber(MedianStep(times), 4) +
               " may be seconds or milliseconds. Set `time_unit` to \"s\" or "
               "\"ms\", or name the column '" +
               name + " [ms]', or give `sampling_rate_hz`";
      return false;
    }
    say("time '" + name + "' read as seconds since 1970");
  }
  const bool is_stated = !unit.empty();
  if (!is_stated) unit = "s";
  table->time_unit = unit;
  if (is_stated && unit != "s" && format.time_unit.empty()) {
    say("time '" + name + "' in " + unit);
  }
  double range = 0.0;
  UnwrapCounter(CounterRanges(SecondsOf(unit)), times, &range);
  if (range > 0.0) {
    say("time '" + name + "' starts anew at " + FormatNumber(range, 15) + " " +
        unit + " and is continued");
  }
  return true;
}

}  // namespace pinode
