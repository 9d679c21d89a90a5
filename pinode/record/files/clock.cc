#include "pinode/record/files/clock.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>

#include "pinode/base/file_text.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

constexpr double kSecondsOfDay = 86400.0;
// Largest step, in median steps, of a column whose order of day and month is
// found from its even steps.
constexpr double kLargestEvenStep = 100.0;

bool IsDigit(char c) { return c >= '0' && c <= '9'; }
bool IsLetter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
         static_cast<unsigned char>(c) >= 0x80;
}

// Takes up to `most` digits off the front; returns their number.
int TakeDigits(std::string_view* text, int most, int* value) {
  int digits = 0;
  *value = 0;
  while (digits < most && !text->empty() && IsDigit(text->front())) {
    *value = 10 * *value + (text->front() - '0');
    text->remove_prefix(1);
    ++digits;
  }
  return digits;
}

bool Take(std::string_view* text, char c) {
  if (text->empty() || text->front() != c) return false;
  text->remove_prefix(1);
  return true;
}

// Returns 1 to 12 for an English or German name or abbreviation, else 0.
int MonthOf(std::string_view word) {
  if (word.size() < 3) return 0;
  static const char* const kNames[][2] = {
      {"jan", "j\xC3\xA4n"}, {"feb", "feb"}, {"mar", "m\xC3\xA4r"},
      {"apr", "apr"},        {"may", "mai"}, {"jun", "jun"},
      {"jul", "jul"},        {"aug", "aug"}, {"sep", "sep"},
      {"oct", "okt"},        {"nov", "nov"}, {"dec", "dez"}};
  const std::string lower = LowerCase(word);
  for (int month = 1; month <= 12; ++month) {
    for (const char* name : kNames[month - 1]) {
      if (lower.rfind(name, 0) == 0) return month;
    }
  }
  return 0;
}

// Takes a fraction's digits, without the sign before them.
bool TakeFraction(std::string_view* text, double* fraction) {
  double scale = 1.0;
  double sum = 0.0;
  int digits = 0;
  while (!text->empty() && IsDigit(text->front())) {
    if (digits < 17) {
      sum = 10.0 * sum + (text->front() - '0');
      scale *= 10.0;
    }
    text->remove_prefix(1);
    ++digits;
  }
  *fraction = sum / scale;
  return digits > 0;
}

bool TakeDate(std::string_view* text, ClockCell* cell) {
  std::string_view rest = *text;
  cell->digits[0] = TakeDigits(&rest, 8, &cell->date[0]);
  // 20240301T120000
  if (cell->digits[0] == 8 && !rest.empty() && rest.front() == 'T') {
    const int packed = cell->date[0];
    cell->date = {packed / 10000, packed / 100 % 100, packed % 100};
    cell->digits = {4, 2, 2};
    cell->separator = 'T';
    *text = rest;
    return true;
  }
  if (cell->digits[0] == 0 || cell->digits[0] > 4 || rest.empty()) return false;
  cell->separator = rest.front();
  if (cell->separator != '-' && cell->separator != '/' &&
      cell->separator != '.' && cell->separator != ' ') {
    return false;
  }
  rest.remove_prefix(1);
  size_t letters = 0;
  while (letters < rest.size() && IsLetter(rest[letters])) ++letters;
  if (letters > 0) {
    cell->date[1] = MonthOf(rest.substr(0, letters));
    cell->digits[1] = 2;
    cell->month_is_named = true;
    rest.remove_prefix(letters);
    if (cell->date[1] == 0) return false;
    Take(&rest, '.');
    if (cell->separator == '.') Take(&rest, ' ');
  } else {
    cell->digits[1] = TakeDigits(&rest, 4, &cell->date[1]);
    if (cell->digits[1] == 0 || cell->digits[1] > 2) return false;
  }
  if (!cell->month_is_named || cell->separator != '.') {
    if (!Take(&rest, cell->separator)) return false;
  }
  // Three numbers between blanks are columns.
  if (cell->separator == ' ' && !cell->month_is_named) return false;
  cell->digits[2] = TakeDigits(&rest, 4, &cell->date[2]);
  if (cell->digits[2] == 0 || cell->digits[2] == 3 || cell->digits[0] == 3) {
    return false;
  }
  if (cell->digits[0] == 4 && cell->digits[2] == 4) return false;
  *text = rest;
  return true;
}

