#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/base/text_encoding.h"
#include "pinode/base/unit_names.h"
#include "pinode/base/units.h"
#include "pinode/record/files/clock_parts.h"
#include "pinode/record/files/text_clock.h"
#include "pinode/record/files/text_rows.h"
#include "pinode/record/files/text_table.h"
#include "pinode/record/files/text_time.h"
#include "pinode/record/number_rows.h"

namespace pinode {
namespace {

// Bytes at the beginning of a file that its outline is found from.
constexpr size_t kOutlineBytes = size_t{1} << 19;
// Counts of clocks since 1970 are larger.
constexpr double kLeastTicks = 9e11;

// Numbers of the first rows, NaN for other cells.
Matrix FirstRows(const std::string& text, const TextLayout& layout) {
  constexpr Eigen::Index kMostRows = 200;
  const Eigen::Index num_columns =
      static_cast<Eigen::Index>(layout.columns.size());
  Matrix values = Matrix::Constant(kMostRows, num_columns,
                                   std::numeric_limits<double>::quiet_NaN());
  Eigen::Index row = 0;
  std::vector<std::string_view> cells;
  std::vector<std::string> storage;
  size_t at = layout.first_row;
  while (at < text.size() && row < kMostRows) {
    const size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line(text.data() + at, end - at);
    at = end + 1;
    if (IsNoRow(line) ||
        !SplitCells(line, layout.delimiter, &cells, &storage)) {
      continue;
    }
    for (Eigen::Index j = 0; j < num_columns; ++j) {
      const size_t cell = static_cast<size_t>(j);
      double value = 0.0;
      if (cell < cells.size() &&
          ParseCell(cells[cell], layout.decimal, &value)) {
        values(row, j) = value;
      }
    }
    ++row;
  }
  return values.topRows(row);
}

// True for values that rise by about the same step, as rounded times do.
bool RiseEvenly(const Eigen::Ref<const Vector>& values, double* step) {
  constexpr double kLargestDeviation = 0.5;  // in steps
  // A slower clock ends before the others of its file.
  Eigen::Index size = values.size();
  while (size > 0 && std::isnan(values[size - 1])) --size;
  if (size < 3) return false;
  *step = (values[size - 1] - values[0]) / static_cast<double>(size - 1);
  for (Eigen::Index i = 1; i < size; ++i) {
    const double own = values[i] - values[i - 1];
    if (!(*step > 0.0) ||
        !(std::abs(own - *step) <= kLargestDeviation * *step)) {
      return false;
    }
  }
  return true;
}

// Name of a time without the number that tells it from others: "t" of "t2",
// "time" of "Time[2]". Empty: the name is none of a time.
std::string BaseOfTime(const TextColumn& column) {
  std::string name = LowerCase(column.short_name);
  const size_t bracket = name.rfind('[');
  if (!name.empty() && name.back() == ']' && bracket != std::string::npos) {
    name.resize(bracket);
  }
  std::string unused;
  std::string plain;
  SplitUnitOfName(name, &plain, &unused);
  const size_t end = plain.find_last_not_of("0123456789");
  if (end == std::string::npos) return "";
  plain.resize(end + 1);
  plain.resize(plain.find_last_not_of(" _-.#") + 1);
  return IsNameOfTime(plain) ? plain : "";
}

// True if "Час" is the hour, as in Russian, beside minutes or seconds. In
// Ukrainian it is the time.
bool IsHour(const std::string& name, const std::vector<TextColumn>& columns) {
  if (name != "Час" && name != "час") return false;
  return std::any_of(columns.begin(), columns.end(),
                     [](const TextColumn& column) {
                       const std::string& other = column.short_name;
                       return other == "Мин" || other == "мин" ||
                              other == "Сек" || other == "сек";
                     });
}

// True if two columns have other cells in one of the first rows.
bool Differ(const std::string& text, const TextLayout& layout, int first,
            int second) {
  constexpr int kMostRows = 200;
  std::vector<std::string_view> cells;
  std::vector<std::string> storage;
  size_t at = layout.first_row;
  for (int row = 0; row < kMostRows && at < text.size(); ++row) {
    const size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line(text.data() + at, end - at);
    at = end + 1;
    if (IsNoRow(line) ||
        !SplitCells(line, layout.delimiter, &cells, &storage) ||
        cells.size() <= static_cast<size_t>(std::max(first, second))) {
      continue;
    }
    const std::string_view a = cells[static_cast<size_t>(first)];
    const std::string_view b = cells[static_cast<size_t>(second)];
    if (a != b && !IsMissing(a) && !IsMissing(b)) return true;
  }
  return false;
}

// Returns the number of seconds that a column of times counts in; 0: its unit
// is not stated.
double SecondsOf(const TextColumn& column) {
  std::string unit = column.unit;
  if (unit.empty()) unit = UnitOfTimeName(column.short_name);
  double factor = 0.0;
  std::string unused;
  return !unit.empty() && UnitFactor(unit, Dimension::kTime, UnitSystem(),
                                     &factor, &unused)
             ? factor
             : 0.0;
}

// True if no unit is stated that a time does not have: "Real-time disp [mm]".
bool MayBeTime(const TextColumn& column) {
  return column.unit.empty() || SecondsOf(column) > 0.0;
}

// True if two columns of numbers are other times. Counts since 1970 and elapsed
// times may be one clock, so they are not compared.
bool AreOtherTimes(Vector first, double first_seconds, Vector second,
                   double second_seconds) {
  Eigen::Index size = first.size();
  while (size > 0 && std::isnan(first[size - 1] + second[size - 1])) --size;
  if (size < 2) return true;
  first.conservativeResize(size);
  second.conservativeResize(size);
  // Share of a step that roundings may differ by.
  constexpr double kOneClock = 0.02;
  if ((first[0] > kLeastTicks) != (second[0] > kLeastTicks)) return false;
  const double steps = static_cast<double>(first.size() - 1);
  const auto differ = [&](double factor, double other_factor) {
    const Vector one = first * factor;
    const Vector difference = one - second * other_factor;
    const double step = (one[one.size() - 1] - one[0]) / steps;
    // Ticks since 1970 have 16 digits.
    return !(difference.cwiseAbs().maxCoeff() <=
             kOneClock * step + 1e-15 * one.cwiseAbs().maxCoeff());
  };
  const auto or_second = [](double seconds) {
    return seconds > 0.0 ? seconds : 1.0;
  };
  const bool one_is_stated = (first_seconds > 0.0) != (second_seconds > 0.0);
  return differ(or_second(first_seconds), or_second(second_seconds)) &&
         !(one_is_stated && !differ(1.0, 1.0));
}

// Finds other clocks beside the time of an outline: columns of the same name
// but for a number and the unit, with other times. Clock times and numbers side
// by side are taken for one clock.
void FindOtherClocks(const std::string& text, const TextLayout& layout,
                     const Matrix& rows, TextOutline* outline) {
  const int time = outline->time_column;
  const TextColumn& own = outline->columns[static_cast<size_t>(time)];
  const std::string base = BaseOfTime(own);
  if (base.empty()) return;
  for (size_t i = 0; i < outline->columns.size(); ++i) {
    const TextColumn& column = outline->columns[i];
    const int place = static_cast<int>(i);
    const bool is_number = column.kind == CellKind::kNumber;
    double step = 0.0;
    // Temperatures may be called T1 and T2.
    const bool is_clock = is_number ? RiseEvenly(rows.col(place), &step)
                                    : column.kind == own.kind;
    if (place == time || !is_clock || BaseOfTime(column) != base) continue;
    outline->is_channel[i] = false;
    if (column.kind == own.kind &&
        (is_number ? AreOtherTimes(rows.col(time), SecondsOf(own),
                                   rows.col(place), SecondsOf(column))
                   : Differ(text, layout, time, place))) {
      outline->other_clocks.push_back(place);
    }
  }
}

// Seconds of a row by one clock: since midnight, or since another zero.
class RowClock {
 public:
  RowClock(const TextLayout& layout, const TextFormat& format, int column)
      : layout_(layout), column_(column), clock_(layout, format, column) {}

