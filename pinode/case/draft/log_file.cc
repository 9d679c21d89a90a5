#include "pinode/case/draft/log_file.h"

#include <algorithm>
#include <utility>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/base/unit_names.h"
#include "pinode/record/files/text_table.h"
#include "pinode/record/time_column.h"

namespace pinode {
namespace {

// A step from which on the numbers of time are hardly seconds.
constexpr double kLongestStep = 1.0;

bool Contains(const std::vector<std::string>& names, const TextColumn& column) {
  return std::find(names.begin(), names.end(), column.name) != names.end() ||
         std::find(names.begin(), names.end(), column.short_name) !=
             names.end();
}

// Name of a column in a case: without its unit where that is unique.
std::string NameInCase(const TextOutline& outline, size_t index) {
  const TextColumn& column = outline.columns[index];
  const auto is_same = [&](const TextColumn& other) {
    return other.short_name == column.short_name;
  };
  return std::count_if(outline.columns.begin(), outline.columns.end(),
                       is_same) == 1
             ? column.short_name
             : column.name;
}

// True if the time column holds numbers whose unit nobody states.
bool IsTimeUnitAssumed(const TextOutline& outline, const LogOptions& options,
                       const std::string& time, const Table& table) {
  if (!options.time_unit.empty() ||
      table.time_origin.kind != TimeOrigin::Kind::kNone) {
    return false;
  }
  for (const TextColumn& column : outline.columns) {
    if (Contains({time}, column)) return column.unit.empty();
  }
  return false;
}

// Finds the step from the time column of `table`, or from the given rate.
bool FindStep(const TextOutline& outline, const Table& table,
              const LogOptions& options, LogFile* log, TimeGrid* grid,
              DraftQuestion* question, std::string* error) {
  if (options.sampling_rate_hz > 0.0) {
    return TimeGridFromStep(table, 1.0 / options.sampling_rate_hz, grid, error);
  }
  std::string unit = options.time_unit;
  if (unit.empty()) unit = table.time_unit;
  if (unit.empty()) unit = "s";
  log->is_time_unit_assumed =
      IsTimeUnitAssumed(outline, options, log->time_column, table);
  TimeColumnOptions time;
  if (!UnitFactor(unit, Dimension::kTime, UnitSystem(), &time.factor, error)) {
    *error = "--time_unit: " + *error;
    return false;
  }
  if (!FindTimeGrid(table, log->time_column, time, grid, error)) return false;
  if (log->is_time_unit_assumed && grid->step >= kLongestStep) {
    question->flag = "time_unit";
    question->text = log->path + ": the unit of the times in column " +
                     Quote(log->time_column) +
                     " is not stated; as seconds they are " +
                     FormatNumber(grid->step, 4) + " s apart";
    question->example = "ms";
    return false;
  }
  return true;
}

}  // namespace

std::string DraftQuestion::AsError() const {
  return text + ". Give --" + flag + "=" + example;
}

bool LogColumn::FindUnitDimension(Dimension* dimension) const {
  return !unit.empty() && FindDimension(unit, dimension);
}

const LogColumn* LogFile::Find(const std::string& name) const {
  for (const LogColumn& column : columns) {
    if (column.name == name) return &column;
  }
  return nullptr;
}

std::vector<std::string> LogFile::ColumnNames() const {
  std::vector<std::string> names;
  for (const LogColumn& column : columns) names.push_back(column.name);
  return names;
}

bool ReadLogFile(const std::string& path, const LogOptions& options,
                 LogFile* log, DraftQuestion* question, std::string* error) {
  LogFile result;
  result.path = path;
  result.sampling_rate_hz = options.sampling_rate_hz;
  result.time_unit = options.time_unit;
  TextFormat format;
  format.time_column = options.time;
  format.time_unit = options.time_unit;
  TextOutline outline;
  if (!ReadTextOutline(path, format, &outline, error)) return false;
  std::vector<std::string> wanted;
  const bool needs_time = options.sampling_rate_hz == 0.0;
  if (needs_time) {
    if (!options.time.empty()) {
      result.time_column = options.time;
    } else if (outline.time_column >= 0) {
      result.time_column =
          NameInCase(outline, static_cast<size_t>(outline.time_column));
    } else {
      question->flag = "time";
      question->text = path +
                       ": no column is the time by its name or clock times; "
                       "name it, or give --sampling_rate_hz";
      question->example = "COLUMN";
      return false;
    }
    format.time_column = result.time_column;
    wanted.push_back(result.time_column);
  }
  for (size_t i = 0; i < outline.columns.size(); ++i) {
    const TextColumn& column = outline.columns[i];
    if (!outline.is_channel[i] || Contains(options.ignored, column) ||
        Contains({result.time_column}, column)) {
      continue;
    }
    result.columns.push_back({NameInCase(outline, i), column.unit, {}});
    wanted.push_back(column.name);
  }
  if (result.columns.empty()) {
    *error = path +
             ": no column of numbers beside the time, expected the "
             "records of sensors";
    return false;
  }
  Table table;
  TimeGrid grid;
  if (!ReadTextTable(path, wanted, format, &table, error) ||
      !FindStep(outline, table, options, &result, &grid, question, error)) {
    return false;
  }
  if (grid.num_samples() < kFewestLogSamples) {
    *error = path + ": " + std::to_string(grid.num_samples()) +
             " samples, expected " + std::to_string(kFewestLogSamples) +
             " or more";
    return false;
  }
  const size_t first = needs_time ? 1 : 0;
  for (size_t i = 0; i < result.columns.size(); ++i) {
    result.columns[i].samples =
        OnTimeGrid(table, static_cast<int>(i + first), grid);
  }
  result.step = grid.step;
  result.reading = table.reading;
  *log = std::move(result);
  return true;
}

}  // namespace pinode
