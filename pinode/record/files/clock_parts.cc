#include "pinode/record/files/clock_parts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/base/unit_names.h"

namespace pinode {
namespace {

// Years of measurements; two digits are read as in dates.
constexpr int kFirstYear = 1900;
constexpr int kLastYear = 2200;
// Hours without a date may have elapsed since the start.
constexpr int kMostHours = 9999;

enum class Part { kNone, kDate, kYear, kMonth, kDay, kDoy, kHour, kMin, kSec };

struct PartName {
  const char* name;
  Part part;
};

// Names that are those of a part whatever stands beside them.
constexpr PartName kNames[] = {
    {"year", Part::kYear},       {"yr", Part::kYear},
    {"yyyy", Part::kYear},       {"jahr", Part::kYear},
    {"ann\u00E9e", Part::kYear}, {"a\u00F1o", Part::kYear},
    {"month", Part::kMonth},     {"monat", Part::kMonth},
    {"mois", Part::kMonth},      {"mes", Part::kMonth},
    {"date", Part::kDate},       {"datum", Part::kDate},
    {"day", Part::kDay},         {"tag", Part::kDay},
    {"jour", Part::kDay},        {"d\u00EDa", Part::kDay},
    {"doy", Part::kDoy},         {"day of year", Part::kDoy},
    {"dayofyear", Part::kDoy},   {"julian day", Part::kDoy},
    {"jday", Part::kDoy},        {"yday", Part::kDoy},
    {"hour", Part::kHour},       {"hours", Part::kHour},
    {"hr", Part::kHour},         {"stunde", Part::kHour},
    {"heure", Part::kHour},      {"hora", Part::kHour},
    {"minute", Part::kMin},      {"minutes", Part::kMin},
    {"minuto", Part::kMin},      {"second", Part::kSec},
    {"sekunde", Part::kSec},     {"seconde", Part::kSec},
    {"segundo", Part::kSec}};

// Names that mean a part beside all others of a clock alone: "min" may be a
// minimum, and "mm" a displacement. "h", "m" and "s" are not among them,
// because three channels may be called so.
constexpr PartName kShortNames[] = {
    {"dd", Part::kDay},       {"hh", Part::kHour},     {"hrs", Part::kHour},
    {"stunden", Part::kHour}, {"heures", Part::kHour}, {"min", Part::kMin},
    {"mins", Part::kMin},     {"mm", Part::kMin},      {"minuten", Part::kMin},
    {"ss", Part::kSec},       {"sec", Part::kSec},     {"secs", Part::kSec},
    {"seconds", Part::kSec},  {"sek", Part::kSec},     {"sekunden", Part::kSec},
    {"secondes", Part::kSec}, {"segundos", Part::kSec}};

Part PartOf(const std::string& name) {
  std::string lower = LowerCase(name);
  ReplaceAll("_", " ", &lower);
  for (const PartName& known : kNames) {
    if (lower == known.name) return known.part;
  }
  return Part::kNone;
}

Part PartOfShortName(const std::string& name) {
  // Beside mm for minutes.
  if (name == "MM") return Part::kMonth;
  const Part part = PartOf(name);
  if (part != Part::kNone) return part;
  const std::string lower = LowerCase(name);
  for (const PartName& known : kShortNames) {
    if (lower == known.name) return known.part;
  }
  return Part::kNone;
}

std::string UnitOf(Part part) {
  switch (part) {
    case Part::kNone:
      return "";
    case Part::kDate:
      return "date";
    case Part::kYear:
      return "year";
    case Part::kMonth:
      return "month";
    case Part::kDay:
    case Part::kDoy:
      return "day";
    case Part::kHour:
      return "h";
    case Part::kMin:
      return "min";
    case Part::kSec:
      return "s";
  }
  return "";
}

// Returns the place of a part in a clock.
int* PlaceOf(Part part, ClockParts* parts) {
  switch (part) {
    case Part::kNone:
      return nullptr;
    case Part::kDate:
      return &parts->date;
    case Part::kYear:
      return &parts->year;
    case Part::kMonth:
      return &parts->month;
    case Part::kDay:
      return &parts->day;
    case Part::kDoy:
      return &parts->day_of_year;
    case Part::kHour:
      return &parts->hour;
    case Part::kMin:
      return &parts->minute;
    case Part::kSec:
      return &parts->second;
  }
  return nullptr;
}

// Finds the column of fractions behind the seconds.
void FindFraction(const std::vector<TextColumn>& columns, ClockParts* parts) {
  const size_t next = static_cast<size_t>(parts->second) + 1;
  const double seconds =
      next < columns.size() ? FractionOfColumn(columns[next]) : 0.0;
  if (seconds == 0.0) return;
  parts->fraction = static_cast<int>(next);
  parts->fraction_in_seconds = seconds;
}

bool IsDateComplete(const ClockParts& parts) {
  const bool any = parts.year >= 0 || parts.month >= 0 || parts.day >= 0 ||
                   parts.day_of_year >= 0;
  if (parts.date >= 0) return !any;
  const bool by_month = parts.month >= 0 && parts.day >= 0;
  const bool half = (parts.month >= 0) != (parts.day >= 0);
  return !any ||
         (parts.year >= 0 && !half && (by_month || parts.day_of_year >= 0));
}

bool IsLeapYear(int year) {
  return year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
}

// Finds month and day of a day of the year; false beyond its end.
bool FindMonth(int year, int day_of_year, int* month, int* day) {
  const std::array<int, 12> days = {
      31, IsLeapYear(year) ? 29 : 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  *day = day_of_year;
  for (*month = 1; *month <= 12; ++*month) {
    const int length = days[static_cast<size_t>(*month - 1)];
    if (*day <= length) return true;
    *day -= length;
  }
  return false;
}

// Reads the cells of one row.
class PartReader {
 public:
  PartReader(const std::vector<std::string_view>& cells, char decimal, int* bad,
             std::string* error)
      : cells_(cells), decimal_(decimal), bad_(bad), error_(error) {}

  // Parses a whole number of this range.
  bool Whole(int column, int lowest, int highest, int* value) {
    double number = 0.0;
    if (!ParseCell(Cell(column), decimal_, &number) ||
        !(number >= lowest && number <= highest) ||
        number != std::floor(number)) {
      return Fail(column, "a whole number from " + std::to_string(lowest) +
                              " to " + std::to_string(highest));
    }
    *value = static_cast<int>(number);
    return true;
  }

  // Parses a number from 0 to less than `end`.
  bool Number(int column, double end, double* value) {
    return (ParseCell(Cell(column), decimal_, value) && *value >= 0.0 &&
            *value < end) ||
           Fail(column, "a number from 0 to less than " + FormatNumber(end));
  }

  bool Fail(int column, const std::string& expected) {
    *bad_ = column;
    *error_ = Quote(Cell(column)) + ", expected " + expected;
    return false;
  }

  std::string_view Cell(int column) const {
    return cells_[static_cast<size_t>(column)];
  }

 private:
  const std::vector<std::string_view>& cells_;
  const char decimal_;
  int* bad_;
  std::string* error_;
};

bool ParseDate(const ClockParts& parts, PartReader* reader, ClockCell* cell) {
  if (parts.date >= 0) {
    return (ParseClock(reader->Cell(parts.date), cell) && !cell->has_time) ||
           reader->Fail(parts.date, "a date");
  }
  cell->has_date = parts.year >= 0;
  if (!cell->has_date) return true;
  auto& [year, month, day] = cell->date;
  if (!reader->Whole(parts.year, 0, kLastYear, &year)) return false;
  if (year > 99 && year < kFirstYear) {
    return reader->Fail(parts.year, "a year");
  }
  if (year < 100) year += year < 70 ? 2000 : 1900;
  cell->digits = {4, 2, 2};
  cell->separator = '-';
  int month_of_year = 0;
  int day_of_month = 0;
  int day_of_year = 0;
  if (parts.day_of_year >= 0) {
    if (!reader->Whole(parts.day_of_year, 1, 366, &day_of_year)) return false;
    if (!FindMonth(year, day_of_year, &month_of_year, &day_of_month)) {
      return reader->Fail(parts.day_of_year,
                          "a day of the year " + std::to_string(year));
    }
  }
  if (parts.month < 0) {
    month = month_of_year;
    day = day_of_month;
    return true;
  }
  if (!reader->Whole(parts.month, 1, 12, &month) ||
      !reader->Whole(parts.day, 1, 31, &day)) {
    return false;
  }
  return parts.day_of_year < 0 ||
         (month == month_of_year && day == day_of_month) ||
         reader->Fail(parts.day_of_year, "the day of the date beside it");
}

}  // namespace

std::string UnitOfClockPart(const std::string& name) {
  return UnitOf(PartOf(name));
}

double FractionOfColumn(const TextColumn& column) {
  if (column.kind != CellKind::kNumber) return 0.0;
  const std::string lower = LowerCase(column.short_name);
  const std::string unit = CanonicalUnit(column.short_name);
  // North-south and up-south are directions.
  const bool is_direction =
      column.short_name == "NS" || column.short_name == "US";
  // "Frac [ms]" and "Millisec [ms]".
  const bool begins_so =
      lower.compare(0, 4, "frac") == 0 || lower.compare(0, 5, "milli") == 0;
  struct Fraction {
    const char* unit;
    std::array<const char*, 4> names;
    double seconds;
  };
  for (const Fraction& known :
       {Fraction{"ms", {"ms", "msec", "millisecond", "milliseconds"}, 1e-3},
        Fraction{"us", {"us", "usec", "microsecond", "microseconds"}, 1e-6},
        Fraction{"ns", {"ns", "nsec", "nanosecond", "nanoseconds"}, 1e-9}}) {
    const bool is_named =
        unit == known.unit || std::find(known.names.begin(), known.names.end(),
                                        lower) != known.names.end();
    if (is_named && !is_direction &&
        (column.unit.empty() || column.unit == known.unit)) {
      return known.seconds;
    }
    if (begins_so && column.unit == known.unit) return known.seconds;
  }
  return 0.0;
}

std::vector<int> ClockParts::Columns() const {
  std::vector<int> columns;
  for (const int column :
       {date, year, month, day, day_of_year, hour, minute, second}) {
    if (column >= 0) columns.push_back(column);
  }
  return columns;
}

bool ClockParts::Has(int column) const {
  const std::vector<int> all = Columns();
  return std::find(all.begin(), all.end(), column) != all.end();
}

int ClockParts::Last() const {
  return std::max(
      {date, year, month, day, day_of_year, hour, minute, second, fraction});
}

ClockParts FindClockParts(const std::vector<TextColumn>& columns) {
  ClockParts parts;
  for (size_t i = 0; i < columns.size(); ++i) {
    const TextColumn& column = columns[i];
    const Part part = PartOfShortName(column.short_name);
    if (part == Part::kNone) continue;
    const bool fits = part == Part::kDate ? column.kind == CellKind::kDate
                                          : column.kind == CellKind::kNumber;
    int* place = PlaceOf(part, &parts);
    const bool is_of_unit = column.unit.empty() || column.unit == UnitOf(part);
    if (!fits || !is_of_unit || *place >= 0) return ClockParts();
    *place = static_cast<int>(i);
  }
  if (parts.hour < 0 || parts.minute < 0 || parts.second < 0 ||
      !IsDateComplete(parts)) {
    return ClockParts();
  }
  FindFraction(columns, &parts);
  return parts;
}

bool ParseClockParts(const std::vector<std::string_view>& cells,
                     const ClockParts& parts, char decimal, ClockCell* cell,
                     int* bad, std::string* error) {
  *cell = ClockCell();
  PartReader reader(cells, decimal, bad, error);
  int hour = 0;
  int minute = 0;
  double second = 0.0;
  double fraction = 0.0;
  if (!ParseDate(parts, &reader, cell) ||
      !reader.Whole(parts.hour, 0, cell->has_date ? 23 : kMostHours, &hour) ||
      !reader.Whole(parts.minute, 0, 59, &minute) ||
      !reader.Number(parts.second, 60.0, &second)) {
    return false;
  }
  if (parts.fraction >= 0) {
    if (!reader.Number(parts.fraction,
                       std::round(1.0 / parts.fraction_in_seconds),
                       &fraction)) {
      return false;
    }
    if (second != std::floor(second)) {
      return reader.Fail(parts.second,
                         "whole seconds beside a column of fractions");
    }
  }
  cell->has_time = true;
  cell->seconds = 3600.0 * hour + 60.0 * minute + second +
                  fraction * parts.fraction_in_seconds;
  return true;
}

bool HasHalfOfDay(const std::vector<std::string_view>& cells) {
  return std::any_of(cells.begin(), cells.end(), [](std::string_view cell) {
    std::string lower = LowerCase(cell);
    ReplaceAll(".", "", &lower);
    return lower == "am" || lower == "pm";
  });
}

}  // namespace pinode
