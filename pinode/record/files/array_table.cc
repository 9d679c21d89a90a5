#include "pinode/record/files/array_table.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "pinode/base/arrays/array_files.h"
#include "pinode/base/file_text.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/record/files/loggers/logger_table.h"
#include "pinode/record/files/text_table.h"
#include "pinode/record/files/universal_file.h"

namespace pinode {
namespace {

// A requested column.
struct ArrayColumn {
  std::string array;
  int number = 0;  // from 1; 0: the array's name alone
};

ArrayColumn ParseColumn(const std::string& name) {
  const size_t open = name.rfind('[');
  int number = 0;
  if (open == std::string::npos || name.back() != ']' ||
      !ParseInt(name.substr(open + 1, name.size() - open - 2), &number)) {
    return {name, 0};
  }
  return {name.substr(0, open), std::max(number, -1)};
}

void AppendColumns(const NamedArray& array, std::vector<std::string>* names) {
  if (array.columns == 1) {
    names->push_back(array.name);
    return;
  }
  for (Eigen::Index c = 1; c <= array.columns; ++c) {
    names->push_back(array.name + "[" + std::to_string(c) + "]");
  }
}

// Returns the columns of the arrays with the most samples.
std::vector<std::string> LongestColumns(const std::vector<NamedArray>& arrays) {
  Eigen::Index longest = 0;
  for (const NamedArray& array : arrays) {
    if (array.fault.empty()) longest = std::max(longest, array.samples);
  }
  std::vector<std::string> names;
  for (const NamedArray& array : arrays) {
    if (array.fault.empty() && array.samples == longest) {
      AppendColumns(array, &names);
    }
  }
  return names;
}

// Returns the known names for a message. Arrays with many columns appear once.
std::vector<std::string> KnownNames(const std::vector<NamedArray>& arrays) {
  std::vector<std::string> names;
  for (const NamedArray& array : arrays) {
    if (!array.fault.empty()) continue;
    names.push_back(array.columns == 1 ? array.name : array.name + "[1]");
  }
  return names;
}

// Returns the samples of a column, or null with a sentence in *what.
const double* FindColumn(const std::vector<NamedArray>& arrays,
                         const std::string& name, Eigen::Index* samples,
                         std::string* what) {
  ArrayColumn column = ParseColumn(name);
  auto found = std::find_if(
      arrays.begin(), arrays.end(),
      [&column](const NamedArray& a) { return a.name == column.array; });
  if (found == arrays.end()) {
    // A name may itself end in brackets.
    column = {name, 0};
    found =
        std::find_if(arrays.begin(), arrays.end(),
                     [&name](const NamedArray& a) { return a.name == name; });
  }
  if (found == arrays.end()) {
    *what = "no array is called '" + name + "'" +
            NameHint(name, KnownNames(arrays));
    return nullptr;
  }
  if (!found->fault.empty()) {
    *what = "array '" + found->name + "': " + found->fault +
            ", expected real numbers along one dimension or two";
    return nullptr;
  }
  if (column.number == 0 && found->columns == 1) column.number = 1;
  if (column.number < 1 || column.number > found->columns) {
    *what = "array '" + found->name + "' has " +
            std::to_string(found->samples) + " samples in " +
            std::to_string(found->columns) + " columns, '" + name +
            "' is none of them; expected '" + found->name + "[1]'" +
            (found->columns == 1 ? ""
                                 : " to '" + found->name + "[" +
                                       std::to_string(found->columns) + "]'");
    return nullptr;
  }
  *samples = found->samples;
  return found->values.col(column.number - 1).data();
}

// True for numbers that rise from row to row. Rounded times may repeat, if they
// lie no farther from even ones than their resolution.
bool Rises(const Eigen::Ref<const Vector>& values) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (!std::isnan(values[i])) rows.push_back(i);
  }
  if (rows.size() < 2) return false;
  double resolution = std::numeric_limits<double>::infinity();
  bool repeats = false;
  for (size_t i = 1; i < rows.size(); ++i) {
    const double rise = values[rows[i]] - values[rows[i - 1]];
    if (rise < 0.0) return false;
    if (rise > 0.0) {
      resolution = std::min(resolution, rise);
    } else {
      repeats = true;
    }
  }
  if (!repeats) return true;
  const double first = values[rows.front()];
  const double step = (values[rows.back()] - first) /
                      static_cast<double>(rows.back() - rows.front());
  return step > 0.0 &&
         std::all_of(rows.begin(), rows.end(), [&](Eigen::Index row) {
           const double even =
               first + step * static_cast<double>(row - rows.front());
           return std::abs(values[row] - even) <= resolution;
         });
}

