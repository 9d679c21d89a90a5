// Common part of all signals of a record: the source of a time history, and its
// conversion to model units.

#ifndef PINODE_CASE_SECTIONS_SIGNAL_SECTION_H_
#define PINODE_CASE_SECTIONS_SIGNAL_SECTION_H_

#include <string>

#include "pinode/base/units.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/record/files/text_format.h"

namespace pinode {

// True if the extension, in upper or lower case, is that of a PEER ground
// motion.
bool IsAt2File(const std::string& path);

// Source of a time history, and its conversion to model units: factor * value,
// after the mean is subtracted if `remove_offset`.
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
  // Standard deviation of the noise, model units; not positive: not given.
  double sigma = 0.0;
  // Noise in per cent of the signal's standard deviation; not positive: not
  // given.
  double sigma_percent = 0.0;

  explicit SignalSection(const TomlTable& t) : table(t) {}
};

// True if the file of a signal or record exists; else reports an error at its
// key.
[[nodiscard]] bool FileExists(const TomlTable& table, const std::string& path);

// True if the column is the output voltage of a sensor of unknown sensitivity.
bool IsVoltage(const TomlTable& table);

// Reads `file` (default: `record_file`) and `column`.
[[nodiscard]] bool ReadSource(const std::string& record_file,
                              SignalSection* signal);

// Reads what the table of a record says about the form of its text files.
[[nodiscard]] bool ReadTextFormat(const TomlTable& record, TextFormat* format);

// Reads `unit`, noise and offset of a signal whose dimension, scale and sign
// are set. "model": the unit of the case for that dimension. Without `unit` the
// one that a text file states for the column is used.
[[nodiscard]] bool ReadUnit(const UnitSystem& units, const TomlTable& record,
                            SignalSection* signal);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_SIGNAL_SECTION_H_
