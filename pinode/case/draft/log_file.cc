#include "pinode/case/draft/log_file.h"

#include <algorithm>
#include <utility>

#include "pinode/base/arrays/array_files.h"
#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/base/unit_names.h"
#include "pinode/record/files/array_table.h"
#include "pinode/record/files/loggers/logger_table.h"
#include "pinode/record/files/text_table.h"
#include "pinode/record/files/text_time.h"
#include "pinode/record/time_column.h"

namespace pinode {
namespace {

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

void AskForUnit(const std::string& path, const std::string& column, double step,
                DraftQuestion* question) {
  question->flag = "time_unit";
  question->text = path + ": the unit of the times in column " + Quote(column) +
                   " is not stated. Read as seconds they are " +
                   FormatNumber(step, 4) + " s apart";
  question->example = "ms";
}

// Asks for the unit of the times if seconds would be far apart and that is all
// that is wrong with a file.
void AskForUnit(const std::string& path, const std::vector<std::string>& wanted,
                TextFormat format, DraftQuestion* question) {
  format.time_unit = "s";
  Table table;
  TimeGrid grid;
  std::string unused;
  if (!ReadTextTable(path, wanted, format, &table, &unused) ||
      !FindTimeGrid(table, format.time_column, {}, &grid, &unused) ||
      grid.step <= kLongestStepOfSeconds) {
    return;
  }
  AskForUnit(path, format.time_column, grid.step, question);
}

// Finds the step from the time column of `table`, or from the given rate.
bool FindStep(const Table& table, const LogOptions& options, LogFile* log,
              TimeGrid* grid, DraftQuestion* question, std::string* error) {
  if (options.sampling_rate_hz > 0.0) {
    return TimeGridFromStep(table, 1.0 / options.sampling_rate_hz, grid, error);
  }
  std::string unit = options.time_unit;
  if (unit.empty()) unit = table.time_unit;
  if (unit.empty()) unit = "s";
  TimeColumnOptions time;
  if (!UnitFactor(unit, Dimension::kTime, UnitSystem(), &time.factor, error)) {
    *error = "--time_unit: " + *error;
    return false;
  }
  if (!FindTimeGrid(table, log->time_column, time, grid, error)) return false;
  if (log->is_time_unit_assumed && grid->step > kLongestStepOfSeconds) {
    AskForUnit(log->path, log->time_column, grid->step, question);
    return false;
  }
  return true;
}

// Asks for the column of the time.
bool AskForTime(const std::string& path, DraftQuestion* question) {
  question->flag = "time";
  question->text = path +
                   ": no column is recognised as the time; name it with "
                   "--time, or give --sampling_rate_hz";
  question->example = "COLUMN";
  return false;
}

// Takes the samples of the columns, which begin at `first` in the table.
bool TakeSamples(const Table& table, const TimeGrid& grid, size_t first,
                 LogFile* log, std::string* error) {
  if (grid.num_samples() < kFewestLogSamples) {
    *error = log->path + ": " + std::to_string(grid.num_samples()) +
             " samples, expected " + std::to_string(kFewestLogSamples) +
             " or more";
    return false;
  }
  for (size_t i = 0; i < log->columns.size(); ++i) {
    LogColumn& column = log->columns[i];
    column.samples =
        column.scale * OnTimeGrid(table, static_cast<int>(i + first), grid);
  }
  log->step = grid.step;
  log->reading = table.reading;
  return true;
}

// Finds the columns of a file that is no text. An empty list means all.
bool FindBinaryColumns(const std::string& path, const LogOptions& options,
                       std::vector<std::string>* columns, std::string* error) {
  const LoggerFormat format = FindLoggerFormat(path);
  if (format != LoggerFormat::kNone) {
    // The headers alone: channels that are ignored need not be readable.
    LoggedFile file;
    const auto none = [](const LoggerChannel&) { return false; };
    if (!ReadLoggedFile(path, format, options.format.encoding, none, &file,
                        error)) {
      return false;
    }
    *columns = AllLoggerColumns(file);
  } else {
    Table table;
    if (!ReadTable(path, {}, options.format, &table, error)) return false;
    *columns = table.columns;
  }
  const auto is_ignored = [&options](const std::string& name) {
    return std::find(options.ignored.begin(), options.ignored.end(), name) !=
           options.ignored.end();
  };
  columns->erase(std::remove_if(columns->begin(), columns->end(), is_ignored),
                 columns->end());
  return true;
}

std::string ClocksDiffer(const std::string& path, const std::string& time,
                         const std::string& other) {
  return path + ": the times of '" + time + "' and '" + other +
         "' differ, and a column may belong to either. Leave out one of them "
         "and its columns, by --ignore=" +
         other + ",COLUMN,...";
}

// Makes the clock that is not ignored the time. Fails if there are two.
bool ChooseClock(const LogOptions& options, const std::string& path,
                 TextOutline* outline, std::string* error) {
  if (outline->other_clocks.empty()) return true;
  std::vector<int> clocks = outline->other_clocks;
  clocks.insert(clocks.begin(), outline->time_column);
  const auto column = [outline](int place) -> const TextColumn& {
    return outline->columns[static_cast<size_t>(place)];
  };
  clocks.erase(std::remove_if(clocks.begin(), clocks.end(),
                              [&](int place) {
                                return Contains(options.ignored, column(place));
                              }),
               clocks.end());
  if (clocks.size() > 1) {
    *error = ClocksDiffer(path, column(clocks[0]).name, column(clocks[1]).name);
    return false;
  }
  if (!clocks.empty()) outline->time_column = clocks[0];
  return true;
}

// Finds the times of a file that is no text, which are no channels: erases them
// from the columns.
bool FindBinaryTimes(const LogOptions& options, LogFile* log,
                     std::vector<std::string>* columns, std::string* error) {
  const bool is_array = IsArrayFile(log->path);
  std::vector<std::string> named;
  // Reading it says what is wrong with a name that is none of a column.
  if (!options.time.empty()) named.push_back(options.time);
  for (const std::string& name : *columns) {
    if (name != options.time && IsTimeOfArrays(name)) named.push_back(name);
  }
  if (named.empty()) return true;
  // Other files than those of arrays have their own time, "t".
  ArrayTimes times;
  if (is_array || named != std::vector<std::string>{"t"}) {
    Table table;
    if (!ReadTable(log->path, named, options.format, &table, error)) {
      return false;
    }
    times = FindArrayTimes(table, options.time);
  } else {
    times.time = "t";
  }
  if (is_array && !times.other_clock.empty()) {
    *error = ClocksDiffer(log->path, times.time, times.other_clock);
    return false;
  }
  log->unused_times = times.others;
  const auto erase = [columns](const std::string& name) {
    columns->erase(std::remove(columns->begin(), columns->end(), name),
                   columns->end());
  };
  erase(times.time);
  for (const std::string& other : times.others) erase(other);
  if (options.sampling_rate_hz == 0.0) {
    log->time_column = times.time;
  } else if (!times.time.empty() && (is_array || times.time != "t")) {
    log->unused_times.insert(log->unused_times.begin(), times.time);
  }
  return true;
}

// Reads a file that is no text: of a logger, universal or of arrays.
bool ReadBinaryLog(const LogOptions& options, LogFile* log,
                   DraftQuestion* question, std::string* error) {
  std::vector<std::string> columns;
  if (!FindBinaryColumns(log->path, options, &columns, error)) return false;
  const bool needs_time = options.sampling_rate_hz == 0.0;
  if (!FindBinaryTimes(options, log, &columns, error)) return false;
  if (needs_time && log->time_column.empty()) {
    return AskForTime(log->path, question);
  }
  if (columns.empty()) {
    *error = log->path +
             ": there is no column of numbers except the time, expected "
             "records of sensors";
    return false;
  }
  if (needs_time) columns.insert(columns.begin(), log->time_column);
  Table table;
  TimeGrid grid;
  if (!ReadTable(log->path, columns, options.format, &table, error))
    return false;
  log->is_time_unit_assumed =
      needs_time && options.time_unit.empty() && table.time_unit.empty();
  if (!FindStep(table, options, log, &grid, question, error)) return false;
  const size_t first = needs_time ? 1 : 0;
  for (size_t i = first; i < table.columns.size(); ++i) {
    const std::string& name = table.columns[i];
    log->columns.push_back({name,
                            i < table.units.size() ? table.units[i] : "",
                            {},
                            options.scales.FactorOf(name),
                            name});
  }
  return TakeSamples(table, grid, first, log, error);
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
  if (!IsTextFile(path, options.format)) {
    if (!ReadBinaryLog(options, &result, question, error)) return false;
    *log = std::move(result);
    return true;
  }
  TextFormat format = options.format;
  format.time_column = options.time;
  format.time_unit = options.time_unit;
  TextOutline outline;
  if (!ReadTextOutline(path, format, &outline, error)) return false;
  if (!ChooseClock(options, path, &outline, error)) return false;
  std::vector<std::string> wanted;
  const bool needs_time = options.sampling_rate_hz == 0.0;
  if (needs_time) {
    if (!options.time.empty()) {
      result.time_column = options.time;
    } else if (outline.time_column >= 0) {
      result.time_column =
          NameInCase(outline, static_cast<size_t>(outline.time_column));
    } else {
      return AskForTime(path, question);
    }
    format.time_column = result.time_column;
    wanted.push_back(result.time_column);
  }
  result.unused_times = outline.UnusedTimes(result.time_column);
  for (size_t i = 0; i < outline.columns.size(); ++i) {
    const TextColumn& column = outline.columns[i];
    if (!outline.is_channel[i] || Contains(options.ignored, column) ||
        Contains({result.time_column}, column)) {
      continue;
    }
    result.columns.push_back(
        {NameInCase(outline, i),
         column.unit,
         {},
         options.scales.FactorOf(column.name, column.short_name),
         column.name});
    wanted.push_back(column.name);
  }
  if (result.columns.empty()) {
    *error = path +
             ": there is no column of numbers except the time, expected "
             "records of sensors";
    return false;
  }
  Table table;
  TimeGrid grid;
  if (!ReadTextTable(path, wanted, format, &table, error)) {
    // Large steps without a unit are refused there, and asked about here.
    if (needs_time && options.time_unit.empty()) {
      AskForUnit(path, wanted, format, question);
    }
    if (!question->flag.empty()) error->clear();
    return false;
  }
  result.is_time_unit_assumed =
      needs_time &&
      IsTimeUnitAssumed(outline, options, result.time_column, table);
  if (!FindStep(table, options, &result, &grid, question, error) ||
      !TakeSamples(table, grid, needs_time ? 1 : 0, &result, error)) {
    return false;
  }
  *log = std::move(result);
  return true;
}

}  // namespace pinode