// True if two columns of times are none of one clock. Seconds since 1970 and
// elapsed ones may be of one, so only their steps are compared.
bool AreOtherClocks(const Eigen::Ref<const Vector>& first,
                    const Eigen::Ref<const Vector>& second) {
  // Share of a step that roundings may differ by.
  constexpr double kOneClock = 0.02;
  // Seconds since 1970 are more, elapsed ones less: 3 years.
  constexpr double kLeastDate = 1e8;
  Eigen::Index begin = -1;
  Eigen::Index end = -1;
  for (Eigen::Index i = 0; i < first.size(); ++i) {
    if (std::isnan(first[i] + second[i])) continue;
    if (begin < 0) begin = i;
    end = i;
  }
  if (end == begin) return true;
  const double step =
      (first[end] - first[begin]) / static_cast<double>(end - begin);
  const bool is_date = first[begin] > kLeastDate;
  const double offset = is_date == (second[begin] > kLeastDate)
                            ? 0.0
                            : second[begin] - first[begin];
  for (Eigen::Index i = begin; i <= end; ++i) {
    // Seconds since 1970 have 16 digits.
    const double rounding =
        1e-15 * std::max(std::abs(first[i]), std::abs(second[i]));
    if (std::abs(second[i] - first[i] - offset) > kOneClock * step + rounding) {
      return true;
    }
  }
  return false;
}

}  // namespace

bool ReadArrayTable(const std::string& path,
                    const std::vector<std::string>& wanted, Table* table,
                    std::string* error) {
  CHECK(table != nullptr);
  CHECK(error != nullptr);
  std::set<std::string> names;
  for (const std::string& name : wanted) {
    names.insert(name);
    names.insert(ParseColumn(name).array);
  }
  std::vector<NamedArray> arrays;
  const auto is_wanted = [&](const std::string& name) {
    return wanted.empty() || names.count(name) > 0;
  };
  if (!ReadArrayFile(path, is_wanted, &arrays, error)) return false;
  const std::vector<std::string> columns =
      wanted.empty() ? LongestColumns(arrays) : wanted;
  if (columns.empty()) {
    *error = path + ": has no array of numbers, expected named histories";
    return false;
  }
  Table result;
  result.path = path;
  for (const std::string& name : columns) {
    if (result.FindColumn(name) >= 0) continue;
    Eigen::Index samples = 0;
    std::string what;
    const double* values = FindColumn(arrays, name, &samples, &what);
    if (values == nullptr) {
      *error = path + ": " + what;
      return false;
    }
    if (result.columns.empty()) {
      result.values.resize(samples, static_cast<Eigen::Index>(columns.size()));
    } else if (samples != result.values.rows()) {
      *error = path + ": '" + name + "' has " + std::to_string(samples) +
               " samples and '" + result.columns[0] + "' " +
               std::to_string(result.values.rows()) +
               ", expected columns of one length";
      return false;
    }
    const Eigen::Map<const Vector> column(values, samples);
    if (column.array().isInf().any()) {
      *error = path + ": '" + name +
               "' has an infinite number, expected finite ones, or NaN where "
               "one is missing";
      return false;
    }
    result.values.col(static_cast<Eigen::Index>(result.columns.size())) =
        column;
    result.columns.push_back(name);
  }
  result.values.conservativeResize(
      Eigen::NoChange, static_cast<Eigen::Index>(result.columns.size()));
  result.line_numbers.resize(static_cast<size_t>(result.values.rows()));
  std::iota(result.line_numbers.begin(), result.line_numbers.end(), int64_t{1});
  *table = std::move(result);
  return true;
}

bool IsTimeOfArrays(const std::string& name) {
  const std::string part = name.substr(name.find_last_of("./") + 1);
  return part == "t" || LowerCase(part) == "time";
}

ArrayTimes FindArrayTimes(const Table& table, const std::string& given) {
  ArrayTimes times;
  const auto values = [&table](const std::string& name) {
    return table.values.col(table.FindColumn(name));
  };
  for (const std::string& name : table.columns) {
    if (name != given && IsTimeOfArrays(name) && Rises(values(name))) {
      times.others.push_back(name);
    }
  }
  times.time = given;
  if (given.empty() && !times.others.empty()) {
    auto chosen = times.others.begin();
    for (const char* name : {"time", "t"}) {
      const auto found =
          std::find(times.others.begin(), times.others.end(), name);
      if (found != times.others.end()) chosen = found;
    }
    times.time = *chosen;
    times.others.erase(chosen);
  }
  if (table.FindColumn(times.time) < 0 || !Rises(values(times.time))) {
    return times;
  }
  for (const std::string& other : times.others) {
    if (AreOtherClocks(values(times.time), values(other))) {
      times.other_clock = other;
      break;
    }
  }
  return times;
}

bool IsTextFile(const std::string& path, const TextFormat& format) {
  if (IsUniversalFile(path) || IsArrayFile(path)) return false;
  const LoggerFormat logger = FindLoggerFormat(path);
  if (logger == LoggerFormat::kNone) return true;
  // Who says how the text of an LVM file is laid out wants it read as text.
  const bool is_laid_out = format.header_lines >= 0 || format.delimiter != 0;
  return logger == LoggerFormat::kLvm && is_laid_out;
}

bool ReadTable(const std::string& path, const std::vector<std::string>& wanted,
               const TextFormat& format, Table* table, std::string* error) {
  if (IsUniversalFile(path)) {
    return ReadUniversalTable(path, wanted, table, error);
  }
  if (IsArrayFile(path)) return ReadArrayTable(path, wanted, table, error);
  if (IsTextFile(path, format)) {
    return ReadTextTable(path, wanted, format, table, error);
  }
  return ReadLoggerTable(path, FindLoggerFormat(path), format.encoding, wanted,
                         table, error);
}

}  // namespace pinode
