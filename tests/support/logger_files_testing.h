// For tests only, hence not installed: random files as data loggers write them,
// with what they mean.

#ifndef TESTS_SUPPORT_LOGGER_FILES_TESTING_H_
#define TESTS_SUPPORT_LOGGER_FILES_TESTING_H_

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace pinode {

// Text of a file, and what a reader must find in it.
struct LoggerFile {
  std::string text;
  // Mix of the file, for messages.
  std::string mix;
  // Column of the time as the file calls it; empty: none.
  std::string time;
  // Seconds of the rows since the first one.
  std::vector<double> seconds;
  // Channels: name, stated unit, values (NaN: missing) as they were written.
  std::vector<std::string> names;
  std::vector<std::string> units;
  std::vector<std::vector<double>> values;
  // Largest error of the times that were written, s.
  double time_error = 1e-6;
};

// Writes random files. Every property is drawn by itself, so that all mixes
// occur; combinations that no logger can write are drawn again.
class LoggerFileWriter {
 public:
  explicit LoggerFileWriter(unsigned seed) : random_(seed) {}

  LoggerFile Write() {
    while (true) {
      Draw();
      if (IsPossible()) break;
    }
    MakeRows();
    return MakeFile();
  }

 private:
  enum class Time {
    kNone,
    kSeconds,
    kMilliseconds,
    kIso,
    kPoints,        // 01.03.2024 12:00:00,005
    kSlashes,       // 3/1/2024 12:00:00.005
    kTwelveHours,   // 2024/03/01 12:00:00.005 PM
    kTimeOfDay,     // over midnight
    kTwoColumns,    // date, time of day with a fraction
    kThreeColumns,  // date, time of day, microseconds
    kEpoch,         // milliseconds since 1970
    kTicks,         // of .NET
    kCounter,       // milliseconds modulo a power of two
    kCount
  };
  enum class Names { kPlain, kWithUnits, kUnitRow, kComment, kNone, kCount };
  enum class Preamble { kNone, kComments, kText, kPairs, kPadded, kCount };
  enum class Numbers { kFixed, kExponent, kShort, kWhole, kSpacedSign, kCount };

  template <typename Enum>
  Enum Any() {
    return static_cast<Enum>(Below(static_cast<int>(Enum::kCount)));
  }
  int Below(int n) {
    return static_cast<int>(random_() % static_cast<unsigned>(n));
  }
  bool OneIn(int n) { return Below(n) == 0; }
  double Uniform() { return static_cast<double>(random_()) / 4294967296.0; }

  void Draw() {
    delimiter_ = ",;\t| "[Below(5)];
    comma_ = OneIn(2);
    time_ = Any<Time>();
    names_ = Any<Names>();
    preamble_ = Any<Preamble>();
    numbers_ = Any<Numbers>();
    num_channels_ = 1 + Below(5);
    num_rows_ = 40 + Below(200);
    rate_ = std::vector<double>{
        50, 100, 128, 200, 250, 500}[static_cast<size_t>(Below(6))];
    encoding_ = Below(5);
    line_end_ = std::vector<std::string>{"\n", "\r\n", "\n",
                                         "\r"}[static_cast<size_t>(Below(4))];
    quoted_ = OneIn(6);
    trailing_ = OneIn(6);
    missing_ = OneIn(4);
    status_ = OneIn(6);
    row_numbers_ = OneIn(6);
    rule_ = OneIn(6);
    same_names_ = OneIn(8);
    blanks_in_names_ = OneIn(2);
  }

  bool IsPossible() const {
    // A decimal comma needs another delimiter, or quotes.
    if (delimiter_ == ',' && (comma_ || time_ == Time::kPoints)) return false;
    if (delimiter_ == ' ' &&
        (quoted_ || trailing_ || missing_ || blanks_in_names_ ||
         numbers_ == Numbers::kSpacedSign || HasBlanksInTime() ||
         names_ == Names::kUnitRow)) {
      return false;
    }
    // A program that writes names into a comment, or none, writes no rule.
    if ((names_ == Names::kComment || names_ == Names::kNone) &&
        (rule_ || same_names_ || preamble_ == Preamble::kText ||
         preamble_ == Preamble::kPairs || preamble_ == Preamble::kPadded)) {
      return false;
    }
    if (names_ == Names::kComment && (trailing_ || delimiter_ == ' ')) {
      return false;
    }
    if (names_ == Names::kNone && (status_ || trailing_)) return false;
    return num_channels_ > 1 || !same_names_;
  }

  bool IsOneColumn() const {
    return num_channels_ == 1 && time_ == Time::kNone && !status_ &&
           !row_numbers_ && !quoted_ && !trailing_;
  }

  bool HasBlanksInTime() const {
    return time_ == Time::kPoints || time_ == Time::kSlashes ||
           time_ == Time::kTwelveHours;
  }

  void MakeRows() {
    seconds_.clear();
    for (int i = 0; i < num_rows_; ++i) seconds_.push_back(i / rate_);
    values_.assign(static_cast<size_t>(num_channels_), {});
    cells_.assign(static_cast<size_t>(num_channels_), {});
    for (size_t c = 0; c < values_.size(); ++c) {
      const double size = std::pow(10.0, Below(5) - 2);
      const double frequency = 1.0 + 9.0 * Uniform();
      for (int i = 0; i < num_rows_; ++i) {
        const double value =
            size * (std::sin(6.28 * frequency * i / rate_) + Uniform() - 0.5);
        std::string cell = Number(value);
        double written = std::stod(cell);
        if (missing_ && OneIn(10)) {
          // A file of one column has no empty cells, only blank lines.
          cell = OneIn(2) && !IsOneColumn() ? "" : "NaN";
          written = std::numeric_limits<double>::quiet_NaN();
        } else if (numbers_ == Numbers::kSpacedSign) {
          cell = cell[0] == '-' ? "- " + cell.substr(1) : "+ " + cell;
        }
        values_[c].push_back(written);
        cells_[c].push_back(Point(cell));
      }
    }
  }

  std::string Number(double value) const {
    switch (numbers_) {
      case Numbers::kExponent:
        return Print("%.6e", value);
      case Numbers::kShort:
        return Print("%g", value);
      case Numbers::kWhole:
        return Print("%.0f", 1000.0 * value);
      case Numbers::kFixed:
      case Numbers::kSpacedSign:
      default:
        return Print("%.5f", value);
    }
  }

  template <typename... Values>
  static std::string Print(const char* format, Values... values) {
    char buffer[96];
    std::snprintf(buffer, sizeof buffer, format, values...);
    return buffer;
  }

  // Writes the decimal sign of the file.
  std::string Point(std::string number) const {
    if (!comma_) return number;
    for (char& c : number) {
      if (c == '.') c = ',';
    }
    return number;
  }

  // Cells of the time of row i.
  std::vector<std::string> TimeCells(int i) {
    const double t = seconds_[static_cast<size_t>(i)];
    const auto micros = static_cast<int64_t>(std::llround(1e6 * t));
    // 2024-03-01 12:00:00, or eight seconds before midnight.
    const int64_t begin = time_ == Time::kTimeOfDay ? 1709337599 : begin_;
    const std::time_t whole =
        static_cast<std::time_t>(begin + micros / 1000000);
    const auto below = static_cast<long long>(micros % 1000000);
    std::tm utc = {};
    gmtime_r(&whole, &utc);
    char date[64];
    const auto text = [&](const char* format) {
      return std::string(date, std::strftime(date, sizeof date, format, &utc));
    };
    switch (time_) {
      case Time::kNone:
      case Time::kCount:
        return {};
      case Time::kSeconds:
        return {Point(Print("%.6f", t))};
      case Time::kMilliseconds:
        return {Point(Print("%.3f", 1e3 * t))};
      case Time::kIso:
        return {text("%Y-%m-%dT%H:%M:%S") + Print(".%06lldZ", below)};
      case Time::kPoints:
        return {text("%d.%m.%Y %H:%M:%S") + Print(",%06lld", below)};
      case Time::kSlashes:
        return {text("%m/%d/%Y %H:%M:%S") + Print(".%06lld", below)};
      case Time::kTwelveHours:
        return {text("%Y/%m/%d %I:%M:%S") + Print(".%06lld ", below) +
                text("%p")};
      case Time::kTimeOfDay:
        return {text("%H:%M:%S") + Print(".%06lld", below)};
      case Time::kTwoColumns:
        return {text("%Y-%m-%d"), text("%H:%M:%S") + Print(".%06lld", below)};
      case Time::kThreeColumns:
        return {text("%Y/%m/%d"), text("%H:%M:%S"), Print("%lld", below)};
      case Time::kEpoch:
        return {Print("%lld",
                      static_cast<long long>(1000 * begin_ + micros / 1000))};
      case Time::kTicks:
        return {Print("%lld", 621355968000000000LL + 10000000LL * begin_ +
                                  10LL * static_cast<long long>(micros))};
      case Time::kCounter:
        return {Print("%lld", static_cast<long long>(micros / 1000 % 256))};
    }
    return {};
  }

  std::vector<std::string> TimeNames() {
    switch (time_) {
      case Time::kNone:
      case Time::kCount:
        return {};
      case Time::kTwoColumns:
        return {"Date", "Time"};
      case Time::kThreeColumns:
        return {"Date", "Time", "us"};
      case Time::kSeconds:
      case Time::kMilliseconds:
        return {OneIn(2) ? "Time" : "Zeit"};
      default:
        return {OneIn(2) ? "Timestamp" : "t"};
    }
  }

  std::string TimeUnit() const {
    return time_ == Time::kSeconds                                   ? "s"
           : time_ == Time::kMilliseconds || time_ == Time::kCounter ? "ms"
                                                                     : "";
  }

  std::string Row(const std::vector<std::string>& cells, bool quote) const {
    std::string row;
    for (size_t i = 0; i < cells.size(); ++i) {
      if (i > 0) row += delimiter_;
      row += quote ? "\"" + cells[i] + "\"" : cells[i];
    }
    if (trailing_) row += delimiter_;
    return row + line_end_;
  }

  LoggerFile MakeFile() {
    begin_ = 1709294400 + Below(20) * 86400;
    LoggerFile file;
    file.values = values_;
    file.seconds = seconds_;
    std::vector<std::string> head = TimeNames();
    std::vector<std::string> unit_row(head.size());
    const bool has_units =
        names_ == Names::kWithUnits || names_ == Names::kUnitRow;
    if (!head.empty()) {
      const std::string unit = TimeUnit();
      std::string& name = head[head.size() > 1 ? 1 : 0];
      if (!unit.empty()) unit_row[0] = unit;
      // The unit stands in the name unless a row has it; seconds need none.
      if (names_ == Names::kWithUnits && !unit.empty())
        name += " [" + unit + "]";
      if (unit == "ms" && !has_units) name = "ms";
      if (delimiter_ == ' ' && !unit.empty() && names_ == Names::kWithUnits) {
        name = unit == "ms" ? "Time[ms]" : "Time[s]";
      }
      file.time = name;
    }
    if (row_numbers_) {
      head.insert(head.begin(), "NO.");
      unit_row.insert(unit_row.begin(), std::string());
    }
    AddChannels(has_units, &file, &head, &unit_row);
    if (status_) {
      head.push_back("Status");
      unit_row.push_back("");
    }
    NameWithoutNames(&head, &file);
    file.text = PreambleText();
    AddNames(head, unit_row, &file.text);
    AddRows(&file.text);
    if (OneIn(4)) file.text += line_end_;
    Encode(&file.text);
    Describe(&file);
    return file;
  }

  void AddChannels(bool has_units, LoggerFile* file,
                   std::vector<std::string>* head,
                   std::vector<std::string>* unit_row) {
    static const char* const kUnits[][2] = {
        {"mg", "mg"},       {"g", "g"},     {"m/s2", "m/s^2"},
        {"m/s^2", "m/s^2"}, {"gal", "gal"}, {"mm/s\xC2\xB2", "mm/s^2"},
        {"V", "V"},         {"mm", "mm"},   {"\xC2\xB5m/m", "um/m"}};
    for (int c = 0; c < num_channels_; ++c) {
      std::string name = "a" + std::to_string(c + 1);
      if (blanks_in_names_) {
        name = (OneIn(2) ? "Beschl. \xC3\xBC" : "CH") + std::to_string(c + 1) +
               " Acc";
      }
      if (same_names_) name = "acc";
      const auto& unit = kUnits[Below(9)];
      unit_row->push_back(unit[0]);
      file->units.push_back(has_units ? unit[1] : "");
      if (names_ == Names::kWithUnits) {
        const std::string blank = delimiter_ == ' ' ? "" : " ";
        name += OneIn(2) ? blank + "[" + unit[0] + "]"
                         : blank + "(" + unit[0] + ")";
      }
      head->push_back(name);
    }
    const size_t first = head->size() - static_cast<size_t>(num_channels_);
    for (size_t i = first; i < head->size(); ++i) {
      std::string name = (*head)[i];
      int same = 0;
      int before = 0;
      for (size_t j = first; j < head->size(); ++j) {
        if ((*head)[j] != name) continue;
        ++same;
        if (j <= i) ++before;
      }
      if (same > 1) name += "[" + std::to_string(before) + "]";
      file->names.push_back(name);
    }
  }

  void NameWithoutNames(std::vector<std::string>* head, LoggerFile* file) {
    if (names_ != Names::kNone) return;
    const auto column = [](size_t i) {
      return "column_" + std::to_string(i + 1);
    };
    const size_t first = head->size() - file->names.size();
    for (size_t i = 0; i < file->names.size(); ++i) {
      file->names[i] = column(first + i);
    }
    const size_t begin = row_numbers_ ? 1 : 0;
    if (!file->time.empty()) {
      file->time = column(begin + (first - begin > 1 ? 1 : 0));
    }
    head->clear();
  }

  std::string PreambleText() {
    if (preamble_ == Preamble::kNone) return "";
    std::string text;
    const int lines = 1 + Below(14);
    for (int i = 0; i < lines; ++i) {
      const std::string key = "Key " + std::to_string(i);
      const std::string value =
          OneIn(3) ? std::to_string(Below(500)) : "Halle W\xC3\xA4gung";
      if (preamble_ == Preamble::kComments) {
        text += "# " + key + ": " + value + line_end_;
      } else if (preamble_ == Preamble::kText) {
        text += key + ": " + value + line_end_;
      } else {
        text += key + delimiter_ + value;
        if (preamble_ == Preamble::kPadded && delimiter_ != ' ') {
          text +=
              std::string(static_cast<size_t>(num_channels_ + 3), delimiter_);
        }
        text += line_end_;
      }
    }
    if (OneIn(3)) text += line_end_;
    return text;
  }

  void AddNames(const std::vector<std::string>& head,
                const std::vector<std::string>& unit_row, std::string* text) {
    if (head.empty()) return;
    *text += (names_ == Names::kComment ? "# " : "") + Row(head, quoted_);
    if (names_ == Names::kUnitRow) {
      std::vector<std::string> units = unit_row;
      const bool brackets = OneIn(2);
      for (std::string& unit : units) {
        if (brackets && !unit.empty()) unit = "[" + unit + "]";
      }
      *text += Row(units, quoted_);
    }
    if (rule_) *text += std::string(30, '-') + line_end_;
  }

  void AddRows(std::string* text) {
    for (int i = 0; i < num_rows_; ++i) {
      std::vector<std::string> cells;
      if (row_numbers_) cells.push_back(std::to_string(i + 1));
      for (const std::string& cell : TimeCells(i)) cells.push_back(cell);
      for (const auto& column : cells_) {
        cells.push_back(column[static_cast<size_t>(i)]);
      }
      if (status_) cells.push_back(OneIn(9) ? "OVER" : "ok");
      *text += Row(cells, quoted_);
    }
  }

  void Encode(std::string* text) const {
    if (encoding_ == 0) *text = "\xEF\xBB\xBF" + *text;
    if (encoding_ != 1 && encoding_ != 2) return;
    std::string encoded = encoding_ == 1 ? "\xFF\xFE" : "";
    for (size_t i = 0; i < text->size(); ++i) {
      unsigned code = static_cast<unsigned char>((*text)[i]);
      // All letters are of two bytes at most.
      if (code >= 0xC0) {
        ++i;
        code = (code & 0x1F) << 6 |
               (static_cast<unsigned char>((*text)[i]) & 0x3F);
      }
      encoded += static_cast<char>(code);
      if (encoding_ == 1) encoded += '\0';
    }
    *text = encoded;
  }

  void Describe(LoggerFile* file) const {
    // Whole milliseconds.
    if (time_ == Time::kEpoch || time_ == Time::kCounter) {
      file->time_error = 1.001e-3;
    }
    file->mix = std::string("delimiter '") + delimiter_ + "', decimal " +
                (comma_ ? "comma" : "point") + ", time " +
                std::to_string(static_cast<int>(time_)) + ", names " +
                std::to_string(static_cast<int>(names_)) + ", preamble " +
                std::to_string(static_cast<int>(preamble_)) + ", numbers " +
                std::to_string(static_cast<int>(numbers_)) + ", encoding " +
                std::to_string(encoding_) + (quoted_ ? ", quoted" : "") +
                (trailing_ ? ", trailing delimiter" : "") +
                (missing_ ? ", missing values" : "") +
                (status_ ? ", status" : "") +
                (row_numbers_ ? ", row numbers" : "") +
                (rule_ ? ", rule" : "") + (same_names_ ? ", same names" : "");
  }

  std::mt19937 random_;
  char delimiter_ = ',';
  bool comma_ = false;
  Time time_ = Time::kNone;
  Names names_ = Names::kPlain;
  Preamble preamble_ = Preamble::kNone;
  Numbers numbers_ = Numbers::kFixed;
  int num_channels_ = 1;
  int num_rows_ = 0;
  double rate_ = 100.0;
  int encoding_ = 0;
  std::string line_end_ = "\n";
  bool quoted_ = false;
  bool trailing_ = false;
  bool missing_ = false;
  bool status_ = false;
  bool row_numbers_ = false;
  bool rule_ = false;
  bool same_names_ = false;
  bool blanks_in_names_ = false;
  int64_t begin_ = 1709294400;
  std::vector<double> seconds_;
  std::vector<std::vector<double>> values_;
  std::vector<std::vector<std::string>> cells_;
};

}  // namespace pinode

#endif  // TESTS_SUPPORT_LOGGER_FILES_TESTING_H_
