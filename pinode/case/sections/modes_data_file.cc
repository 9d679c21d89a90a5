#include "pinode/case/sections/modes_data_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "pinode/base/arrays/array_files.h"
#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/base/unit_names.h"
#include "pinode/case/text/toml_value.h"
#include "pinode/record/files/array_table.h"
#include "pinode/record/files/loggers/logger_table.h"
#include "pinode/record/files/text_table.h"
#include "pinode/record/files/text_time.h"
#include "pinode/record/table.h"

namespace pinode {
namespace {

// Returns true for "t", "time", and these with a unit behind them: "Time [s]".
// "T" may be a temperature or a direction.
bool IsNameOfTime(const std::string& name) {
  size_t end = 0;
  std::string word;
  while (end < name.size() &&
         std::isalpha(static_cast<unsigned char>(name[end])) != 0) {
    word += name[end++];
  }
  if (word != "t" && LowerCase(word) != "time") return false;
  return end == name.size() ||
         std::string(" _([/").find(name[end]) != std::string::npos;
}

// Returns true if all steps are equal, up to rounding of the values.
bool IsUniformRamp(const Vector& values) {
  const Eigen::Index count = values.size();
  if (count < 3 || !values.allFinite()) return false;
  const double step =
      (values[count - 1] - values[0]) / static_cast<double>(count - 1);
  if (!(step > 0.0)) return false;
  const Vector ramp = Vector::LinSpaced(count, values[0], values[count - 1]);
  return (values - ramp).cwiseAbs().maxCoeff() < 0.6 * step;
}

// Converts a single data file to an equivalent case.
class DataFileReader {
 public:
  DataFileReader(const ModesDataFile& file, std::string* error)
      : file_(file), columns_(file.columns), error_(error) {}

  bool Read(ModesCase* c) {
    if (!FindTime() || !FindColumns() || !FindQuantities() || !FindUnits() ||
        !CheckScales()) {
      return false;
    }
    TomlValue record = TomlValue::Table();
    record.Set("name", TomlValue::String(RecordName(file_.path)));
    record.Set("file", TomlValue::String(FileName(file_.path)));
    if (time_.empty()) {
      record.Set("sampling_rate_hz", TomlValue::Float(file_.sampling_rate_hz));
    } else {
      record.Set("time", TomlValue::String(time_));
      if (!file_.format.time_unit.empty()) {
        record.Set("time_unit", TomlValue::String(file_.format.time_unit));
      }
    }
    for (const auto& [key, value] : file_.format.Keys()) {
      record.Set(key, key == "header_lines"
                          ? TomlValue::Integer(file_.format.header_lines)
                          : TomlValue::String(value));
    }
    TomlValue channels = TomlValue::Array({});
    for (size_t i = 0; i < columns_.size(); ++i) {
      TomlValue channel = TomlValue::Table();
      channel.Set("column", TomlValue::String(columns_[i]));
      channel.Set("quantity", TomlValue::String(quantities_[i]));
      channel.Set("unit",
                  TomlValue::String(units_[i].empty() ? "model" : units_[i]));
      const double scale = file_.scales.FactorOf(columns_[i], OtherName(i));
      if (scale != 1.0) channel.Set("scale", TomlValue::Float(scale));
      channels.elements.push_back(std::move(channel));
    }
    record.Set("channel", std::move(channels));
    TomlValue root = TomlValue::Table();
    TomlValue units = TomlValue::Table();
    units.Set("time", TomlValue::String("s"));
    root.Set("units", std::move(units));
    root.Set("title", TomlValue::String("Modes of " + FileName(file_.path)));
    root.Set("record", TomlValue::Array({std::move(record)}));
    if (!ReadModesTree(root, file_.path, nullptr, c, error_)) return false;
    c->remarks.insert(c->remarks.end(), remarks_.begin(), remarks_.end());
    return true;
  }

 private:
  // The name of the file, with '_' for what no record may be called: loggers
  // write "Messung 1 (neu).csv".
  static std::string RecordName(const std::string& path) {
    std::string name = FileName(path).substr(0, 100);
    for (char& c : name) {
      const bool is_allowed =
          std::isalnum(static_cast<unsigned char>(c)) != 0 ||
          static_cast<unsigned char>(c) >= 0x80 || c == '_' || c == '-' ||
          c == '.' || c == '+';
      if (!is_allowed) c = '_';
    }
    if (name[0] == '.') name[0] = '_';
    return name;
  }
  static std::string FileName(const std::string& path) {
    return path.substr(path.find_last_of('/') + 1);
  }

