// Raw data of DAQmx in TDMS files: counts of cards as they came.

#ifndef PINODE_RECORD_FILES_LOGGERS_TDMS_DAQMX_H_
#define PINODE_RECORD_FILES_LOGGERS_TDMS_DAQMX_H_

#include <cstdint>
#include <string>
#include <vector>

#include "pinode/record/files/loggers/byte_reader.h"
#include "pinode/record/files/loggers/tdms_objects.h"

namespace pinode {

// Place of a channel's counts in the rows of a buffer.
struct DaqmxScaler {
  TdmsType type = TdmsType::kVoid;
  uint32_t buffer = 0;
  uint32_t offset = 0;  // bytes from the begin of the row
  int bit = -1;         // of the byte there; -1: not a digital line
  uint32_t scale = kTdmsRawSeries;
};

// Raw data index of a channel. A chunk holds a buffer for each card, one after
// the other; a buffer is a table of rows of equal width, in bytes.
struct DaqmxIndex {
  uint64_t count = 0;  // rows of the channel in a chunk
  std::vector<DaqmxScaler> scalers;
  std::vector<uint32_t> widths;
};

// Reads the index behind its first word: format changing scalers (0x1269) or
// digital lines (0x126A). Returns an empty text, or what is wrong.
std::string ReadDaqmxIndex(bool is_digital, ByteReader* reader,
                           DaqmxIndex* index);

// Series of one scaler in a segment.
struct DaqmxSeries {
  size_t channel = 0;  // place in the indices
  DaqmxScaler scaler;
  std::vector<TdmsRun> runs;
};

// Finds the places of the counts in `raw_size` bytes from `raw_begin` on. The
// last chunk may end early if `may_end_early`. Returns an empty text, or what
// is wrong.
std::string PlaceDaqmx(const std::vector<const DaqmxIndex*>& indices,
                       size_t raw_begin, uint64_t raw_size, bool may_end_early,
                       bool is_big_endian, std::vector<DaqmxSeries>* series);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_LOGGERS_TDMS_DAQMX_H_
