// What all signals of a record have in common: where a time history comes from,
// and how it becomes one in model units.

#ifndef PINODE_CASE_SECTIONS_SIGNAL_SECTION_H_
#define PINODE_CASE_SECTIONS_SIGNAL_SECTION_H_

#include <string>

#include "pinode/base/units.h"
#include "pinode/case/text/toml_table.h"

namespace pinode {

// By its extension, in any case: a PEER ground motion, not a table.
bool IsAt2File(const std::string& path);

// Where one time history comes from, and how it becomes one in model units:
// factor * value, after the mean is subtracted if `remove_offset`.
struct SignalSection {
  TomlTable table;
  std::string label;   // "ground x", "channel a1": for messages
  std::string file;    // as opened
  std::string column;  // empty for AT2 files
  Dimension dimension = Dimension::kNumber;
  std::string unit = "1";
  int sign = 1;
  double scale = 1.0;
  double factor = 1.0;  // of unit, sign and scale
  bool remove_offset = false;
  // Noise, model units; not positive: not given.
  double sigma = 0.0;
  // Per cent of the standard deviation; not positive: not given.
  double sigma_percent = 0.0;

  explicit SignalSection(const TomlTable& t) : table(t) {}
};

// Whether the file of a signal or record is there; else fails at its key.
[[nodiscard]] bool FileExists(const TomlTable& table, const std::string& path);

// Whether the column is what a sensor of unknown sensitivity gives out.
bool IsVoltage(const TomlTable& table);

// `file` (of the record: `record_file`) and `column`.
[[nodiscard]] bool ReadSource(const std::string& record_file,
                              SignalSection* signal);

// `unit`, which its dimension, scale and sign are known for, noise and offset.
// "model": the unit that the case has for that dimension.
[[nodiscard]] bool ReadUnit(const UnitSystem& units, SignalSection* signal);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_SIGNAL_SECTION_H_
