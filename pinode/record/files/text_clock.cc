#include "pinode/record/files/text_clock.h"

#include <algorithm>
#include <cmath>

#include "pinode/base/file_text.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/record/files/text_time.h"

namespace pinode {
namespace {

constexpr double kMidnight = 86400.0;  // s
constexpr double kLeapSecond = 1.0;    // s
// Hours that count to 12 end before.
constexpr double kAfterNoon = 13.0 * 3600.0;

// True for "AM/PM" and "am_pm", wherever such a column stands.
bool IsNameOfHalf(const std::string& name) {
  std::string letters;
  for (const char c : LowerCase(name)) {
    if (c != ' ' && c != '/' && c != '_') letters += c;
  }
  return letters == "ampm" || letters == "meridiem";
}

// Finds the date of a column of times of day, or the other way round: beside
// it, else the only one of the file if its name is that of one.
int FindPartner(const TextLayout& layout, int column, CellKind kind,
                bool next_first) {
  const int step = next_first ? 1 : -1;
  const int count = static_cast<int>(layout.columns.size());
  for (const int i : {column + step, column - step}) {
    if (i >= 0 && i < count &&
        layout.columns[static_cast<size_t>(i)].kind == kind) {
      return i;
    }
  }
  const CellKind own = layout.columns[static_cast<size_t>(column)].kind;
  int found = -1;
  int owns = 0;
  for (int i = 0; i < count; ++i) {
    const TextColumn& other = layout.columns[static_cast<size_t>(i)];
    if (other.kind == own) ++owns;
    if (other.kind != kind) continue;
    const bool is_named = IsNameOfTime(other.short_name) ||
                          UnitOfClockPart(other.short_name) == "date";
    if (found >= 0 || !is_named) return -1;
    found = i;
  }
  return owns == 1 ? found : -1;
}

bool MostRepeat(const std::vector<double>& seconds) {
  size_t repeated = 0;
  for (size_t i = 1; i < seconds.size(); ++i) {
    if (seconds[i] == seconds[i - 1]) ++repeated;
  }
  return 2 * repeated + 1 > seconds.size();
}

}  // namespace

int TimeParts::Last() const {
  return std::max({date, time, fraction, split.Last()});
}

std::vector<int> TimeParts::Columns() const {
  std::vector<int> columns = split.Columns();
  for (const int column : {date, time, fraction, split.fraction}) {
    if (column >= 0) columns.push_back(column);
  }
  return columns;
}

TimeParts FindTimeParts(const TextLayout& layout, const TextFormat& format,
                        int column) {
  TimeParts parts;
  const auto kind = [&layout](int i) {
    return i < 0 || i >= static_cast<int>(layout.columns.size())
               ? CellKind::kText
               : layout.columns[static_cast<size_t>(i)].kind;
  };
  // The columns that are a clock together, if this is one of them.
  const auto find_split = [&] {
    if (!format.time_format.empty() || !format.time_unit.empty()) return false;
    const ClockParts split = FindClockParts(layout.columns);
    if (!split.Has(column)) return false;
    parts.split = split;
    return true;
  };
  switch (kind(column)) {
    case CellKind::kDateTime:
      parts.date = column;
      return parts;
    case CellKind::kDate:
      parts.time = FindPartner(layout, column, CellKind::kTimeOfDay, true);
      if (parts.time < 0 && find_split()) return parts;
      parts.date = column;
      break;
    case CellKind::kTimeOfDay:
      parts.time = column;
      parts.date = FindPartner(layout, column, CellKind::kDate, false);
      break;
    default:
      if (!format.time_format.empty()) {
        parts.date = column;
      } else {
        find_split();
      }
      return parts;
  }
  const int next = parts.time + 1;
  if (parts.time < 0 || kind(next) != CellKind::kNumber) return parts;
  // A user who says what the time is has it without the column beside it.
  if (!format.time_unit.empty() ||
      format.time_format.find("%f") != std::string::npos) {
    return parts;
  }
  const double seconds =
      FractionOfColumn(layout.columns[static_cast<size_t>(next)]);
  if (seconds > 0.0) {
    parts.fraction = next;
    parts.fraction_in_seconds = seconds;
  }
  return parts;
}

TextClock::TextClock(const TextLayout& layout, const TextFormat& format,
                     int column)
    : layout_(layout),
      format_(format),
      column_(column),
      parts_(FindTimeParts(layout, format, column)) {}

const std::string& TextClock::NameOf(int column) const {
  return layout_.columns[static_cast<size_t>(column)].name;
}

void TextClock::Clear(size_t num_rows) {
  clock_.clear();
  if (parts_.IsClock()) clock_.reserve(num_rows);
}

bool TextClock::Parse(const std::vector<std::string_view>& cells, char decimal,
                      ClockCell* cell, std::string* what) const {
  const auto text = [&cells](int i) { return cells[static_cast<size_t>(i)]; };
  if (!format_.time_format.empty()) {
    const int first = parts_.date >= 0 ? parts_.date : parts_.time;
    std::string whole(text(first));
    if (parts_.date >= 0 && parts_.time >= 0) {
      whole += " " + std::string(text(parts_.time));
    }
    if (!ParseClockBy(format_.time_format, whole, cell)) return false;
  } else if (parts_.date >= 0) {
    if (!ParseClock(text(parts_.date), cell)) return false;
    if (parts_.time >= 0) {
      ClockCell time;
      if (!ParseClock(text(parts_.time), &time) || time.has_date) return false;
      cell->has_time = true;
      cell->seconds = time.seconds;
      cell->has_zone = time.has_zone;
      cell->zone = time.zone;
    }
  } else if (!ParseClock(text(parts_.time), cell)) {
    return false;
  }
  if (parts_.fraction < 0) return true;
  const std::string& beside = NameOf(parts_.fraction);
  double fraction = 0.0;
  if (!ParseCell(text(parts_.fraction), decimal, &fraction) ||
      !(fraction * parts_.fraction_in_seconds < 1.0) || !(fraction >= 0.0)) {
    *what = Quote(text(parts_.fraction)) + " of '" + beside +
            "' beside it is no fraction of a second; if that counts on, it is "
            "the time by `time = \"" +
            beside + "\"`. Or give `sampling_rate_hz`";
    return false;
  }
  if (cell->seconds != std::floor(cell->seconds)) {
    *what = Quote(text(parts_.time)) + " has a fraction and so has '" + beside +
            "' beside it; give `sampling_rate_hz`, or `time_format` with %f, "
            "which reads '" +
            NameOf(column_) + "' alone";
    return false;
  }
  cell->seconds += fraction * parts_.fraction_in_seconds;
  return true;
}

bool TextClock::HasHalfBeside(const std::vector<std::string_view>& cells,
                              char decimal) {
  std::vector<std::string_view> beside;
  for (const int part : parts_.Columns()) {
    for (const int i : {part - 1, part + 1}) {
      if (i >= 0 && static_cast<size_t>(i) < cells.size()) {
        beside.push_back(cells[static_cast<size_t>(i)]);
      }
    }
  }
  for (size_t i = 0; i < layout_.columns.size() && i < cells.size(); ++i) {
    if (IsNameOfHalf(layout_.columns[i].short_name)) beside.push_back(cells[i]);
  }
  std::string unused;
  if (!HasHalfOfDay(beside) ||
      cells.size() <= static_cast<size_t>(parts_.Last()) ||
      !Add(cells, decimal, &unused)) {
    return false;
  }
  const double seconds = clock_.back().seconds;
  clock_.pop_back();
  return seconds < kAfterNoon;
}

bool TextClock::Add(const std::vector<std::string_view>& cells, char decimal,
                    std::string* error) {
  CHECK(cells.size() > static_cast<size_t>(parts_.Last()));
  clock_.emplace_back();
  if (parts_.split.IsComplete()) {
    int bad = column_;
    std::string what;
    if (ParseClockParts(cells, parts_.split, decimal, &clock_.back(), &bad,
                        &what)) {
      return true;
    }
    *error = "column '" + NameOf(bad) + "': " + what + ". " + NamesOfParts() +
             " are read as one clock by their names. " + RemedyFor(bad) +
             ", or give `sampling_rate_hz`";
  } else {
    std::string what;
    if (Parse(cells, decimal, &clock_.back(), &what)) return true;
    if (what.empty()) {
      what = Quote(cells[static_cast<size_t>(column_)]) +
             " is not a time like the first row; set `time_format`, or give "
             "`sampling_rate_hz`";
    }
    *error = "column '" + NameOf(column_) + "': " + what;
  }
  clock_.pop_back();
  return false;
}

std::string TextClock::RemedyFor(int column) const {
  const ClockParts& parts = parts_.split;
  const double fraction = parts.fraction_in_seconds;
  const std::string unit = column == parts.hour       ? "h"
                           : column == parts.minute   ? "min"
                           : column == parts.second   ? "s"
                           : column != parts.fraction ? ""
                           : fraction == 1e-3         ? "ms"
                           : fraction == 1e-6         ? "us"
                                                      : "ns";
  return unit.empty()
             ? "Set `time` to the column of the whole time and "
               "`time_unit` to its unit"
             : "If that one is the whole time, set `time = \"" +
                   NameOf(column) + "\"` and `time_unit = \"" + unit + "\"`";
}

std::string TextClock::NamesOfParts() const {
  std::vector<std::string> names;
  for (const int column : parts_.split.Columns()) {
    names.push_back("'" + NameOf(column) + "'");
  }
  if (parts_.split.fraction >= 0) {
    names.push_back("'" + NameOf(parts_.split.fraction) + "'");
  }
  return Join(names, ", ");
}

bool TextClock::Finish(Vector* times, TimeOrigin* origin, std::string* said,
                       size_t* row, std::string* error) const {
  ClockColumn column;
  int64_t bad_row = -1;
  std::string what;
  const std::string where = "column '" + NameOf(column_) + "': ";
  if (!ResolveClock(clock_, &column, &bad_row, &what)) {
    *row = static_cast<size_t>(std::max<int64_t>(bad_row, 0));
    *error = where + "the time " + what;
    return false;
  }
  if (MostRepeat(column.seconds)) {
    *row = 0;
    *error = where +
             "most times repeat the one before, so the clock is coarser than "
             "the rows; give `sampling_rate_hz` instead of `time`";
    return false;
  }
  *times = Eigen::Map<const Vector>(
      column.seconds.data(), static_cast<Eigen::Index>(column.seconds.size()));
  double range = 0.0;
  // Times of day start anew at midnight, elapsed times do not.
  const bool is_elapsed =
      std::any_of(clock_.begin(), clock_.end(), [](const ClockCell& cell) {
        return cell.seconds >= kMidnight + kLeapSecond;
      });
  if (!column.is_dated && !is_elapsed) {
    UnwrapCounter({kMidnight}, *times, &range);
  }
  origin->seconds = column.origin;
  origin->kind = !column.is_dated          ? TimeOrigin::Kind::kTimeOfDay
                 : column.is_order_certain ? TimeOrigin::Kind::kDate
                                           : TimeOrigin::Kind::kDoubtfulDate;
  const bool is_split = parts_.split.IsComplete();
  *said = "time " + (is_split ? NamesOfParts() : "'" + NameOf(column_) + "'") +
          ": " +
          (is_split                ? "parts of a clock"
           : column.format.empty() ? "time of day"
                                   : column.format) +
          (parts_.fraction >= 0
               ? ", fraction from '" + NameOf(parts_.fraction) + "'"
               : "") +
          "; 0 s is " + ClockText(column.origin, column.is_dated) +
          (range > 0.0 ? "; the times pass midnight" : "");
  return true;
}

}  // namespace pinode
