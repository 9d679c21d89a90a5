#include "pinode/record/files/loggers/tdms_daqmx.h"

#include <algorithm>

namespace pinode {
namespace {

// Most bytes of a row: far more than cards have.
constexpr uint32_t kMostBytesOfRow = 1U << 20;
constexpr uint64_t kMostRowsOfChunk = uint64_t{1} << 40;

// Returns the type of a scaler's numbers, which DAQmx counts in its own way.
TdmsType DaqmxType(uint32_t code) {
  constexpr TdmsType kTypes[] = {TdmsType::kUint8,  TdmsType::kInt8,
                                 TdmsType::kUint16, TdmsType::kInt16,
                                 TdmsType::kUint32, TdmsType::kInt32};
  return code < std::size(kTypes) ? kTypes[code] : TdmsType::kVoid;
}

// Rows and width of the buffer of a card.
struct DaqmxBuffer {
  uint64_t rows = 0;
  uint64_t width = 0;
  size_t num_scalers = 0;
};

// Finds the buffers of a chunk, which all channels must see alike.
std::string FindBuffers(const std::vector<const DaqmxIndex*>& indices,
                        std::vector<DaqmxBuffer>* buffers) {
  for (const uint32_t width : indices[0]->widths) {
    buffers->push_back({0, width, 0});
  }
  for (const DaqmxIndex* index : indices) {
    if (index->widths != indices[0]->widths) {
      return "its channels state rows of different widths. The file is broken";
    }
    for (const DaqmxScaler& scaler : index->scalers) {
      DaqmxBuffer* buffer = &(*buffers)[scaler.buffer];
      if (buffer->num_scalers > 0 && buffer->rows != index->count) {
        return "channels of one card state different numbers of rows. The "
               "file is broken";
      }
      buffer->rows = index->count;
      // No more series than bits: they share no bits in a file that is whole.
      if (++buffer->num_scalers > 8 * buffer->width) {
        return "a row holds more channels than bits. The file is broken";
      }
    }
  }
  return "";
}

}  // namespace

std::string ReadDaqmxIndex(bool is_digital, ByteReader* reader,
                           DaqmxIndex* index) {
  reader->Read<uint32_t>();  // type of the channel: DAQmx, or that of a scaler
  const uint32_t dimension = reader->Read<uint32_t>();
  index->count = reader->Read<uint64_t>();
  const uint32_t num_scalers = reader->Read<uint32_t>();
  for (uint32_t i = 0; i < num_scalers && reader->ok(); ++i) {
    DaqmxScaler scaler;
    const uint32_t code = reader->Read<uint32_t>();
    scaler.type = DaqmxType(code);
    scaler.buffer = reader->Read<uint32_t>();
    scaler.offset = reader->Read<uint32_t>();
    if (is_digital) {
      scaler.bit = static_cast<int>(scaler.offset % 8);
      scaler.offset /= 8;
      reader->Read<uint8_t>();  // format of the samples
    } else {
      reader->Read<uint32_t>();
    }
    scaler.scale = reader->Read<uint32_t>();
    if (!reader->ok()) break;
    if (scaler.type == TdmsType::kVoid) {
      return "DAQmx counts of the unknown type " + std::to_string(code) +
             ". Export the file again as text";
    }
    // A line is one bit of a byte, whatever the type of its port.
    if (is_digital) scaler.type = TdmsType::kUint8;
    index->scalers.push_back(scaler);
  }
  const uint32_t num_widths = reader->Read<uint32_t>();
  for (uint32_t i = 0; i < num_widths && reader->ok(); ++i) {
    index->widths.push_back(reader->Read<uint32_t>());
  }
  if (!reader->ok()) return "";  // the caller says it
  if (dimension != 1 || index->count > kMostRowsOfChunk ||
      index->scalers.empty()) {
    return "a raw data index of DAQmx without channels or with several "
           "dimensions. The file is broken";
  }
  for (const uint32_t width : index->widths) {
    if (width > kMostBytesOfRow) {
      return "rows of " + std::to_string(width) +
             " bytes in its DAQmx data. The file is broken";
    }
  }
  for (const DaqmxScaler& scaler : index->scalers) {
    if (scaler.buffer >= index->widths.size() ||
        uint64_t{scaler.offset} + TdmsTypeSize(scaler.type) >
            index->widths[scaler.buffer]) {
      return "DAQmx counts beyond the end of their row. The file is broken";
    }
  }
  return "";
}

std::string PlaceDaqmx(const std::vector<const DaqmxIndex*>& indices,
                       size_t raw_begin, uint64_t raw_size, bool may_end_early,
                       bool is_big_endian, std::vector<DaqmxSeries>* series) {
  std::vector<DaqmxBuffer> buffers;
  const std::string fault = FindBuffers(indices, &buffers);
  if (!fault.empty()) return fault;
  uint64_t chunk = 0;
  for (const DaqmxBuffer& buffer : buffers) {
    const uint64_t bytes = buffer.rows * buffer.width;
    if (bytes > kMostRowsOfChunk * kMostBytesOfRow - chunk) {
      return "more numbers than a file can hold. The file is broken";
    }
    chunk += bytes;
  }
  if (chunk == 0 || raw_size == 0) return "";
  if (raw_size % chunk != 0 && !may_end_early) {
    return std::to_string(raw_size) +
           " bytes of numbers are no multiple of "
           "the " +
           std::to_string(chunk) +
           " that its channels have. The file is broken";
  }
  for (size_t channel = 0; channel < indices.size(); ++channel) {
    for (const DaqmxScaler& scaler : indices[channel]->scalers) {
      DaqmxSeries added;
      added.channel = channel;
      added.scaler = scaler;
      uint64_t before = 0;
      for (uint32_t b = 0; b < scaler.buffer; ++b) {
        before += buffers[b].rows * buffers[b].width;
      }
      const DaqmxBuffer& buffer = buffers[scaler.buffer];
      for (uint64_t at = before; at < raw_size; at += chunk) {
        TdmsRun run;
        run.position = raw_begin + static_cast<size_t>(at) + scaler.offset;
        run.stride = buffer.width;
        run.count = std::min(buffer.rows, (raw_size - at) / buffer.width);
        run.is_big_endian = is_big_endian;
        if (run.count == 0) break;
        added.runs.push_back(run);
      }
      series->push_back(std::move(added));
    }
  }
  return "";
}

}  // namespace pinode