  // True if the zero of the seconds is a midnight.
  bool IsOfDay() const { return clock_.parts().IsClock() || ticks_ > 0.0; }

  bool Parse(const std::vector<std::string_view>& cells, double* seconds) {
    if (clock_.parts().IsClock()) {
      std::string unused;
      if (cells.size() <= static_cast<size_t>(clock_.parts().Last()) ||
          !clock_.Add(cells, layout_.decimal, &unused)) {
        return false;
      }
      *seconds = clock_.cells().back().seconds;
      return true;
    }
    const size_t place = static_cast<size_t>(column_);
    if (cells.size() <= place ||
        !ParseCell(cells[place], layout_.decimal, seconds)) {
      return false;
    }
    const double stated = SecondsOf(layout_.columns[place]);
    if (stated == 0.0 && ticks_ == 0.0) ticks_ = SecondsOfTicks(*seconds);
    *seconds *= stated > 0.0 ? stated : ticks_ > 0.0 ? ticks_ : 1.0;
    return true;
  }

 private:
  const TextLayout& layout_;
  const int column_;
  TextClock clock_;
  double ticks_ = 0.0;
};

// True if the parts of a clock say the same as the time, but for parts of a
// second and the zone. Beside a time that does not begin at midnight they count
// as it does.
bool AreOneClock(const std::string& text, const TextLayout& layout,
                 const TextFormat& format, int time, const ClockParts& parts) {
  constexpr int kMostRows = 5000;
  constexpr double kDay = 86400.0;
  constexpr double kZone = 900.0;         // s; zones are multiples of it
  constexpr double kRounding = 1.0;       // s
  constexpr double kLeastDuration = 2.0;  // s
  RowClock own(layout, format, time);
  RowClock beside(layout, TextFormat(), parts.second);
  std::vector<std::string_view> cells;
  std::vector<std::string> storage;
  double lowest = 0.0;
  double highest = 0.0;
  double first = 0.0;
  double first_beside = 0.0;
  double duration = 0.0;
  size_t at = layout.first_row;
  int rows = 0;
  while (at < text.size() && rows < kMostRows) {
    const size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line(text.data() + at, end - at);
    at = end + 1;
    double seconds = 0.0;
    double other = 0.0;
    if (IsNoRow(line)) continue;
    if (!SplitCells(line, layout.delimiter, &cells, &storage) ||
        !own.Parse(cells, &seconds) || !beside.Parse(cells, &other)) {
      return false;
    }
    if (rows++ == 0) {
      first = seconds - other;
      first_beside = other;
      if (own.IsOfDay()) first = kZone * std::round(first / kZone);
    }
    const double difference = std::remainder(seconds - other - first, kDay);
    lowest = std::min(lowest, difference);
    highest = std::max(highest, difference);
    duration = std::remainder(other - first_beside, kDay);
  }
  return rows > 0 && highest - lowest <= kRounding &&
         (own.IsOfDay() ? std::max(highest, -lowest) <= kRounding
                        : duration >= kLeastDuration);
}

// Finds hour, minute and second beside a time that is another column.
void FindRepeatedParts(const std::string& text, const TextLayout& layout,
                       const TextFormat& format, TextOutline* outline) {
  const ClockParts parts = FindClockParts(layout.columns);
  if (!parts.IsComplete() || parts.Has(outline->time_column) ||
      parts.fraction == outline->time_column ||
      !AreOneClock(text, layout, format, outline->time_column, parts)) {
    return;
  }
  outline->repeated_parts = parts.Columns();
  if (parts.fraction >= 0) outline->repeated_parts.push_back(parts.fraction);
  for (const int part : outline->repeated_parts) {
    outline->is_channel[static_cast<size_t>(part)] = false;
  }
}

// True for a part of a clock other than the seconds: a year, a day, an hour.
// *seconds becomes the place of the first column of seconds.
bool IsPartOfClock(const TextColumn& column, int place, int* seconds) {
  const std::string part = UnitOfClockPart(column.short_name);
  if (part == "s" && *seconds < 0) *seconds = place;
  return !part.empty() && part != "s";
}

TextOutline OutlineOf(const std::string& text, const TextLayout& layout,
                      const TextFormat& format) {
  TextOutline outline;
  outline.columns = layout.columns;
  const Matrix rows = FirstRows(text, layout);
  int clock = -1;
  int named = -1;
  int text_time = -1;
  int seconds = -1;
  bool has_clock_parts = false;
  ClockParts split;
  if (format.time_unit.empty() && format.time_format.empty()) {
    split = FindClockParts(layout.columns);
  }
  // First column behind row numbers.
  int first = 0;
  for (size_t i = 0; i < layout.columns.size(); ++i) {
    const TextColumn& column = layout.columns[i];
    const int place = static_cast<int>(i);
    const bool is_number = column.kind == CellKind::kNumber;
    bool is_channel = is_number;
    double step = 0.0;
    const bool may_be_time = MayBeTime(column);
    // Row numbers may be "Sample [1]".
    if (is_number && (may_be_time || column.unit == "1") &&
        RiseEvenly(rows.col(place), &step)) {
      const bool whole = std::floor(rows(1, place)) == rows(1, place) &&
                         std::floor(rows(0, place)) == rows(0, place);
      // Ticks since 1970 are told by their size.
      const bool are_ticks = rows(0, place) > kLeastTicks;
      // Row numbers, and an unknown first column that rises evenly.
      if (whole && step == 1.0) {
        is_channel = false;
        const bool is_time =
            are_ticks || (IsNameOfTime(column.short_name) &&
                          !IsHour(column.short_name, layout.columns));
        if (place == first && !is_time) ++first;
      }
      if ((place == first && may_be_time) || are_ticks) {
        is_channel = false;
        const bool is_known = !whole || are_ticks;
        if (is_known && named < 0) named = place;
      }
    }
    if (column.kind == CellKind::kDateTime ||
        column.kind == CellKind::kTimeOfDay) {
      if (clock < 0) clock = place;
    }
    if (is_number && IsNameOfTime(column.short_name)) {
      is_channel = false;
      const bool is_part = split.Has(place) || split.fraction == place;
      if (named < 0 && !is_part && !IsHour(column.short_name, layout.columns)) {
        named = place;
      }
    }
    // Another form of the time, such as "seconds_elapsed" beside ticks.
    if (is_number && is_channel && HasWordOfTime(column.short_name) &&
        may_be_time && RiseEvenly(rows.col(place), &step)) {
      is_channel = false;
      if (named < 0) named = place;
    }
    if (is_number && IsPartOfClock(column, place, &seconds)) {
      is_channel = false;
      has_clock_parts = true;
    }
    // Clock times of an unusual form need a key, which reading them names.
    if (column.kind == CellKind::kText && text_time < 0 &&
        IsNameOfTime(column.short_name)) {
      text_time = place;
    }
    outline.is_channel.push_back(is_channel);
  }
  if (split.IsComplete() && named < 0) named = split.second;
  // "Second" may be any name unless minutes or days stand beside it.
  if (has_clock_parts && seconds >= 0) {
    outline.is_channel[static_cast<size_t>(seconds)] = false;
    if (named < 0) named = seconds;
  }
  outline.time_column = clock >= 0 ? clock : named >= 0 ? named : text_time;
  if (outline.time_column < 0) return outline;
  const TimeParts parts = FindTimeParts(layout, format, outline.time_column);
  // Short names such as "min" are those of channels beside another time.
  outline.is_channel[static_cast<size_t>(outline.time_column)] = false;
  outline.time_parts = parts.Columns();
  for (const int part : outline.time_parts) {
    outline.is_channel[static_cast<size_t>(part)] = false;
  }
  FindOtherClocks(text, layout, rows, &outline);
  FindRepeatedParts(text, layout, format, &outline);
  return outline;
}

}  // namespace

std::vector<std::string> TextOutline::UnusedTimes(
    const std::string& time) const {
  const auto is_time = [&](size_t i) {
    return columns[i].name == time || columns[i].short_name == time;
  };
  const bool are_parts_used =
      std::any_of(time_parts.begin(), time_parts.end(),
                  [&](int part) { return is_time(static_cast<size_t>(part)); });
  std::vector<std::string> names;
  for (size_t i = 0; i < columns.size(); ++i) {
    if (is_channel[i] || is_time(i)) continue;
    const auto has = [i](const std::vector<int>& places) {
      return std::find(places.begin(), places.end(), static_cast<int>(i)) !=
             places.end();
    };
    const bool is_part = has(time_parts);
    const std::string& name = columns[i].short_name;
    const bool is_number = columns[i].kind == CellKind::kNumber;
    const bool is_named =
        IsNameOfTime(name) ||
        (is_number && HasWordOfTime(name) && MayBeTime(columns[i])) ||
        !UnitOfClockPart(name).empty() || has(repeated_parts);
    if (is_part ? !are_parts_used : is_named) names.push_back(columns[i].name);
  }
  return names;
}

bool ReadTextOutline(const std::string& path, const TextFormat& format,
                     TextOutline* outline, std::string* error) {
  std::string text;
  return ReadTextOfAnyEncoding(path, &text, error) &&
         ParseTextOutline(std::move(text), path, format, outline, error);
}

bool ParseTextOutline(std::string text, const std::string& path,
                      const TextFormat& format, TextOutline* outline,
                      std::string* error) {
  // The end of a line, in any encoding.
  if (text.size() > kOutlineBytes) {
    const size_t end = text.find('\n', kOutlineBytes);
    if (end != std::string::npos && end + 2 < text.size()) {
      text.resize(end + (text[end + 1] == '\0' ? 2 : 1));
    }
  }
  TextEncoding encoding;
  std::string what;
  if (!ConvertToUtf8(format.encoding, &text, &encoding, &what)) {
    *error = path + ": " + what;
    return false;
  }
  NormaliseLines(&text);
  TextLayout layout;
  if (!FindTextLayout(text, path, format, &layout, error) ||
      !layout.IsClear(path, error)) {
    return false;
  }
  *outline = OutlineOf(text, layout, format);
  return true;
}

}  // namespace pinode