bool TakeTime(std::string_view* text, ClockCell* cell) {
  std::string_view rest = *text;
  int hours = 0;
  int minutes = 0;
  int seconds = 0;
  const int digits = TakeDigits(&rest, 6, &hours);
  if (digits == 6 && cell->separator == 'T') {
    // 120000, after the T of a packed date
    seconds = hours % 100;
    minutes = hours / 100 % 100;
    hours /= 10000;
  } else {
    if (digits == 0 || digits > 3 || !Take(&rest, ':') ||
        TakeDigits(&rest, 3, &minutes) != 2 || !Take(&rest, ':') ||
        TakeDigits(&rest, 3, &seconds) != 2) {
      return false;
    }
  }
  if (minutes > 59 || seconds > 60) return false;
  double fraction = 0.0;
  if (Take(&rest, '.') || Take(&rest, ',')) {
    if (!TakeFraction(&rest, &fraction)) return false;
  } else if (Take(&rest, ':')) {
    const size_t before = rest.size();
    if (!TakeFraction(&rest, &fraction)) return false;
    // Two digits may be frames or hundredths.
    const size_t width = before - rest.size();
    if (width != 3 && width != 6) return false;
  }
  const std::string_view after = StripBlanks(rest);
  if (after.size() >= 2 && (after[1] == 'M' || after[1] == 'm')) {
    const char half = static_cast<char>(after[0] | 0x20);
    if ((half != 'a' && half != 'p') || hours < 1 || hours > 12) return false;
    hours = hours % 12 + (half == 'p' ? 12 : 0);
    rest = after.substr(2);
  }
  cell->seconds = 3600.0 * hours + 60.0 * minutes + seconds + fraction;
  *text = rest;
  return true;
}

// Takes Z, UTC, +01:00, +0100 or +01; true without a zone.
bool TakeZone(std::string_view* text, ClockCell* cell) {
  *text = StripBlanks(*text);
  if (text->empty()) return true;
  cell->has_zone = true;
  if (*text == "Z" || *text == "z" || *text == "UTC" || *text == "GMT") {
    *text = {};
    return true;
  }
  const int sign = text->front() == '-' ? -1 : 1;
  if (!Take(text, '+') && !Take(text, '-')) return false;
  int hours = 0;
  int minutes = 0;
  if (TakeDigits(text, 2, &hours) != 2) return false;
  const bool colon = Take(text, ':');
  const int digits = TakeDigits(text, 2, &minutes);
  if (digits != 2 && (digits != 0 || colon)) return false;
  cell->zone = sign * (60 * hours + minutes);
  return hours <= 14 && minutes < 60;
}

enum class Order { kYearMonthDay, kDayMonthYear, kMonthDayYear };

const char* OrderName(Order order) {
  switch (order) {
    case Order::kYearMonthDay:
      return "year-month-day";
    case Order::kDayMonthYear:
      return "day-month-year";
    case Order::kMonthDayYear:
      return "month-day-year";
  }
  return "";
}

// Returns the orders that the fields of a date allow by their form.
std::vector<Order> OrdersOf(const ClockCell& cell) {
  if (cell.digits[0] == 4) return {Order::kYearMonthDay};
  if (cell.month_is_named) return {Order::kDayMonthYear};
  // With points, a year of two digits may come first, as in Korea or Hungary;
  // else it is the day in every country.
  if (cell.separator == '.') {
    return cell.digits[2] == 4
               ? std::vector<Order>{Order::kDayMonthYear}
               : std::vector<Order>{Order::kDayMonthYear, Order::kYearMonthDay};
  }
  if (cell.digits[2] == 4) {
    return {Order::kDayMonthYear, Order::kMonthDayYear};
  }
  return {Order::kDayMonthYear, Order::kMonthDayYear, Order::kYearMonthDay};
}

// Finds the days since 1970-01-01; false if there is no such day.
bool DaysOf(const ClockCell& cell, Order order, double* days) {
  tm date = {};
  int year = cell.date[order == Order::kYearMonthDay ? 0 : 2];
  const int year_digits = cell.digits[order == Order::kYearMonthDay ? 0 : 2];
  if (year_digits == 2) year += year < 70 ? 2000 : 1900;
  const int month = cell.date[order == Order::kMonthDayYear ? 0 : 1];
  const int day = cell.date[order == Order::kYearMonthDay   ? 2
                            : order == Order::kDayMonthYear ? 0
                                                            : 1];
  date.tm_year = year - 1900;
  date.tm_mon = month - 1;
  date.tm_mday = day;
  const time_t seconds = timegm(&date);
  *days = static_cast<double>(seconds) / kSecondsOfDay;
  // timegm normalises 31 February to another day.
  return date.tm_mon == month - 1 && date.tm_mday == day &&
         date.tm_year == year - 1900;
}