  bool Fail(const std::string& message) {
    *error_ = file_.path + ": " + message;
    return false;
  }

  TextFormat FormatWithTime() const {
    TextFormat format = file_.format;
    format.time_column = file_.time_column;
    return format;
  }

  // Refuses keys of the form of text that would not be used.
  bool CheckKeys() {
    if (!file_.format.time_unit.empty() && file_.sampling_rate_hz != 0.0) {
      return Fail(
          "time_unit and sampling_rate_hz are both given, expected one of "
          "them: a sampling rate has no unit");
    }
    if (IsTextFile(file_.path, file_.format)) return true;
    const bool has_encoding = IsLoggerText(FindLoggerFormat(file_.path));
    for (const auto& [key, value] : file_.format.Keys()) {
      if (key == "encoding" && has_encoding) continue;
      return Fail(key + " = " + value +
                  " is for files of text in columns, and this is none; leave "
                  "it out");
    }
    return true;
  }

  bool FindTime() {
    if (!CheckKeys()) return false;
    if (!file_.time_column.empty() && file_.sampling_rate_hz != 0.0) {
      return Fail(
          "a time column and a sampling rate are both given, expected one of "
          "them");
    }
    if (IsTextFile(file_.path, file_.format) &&
        !ReadTextOutline(file_.path, FormatWithTime(), &outline_, error_)) {
      return false;
    }
    time_ = file_.time_column;
    if (!time_.empty() || file_.sampling_rate_hz != 0.0) return true;
    if (outline_.time_column >= 0) {
      time_ = outline_.columns[static_cast<size_t>(outline_.time_column)].name;
      return true;
    }
    if (!IsTextFile(file_.path, file_.format)) {
      Table table;
      std::string missing;
      for (const char* name : {"t", "time"}) {
        if (ReadTable(file_.path, {name}, FormatWithTime(), &table, &missing) &&
            FindArrayTimes(table, "").time == name) {
          time_ = name;
          return true;
        }
      }
      // The reader's error message applies if the file is no table.
      if (!ReadTable(file_.path, {}, FormatWithTime(), &table, error_))
        return false;
      time_ = FindArrayTimes(table, "").time;
      if (!time_.empty()) return true;
    }
    return Fail(
        "no column is recognised as the time; expected one named 't' or "
        "'time', clock times, the name of the time column, or a sampling rate");
  }

  const std::string& NameOf(int column) const {
    return outline_.columns[static_cast<size_t>(column)].name;
  }

  bool FailOfClocks(const std::string& time, const std::string& other) {
    return Fail("the times of '" + time + "' and '" + other +
                "' differ, and a column may belong to either; leave out one "
                "of them and its columns");
  }

  void RemarkOnTimes(const std::vector<std::string>& times) {
    if (times.empty()) return;
    remarks_.push_back("Left out, because their names are those of times: " +
                       Join(times, ", ") + ".");
  }

  // Finds the channels of a file that is no text.
  bool FindArrayColumns() {
    Table table;
    if (!ReadTable(file_.path, {}, FormatWithTime(), &table, error_))
      return false;
    const ArrayTimes times = FindArrayTimes(table, time_);
    // Other files than those of arrays have their own time, "t".
    const bool is_array = IsArrayFile(file_.path);
    if (is_array && !times.other_clock.empty()) {
      return FailOfClocks(times.time, times.other_clock);
    }
    std::vector<std::string> left_out;
    for (size_t i = 0; i < table.columns.size(); ++i) {
      const std::string& name = table.columns[i];
      if (name == time_) continue;
      const bool is_time =
          name == times.time ||
          std::find(times.others.begin(), times.others.end(), name) !=
              times.others.end() ||
          (IsNameOfTime(name) &&
           IsUniformRamp(table.values.col(static_cast<Eigen::Index>(i))));
      if (!is_time) {
        columns_.push_back(name);
      } else if (is_array || name != "t") {
        left_out.push_back(name);
      }
    }
    RemarkOnTimes(left_out);
    return true;
  }

  bool FindColumns() {
    if (columns_.size() != 1 || columns_[0] != "all") return true;
    columns_.clear();
    if (!IsTextFile(file_.path, file_.format)) return FindArrayColumns();
    if (!outline_.other_clocks.empty()) {
      return FailOfClocks(NameOf(outline_.time_column),
                          NameOf(outline_.other_clocks.front()));
    }
    std::vector<std::string> texts;
    const std::vector<std::string> times = outline_.UnusedTimes(time_);
    for (size_t i = 0; i < outline_.columns.size(); ++i) {
      if (outline_.columns[i].kind == CellKind::kText) {
        texts.push_back(outline_.columns[i].name);
      }
      if (outline_.is_channel[i] && outline_.columns[i].name != time_) {
        columns_.push_back(outline_.columns[i].name);
      }
    }
    if (!texts.empty()) {
      remarks_.push_back(
          "Left out, because they contain text: " + Join(texts, ", ") + ".");
    }
    RemarkOnTimes(times);
    return !columns_.empty() || Fail("no column has numbers of a channel");
  }

