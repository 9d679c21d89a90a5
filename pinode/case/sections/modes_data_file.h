// A single data file read as a case for pinode_modes.

#ifndef PINODE_CASE_SECTIONS_MODES_DATA_FILE_H_
#define PINODE_CASE_SECTIONS_MODES_DATA_FILE_H_

#include <string>
#include <vector>

#include "pinode/case/sections/modes_section.h"
#include "pinode/record/column_scales.h"
#include "pinode/record/files/text_format.h"

namespace pinode {

// A data file that replaces a case.
struct ModesDataFile {
  std::string path;
  // Names of the channels; "all" alone: every column but the time.
  std::vector<std::string> columns;
  // Quantities of the channels: displacement, velocity, acceleration or strain;
  // one for all, or one for each. Default: acceleration.
  std::vector<std::string> quantities;
  // Column of the time. Default, without a sampling rate: "t" or "time", in
  // seconds.
  std::string time_column;
  double sampling_rate_hz = 0.0;
  // Form of a text file and unit of its times; what is not set is found.
  TextFormat format;
  // Factors of the channels.
  ColumnScales scales;
};

// Reads that file as a case whose channels are places. On failure *error is one
// line and *c is untouched.
[[nodiscard]] bool ReadModesDataFile(const ModesDataFile& file, ModesCase* c,
                                     std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_MODES_DATA_FILE_H_
