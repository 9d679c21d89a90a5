#include "pinode/case/sections/signal_section.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>
#include <vector>

#include "pinode/base/unit_names.h"
#include "pinode/case/sections/model_section.h"
#include "pinode/record/files/array_table.h"
#include "pinode/record/files/loggers/logger_table.h"
#include "pinode/record/files/text_table.h"

namespace pinode {

namespace {

// Returns the unit that a text file or one of a logger states for a column, or
// "".
std::string UnitOfFile(const TomlTable& record, const SignalSection& signal) {
  TextFormat format;
  TextOutline outline;
  std::string error;
  if (signal.file.empty() || signal.column.empty() ||
      record.errors()->data().Has(signal.file)) {
    return "";
  }
  if (!ReadTextFormat(record, &format)) return "";
  if (!IsTextFile(signal.file, format)) {
    const LoggerFormat logger = FindLoggerFormat(signal.file);
    return logger == LoggerFormat::kNone
               ? ""
               : UnitOfLoggerChannel(signal.file, logger, format.encoding,
                                     signal.column);
  }
  if (!ReadTextOutline(signal.file, format, &outline, &error)) {
    return "";
  }
  for (const TextColumn& column : outline.columns) {
    if (column.name == signal.column || column.short_name == signal.column) {
      return column.unit;
    }
  }
  return "";
}

}  // namespace

bool IsAt2File(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension == ".at2";
}

bool FileExists(const TomlTable& table, const std::string& path) {
  std::error_code status;
  if (table.errors()->data().Has(path) ||
      std::filesystem::exists(path, status)) {
    return true;
  }
  return table.Fail(
      "file",
      "the file '" + path +
          "' does not exist. Give text in columns (CSV) or a PEER .at2 file. "
          "A universal file (.uff, .unv), arrays (.mat, .npy, .npz, .h5) or a "
          "file of a logger (.tdms, .lvm, .mseed, .sac, .v2, K-NET) will do "
          "too");
}

bool IsVoltage(const TomlTable& table) {
  const TomlValue* unit = table.Find("unit");
  Dimension dimension = Dimension::kNumber;
  return unit != nullptr &&
         FindDimension(CanonicalUnit(unit->text), &dimension) &&
         dimension == Dimension::kVoltage;
}

bool ReadSource(const std::string& record_file, SignalSection* signal) {
  const TomlTable& table = signal->table;
  signal->file = record_file;
  if (table.Has("file")) {
    signal->file = table.RequiredString("file");
    if (!table.errors()->ok()) return false;
    signal->file = ResolvePath(table, signal->file);
    if (!FileExists(table, signal->file)) return false;
  }
  if (signal->file.empty()) {
    return table.Fail("file",
                      "it has no file, expected 'file' here or in its "
                      "record");
  }
  if (IsAt2File(signal->file)) {
    if (table.Has("column")) {
      return table.Fail(
          "column", "an AT2 file holds a single motion; leave out 'column'");
    }
  } else {
    signal->column = table.RequiredString("column");
  }
  return table.errors()->ok();
}

bool ReadTextFormat(const TomlTable& record, TextFormat* format) {
  format->time_column = record.String("time");
  const int lines = record.Integer("header_lines", -1, 0, 1000000000);
  const std::vector<std::pair<std::string, std::string>> keys = {
      {"time_unit", record.String("time_unit")},
      {"time_format", record.String("time_format")},
      {"encoding", record.String("encoding")},
      {"header_lines", lines < 0 ? "" : std::to_string(lines)},
      {"decimal", record.Choice("decimal", {".", ","}, "")},
      {"delimiter", record.String("delimiter")}};
  if (!record.errors()->ok()) return false;
  std::string key;
  std::string error;
  if (ParseTextFormat(keys, format, &key, &error)) return true;
  return record.Fail(key, "'" + key + "': " + error);
}

bool ReadUnit(const UnitSystem& units, const TomlTable& record,
              SignalSection* signal) {
  const TomlTable& table = signal->table;
  const bool at2 = IsAt2File(signal->file);
  const std::string stated =
      at2 || table.Has("unit") ? "" : UnitOfFile(record, *signal);
  if (!at2 && stated.empty() &&
      !table.RequireKey(
          "unit", std::string("that of ") + DimensionName(signal->dimension) +
                      ", such as \"" + UnitName(signal->dimension, units) +
                      "\"")) {
    return false;
  }
  signal->unit = table.String("unit", stated.empty() ? "g" : stated);
  if (!at2 && signal->unit == "model") {
    signal->unit = UnitName(signal->dimension, units);
  }
  if (at2 && signal->unit != "g") {
    return table.Fail("unit",
                      "unit '" + signal->unit + "' of an AT2 file, expected g");
  }
  double factor = 1.0;
  std::string error;
  if (!UnitFactor(signal->unit, signal->dimension, units, &factor, &error)) {
    return table.Fail("unit", error);
  }
  signal->factor = factor * signal->scale * signal->sign;
  signal->remove_offset = table.Boolean("remove_offset", false);
  // Prescribed motion is taken as exact.
  if (!table.Takes("sigma")) return table.errors()->ok();
  if (table.Has("sigma") && table.Has("sigma_percent")) {
    return table.Fail(
        "sigma",
        "'sigma' and 'sigma_percent' are both given, expected one of them");
  }
  signal->sigma = factor * table.NonNegativeNumber("sigma", 0.0);
  signal->sigma_percent = table.NonNegativeNumber("sigma_percent", 0.0);
  return table.errors()->ok();
}

}  // namespace pinode