  static Dimension DimensionOfName(const std::string& quantity) {
    return quantity == "displacement" ? Dimension::kLength
           : quantity == "velocity"   ? Dimension::kVelocity
           : quantity == "strain"     ? Dimension::kNumber
                                      : Dimension::kAcceleration;
  }

  // Finds the units of the channels. Without any the numbers are taken as they
  // are: shapes are ratios.
  bool FindUnits() {
    units_.assign(columns_.size(), "");
    std::string first;
    bool same = true;
    bool any_voltage = false;
    std::vector<std::string> without;
    for (size_t i = 0; i < columns_.size(); ++i) {
      for (const TextColumn& column : outline_.columns) {
        if (column.name == columns_[i] || column.short_name == columns_[i]) {
          units_[i] = column.unit;
        }
      }
      Dimension dimension = Dimension::kVoltage;
      if (units_[i].empty() || !FindDimension(units_[i], &dimension)) {
        units_[i].clear();
        without.push_back(columns_[i]);
        continue;
      }
      any_voltage = any_voltage || dimension == Dimension::kVoltage;
      if (dimension != Dimension::kVoltage &&
          dimension != DimensionOfName(quantities_[i])) {
        return Fail("column '" + columns_[i] + "' is in " + units_[i] +
                    ", the unit of " + DimensionName(dimension) +
                    ", but its quantity is " + quantities_[i] +
                    "; set its quantity, or leave the column out");
      }
      if (first.empty()) first = units_[i];
      same = same && units_[i] == first;
    }
    if (!same && (any_voltage || !without.empty())) {
      return Fail(
          "the units of the columns cannot be compared; write a case that "
          "gives each column its `unit`");
    }
    if (first.empty() || without.empty()) return true;
    for (std::string& unit : units_) unit = first;
    for (const std::string& name : without) {
      // "Temp (C)" is something else.
      if (name.back() != ']' && name.back() != ')') continue;
      return Fail("the unit of column '" + name +
                  "' is not known, but others have " + first +
                  "; name only columns of one kind");
    }
    remarks_.push_back("No unit is stated for " + Join(without, ", ") +
                       ": read as " + first + ", like the other columns.");
    return true;
  }

  // Returns the name without a unit of a channel that is named with it, or the
  // other way round. Empty: there is none.
  std::string OtherName(size_t i) const {
    for (const TextColumn& column : outline_.columns) {
      if (column.name == columns_[i]) return column.short_name;
      if (column.short_name == columns_[i]) return column.name;
    }
    return "";
  }

  bool CheckScales() {
    std::vector<std::string> known = columns_;
    for (size_t i = 0; i < columns_.size(); ++i) known.push_back(OtherName(i));
    std::string what;
    return file_.scales.AreOf(known, &what) || Fail("scale: " + what);
  }

  bool FindQuantities() {
    quantities_ = file_.quantities;
    if (quantities_.empty()) quantities_ = {"acceleration"};
    if (quantities_.size() == 1)
      quantities_.resize(columns_.size(), quantities_[0]);
    if (quantities_.size() != columns_.size()) {
      return Fail(std::to_string(quantities_.size()) + " quantities for " +
                  std::to_string(columns_.size()) +
                  " columns, expected one for all or one for each");
    }
    for (std::string& quantity : quantities_) {
      // Motion of the ground is unknown here: absolute and relative
      // accelerations are treated alike.
      if (quantity == "acceleration") {
        quantity = "absolute_acceleration";
      } else if (quantity != "velocity" && quantity != "displacement" &&
                 quantity != "strain") {
        return Fail("quantity '" + quantity +
                    "', expected acceleration, velocity, displacement or "
                    "strain");
      }
    }
    return true;
  }

  const ModesDataFile& file_;
  std::vector<std::string> columns_;
  std::vector<std::string> quantities_;
  std::vector<std::string> units_;
  TextOutline outline_;  // of a text file
  std::vector<std::string> remarks_;
  std::string time_;
  std::string* error_;
};

}  // namespace

bool ReadModesDataFile(const ModesDataFile& file, ModesCase* c,
                       std::string* error) {
  return DataFileReader(file, error).Read(c);
}

}  // namespace pinode