// Seconds of all rows since the first one by one order of the dates. Returns
// false, with the row, if a date does not exist.
bool SecondsBy(const std::vector<ClockCell>& cells, Order order,
               std::vector<double>* seconds, double* origin, int64_t* bad_row) {
  double first_days = 0.0;
  const auto of_day = [](const ClockCell& cell) {
    return cell.seconds - 60.0 * cell.zone;
  };
  // Dates change rarely.
  std::array<int, 3> last = {-1, -1, -1};
  double days = 0.0;
  seconds->clear();
  for (size_t i = 0; i < cells.size(); ++i) {
    const ClockCell& cell = cells[i];
    if (cell.has_date && cell.date != last) {
      if (!DaysOf(cell, order, &days)) {
        *bad_row = static_cast<int64_t>(i);
        return false;
      }
      last = cell.date;
    }
    if (i == 0) first_days = days;
    seconds->push_back((days - first_days) * kSecondsOfDay +
                       (of_day(cell) - of_day(cells[0])));
  }
  *origin = first_days * kSecondsOfDay + of_day(cells[0]);
  return true;
}

// True if times increase without a step that is far above the others.
bool AreEven(const std::vector<double>& seconds) {
  std::vector<double> steps;
  for (size_t i = 1; i < seconds.size(); ++i) {
    if (seconds[i] < seconds[i - 1]) return false;
    if (seconds[i] > seconds[i - 1])
      steps.push_back(seconds[i] - seconds[i - 1]);
  }
  if (steps.empty()) return true;
  std::sort(steps.begin(), steps.end());
  // The smaller one if there are two.
  return steps.back() <= kLargestEvenStep * steps[(steps.size() - 1) / 2];
}

// True if no step is as long as a day, forwards or back. Another order of the
// dates makes a month or a year of a midnight.
bool AreWithoutADay(const std::vector<double>& seconds) {
  for (size_t i = 1; i < seconds.size(); ++i) {
    if (std::abs(seconds[i] - seconds[i - 1]) >= kSecondsOfDay) return false;
  }
  return true;
}

// Returns the place of the only order whose times `is_likely` accepts; -1 if
// there is none or several.
int OnlyLikely(const std::vector<std::pair<Order, ClockColumn>>& kept,
               bool (*is_likely)(const std::vector<double>& seconds)) {
  int found = -1;
  for (size_t i = 0; i < kept.size(); ++i) {
    if (!is_likely(kept[i].second.seconds)) continue;
    if (found >= 0) return -1;
    found = static_cast<int>(i);
  }
  return found;
}

// Parses the fraction that follows the seconds of `text`, which are behind
// the last colon.
bool ParseWithStrptime(const std::string& format, const std::string& text,
                       tm* fields, double* fraction) {
  const size_t second = format.find("%f") != std::string::npos
                            ? format.find("%f")
                            : std::min(format.find("%S"), format.find("%T"));
  if (second == std::string::npos) {
    const char* end = strptime(text.c_str(), format.c_str(), fields);
    return end != nullptr && StripBlanks(end).empty();
  }
  const bool placed = format[second + 1] == 'f';
  const std::string head = format.substr(0, placed ? second : second + 2);
  const char* end = strptime(text.c_str(), head.c_str(), fields);
  if (end == nullptr) return false;
  std::string_view rest(end);
  if (placed || (!rest.empty() && (rest[0] == '.' || rest[0] == ','))) {
    if (!placed) rest.remove_prefix(1);
    if (!TakeFraction(&rest, fraction)) return false;
  }
  const std::string tail = format.substr(second + 2);
  const std::string left(rest);
  if (tail.empty()) return StripBlanks(left).empty();
  end = strptime(left.c_str(), tail.c_str(), fields);
  return end != nullptr && StripBlanks(end).empty();
}

}  // namespace

bool ParseClock(std::string_view text, ClockCell* cell) {
  *cell = ClockCell();
  std::string_view rest = StripBlanks(text);
  if (rest.empty() || !IsDigit(rest.front())) return false;
  if (TakeDate(&rest, cell)) {
    cell->has_date = true;
    if (rest.empty()) return cell->separator != 'T';
    // Blanks, T, comma, underscore or hyphen between date and time.
    const size_t begin = rest.find_first_not_of(" T,_-");
    if (begin == 0 || begin == std::string_view::npos) return false;
    rest.remove_prefix(begin);
    cell->has_time = TakeTime(&rest, cell);
    return cell->has_time && TakeZone(&rest, cell) && rest.empty();
  }
  *cell = ClockCell();
  if (!TakeTime(&rest, cell)) return false;
  cell->has_time = true;
  if (StripBlanks(rest).empty()) return true;
  std::string_view date = rest;
  const size_t begin = date.find_first_not_of(' ');
  if (begin != 0 && begin != std::string_view::npos) {
    date.remove_prefix(begin);
    cell->has_date = TakeDate(&date, cell) && date.empty();
    if (cell->has_date) return true;
  }
  return TakeZone(&rest, cell) && rest.empty();
}

