#include "pinode/case/sections/signal_section.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <vector>

#include "pinode/case/sections/model_section.h"

namespace pinode {

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
  return table.Fail("file", "the file '" + path +
                                "' does not exist, expected a CSV file with "
                                "a header line, a universal file (.uff, .unv), "
                                "arrays (.mat, .npy, .npz, .h5), or a PEER "
                                ".at2 file");
}

bool IsVoltage(const TomlTable& table) {
  const std::vector<std::string> known = KnownUnits(Dimension::kVoltage);
  const TomlValue* unit = table.Find("unit");
  return unit != nullptr &&
         std::find(known.begin(), known.end(), unit->text) != known.end();
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
      return table.Fail("column",
                        "'column' of an AT2 file, which holds one motion "
                        "only; expected none");
    }
  } else {
    signal->column = table.RequiredString("column");
  }
  return table.errors()->ok();
}

bool ReadUnit(const UnitSystem& units, SignalSection* signal) {
  const TomlTable& table = signal->table;
  const bool at2 = IsAt2File(signal->file);
  if (!at2 &&
      !table.RequireKey(
          "unit", std::string("that of ") + DimensionName(signal->dimension) +
                      ", such as \"" + UnitName(signal->dimension, units) +
                      "\"")) {
    return false;
  }
  signal->unit = table.String("unit", "g");
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
  if (table.Has("sigma") && table.Has("sigma_percent")) {
    return table.Fail("sigma",
                      "'sigma' beside 'sigma_percent', expected one "
                      "of the two");
  }
  signal->sigma = factor * table.NonNegativeNumber("sigma", 0.0);
  signal->sigma_percent = table.NonNegativeNumber("sigma_percent", 0.0);
  signal->remove_offset = table.Boolean("remove_offset", false);
  return table.errors()->ok();
}

}  // namespace pinode