bool ParseClockBy(const std::string& format, std::string_view text,
                  ClockCell* cell) {
  *cell = ClockCell();
  tm fields = {};
  fields.tm_mday = 1;
  fields.tm_year = 70;
  double fraction = 0.0;
  if (!ParseWithStrptime(format, std::string(StripBlanks(text)), &fields,
                         &fraction)) {
    return false;
  }
  const auto has = [&format](const char* letters) {
    for (size_t i = format.find('%');
         i != std::string::npos && i + 1 < format.size();
         i = format.find('%', i + 2)) {
      if (std::string_view(letters).find(format[i + 1]) !=
          std::string_view::npos) {
        return true;
      }
    }
    return false;
  };
  cell->has_time = has("HIMSTRrcs");
  cell->has_date = has("dejmbBhYyDFcxs");
  // timegm undoes the zone only if it is subtracted.
  cell->has_zone = has("z");
  cell->zone = static_cast<int>(fields.tm_gmtoff / 60);
  cell->date = {fields.tm_year + 1900, fields.tm_mon + 1, fields.tm_mday};
  cell->digits = {4, 2, 2};
  cell->separator = '-';
  cell->seconds =
      3600.0 * fields.tm_hour + 60.0 * fields.tm_min + fields.tm_sec + fraction;
  return cell->has_time || cell->has_date;
}

bool ResolveClock(const std::vector<ClockCell>& cells, ClockColumn* column,
                  int64_t* bad_row, std::string* error) {
  CHECK(!cells.empty());
  *bad_row = -1;
  for (size_t i = 1; i < cells.size(); ++i) {
    if (cells[i].has_date == cells[0].has_date &&
        cells[i].has_time == cells[0].has_time &&
        cells[i].has_zone == cells[0].has_zone &&
        (!cells[i].has_date || (cells[i].separator == cells[0].separator &&
                                OrdersOf(cells[i]) == OrdersOf(cells[0])))) {
      continue;
    }
    *bad_row = static_cast<int64_t>(i);
    *error = "is written in another way than in the first row";
    return false;
  }
  ClockColumn best;
  std::vector<Order> possible;
  std::vector<std::pair<Order, ClockColumn>> kept;
  int64_t wrong = -1;
  const std::vector<Order> orders =
      cells[0].has_date ? OrdersOf(cells[0])
                        : std::vector<Order>{Order::kYearMonthDay};
  for (const Order order : orders) {
    ClockColumn result;
    if (SecondsBy(cells, order, &result.seconds, &result.origin, &wrong)) {
      kept.emplace_back(order, std::move(result));
    }
  }
  if (kept.empty()) {
    *bad_row = wrong;
    *error = "is not a date";
    return false;
  }
  bool same = true;
  for (const auto& [order, other] : kept) {
    same = same && other.seconds == kept[0].second.seconds;
  }
  bool certain = kept.size() == 1;
  if (!same) {
    int likely = OnlyLikely(kept, AreWithoutADay);
    if (likely < 0) likely = OnlyLikely(kept, AreEven);
    if (likely < 0) {
      *error =
          "has its day, month and year in an open order, and the times are not "
          "the same; set "
          "`time_format`, such as \"%d/%m/%Y %H:%M:%S\"";
      *bad_row = 0;
      return false;
    }
    std::swap(kept[0], kept[static_cast<size_t>(likely)]);
    certain = true;
  }
  *column = std::move(kept[0].second);
  column->is_dated = cells[0].has_date;
  column->is_order_certain = certain;
  column->format =
      cells[0].has_date
          ? (certain ? OrderName(kept[0].first)
                     : "date (the order of its numbers is open, and the times "
                       "are the same)")
          : "";
  return true;
}

std::string ClockText(double origin, bool is_dated) {
  constexpr int64_t kMicroseconds = 1000000;
  // Clocks of today have a resolution of 0.2 us in a double.
  const int64_t ticks = std::llround(origin * 1e6);
  const int64_t ticks_of_day = 86400 * kMicroseconds;
  const int64_t day_ticks =
      (ticks % ticks_of_day + ticks_of_day) % ticks_of_day;
  const int64_t days = (ticks - day_ticks) / ticks_of_day;
  const int whole = static_cast<int>(day_ticks / kMicroseconds);
  const int fraction = static_cast<int>(day_ticks % kMicroseconds);
  std::string text(32, ' ');
  text.resize(static_cast<size_t>(
      std::snprintf(text.data(), text.size(), "%02d:%02d:%02d.%06d",
                    whole / 3600, whole / 60 % 60, whole % 60, fraction)));
  // The fraction without its last zeros, or none.
  text.resize(fraction == 0 ? text.find('.') : text.find_last_not_of('0') + 1);
  if (!is_dated) return text;
  const time_t seconds = static_cast<time_t>(days * 86400);
  tm date = {};
  gmtime_r(&seconds, &date);
  std::string day(32, ' ');
  day.resize(strftime(day.data(), day.size(), "%Y-%m-%d", &date));
  return day + " " + text;
}

}  // namespace pinode
