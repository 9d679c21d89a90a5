#include "pinode/record/files/loggers/tdms_objects.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/record/files/loggers/byte_reader.h"
#include "pinode/record/files/loggers/tdms_daqmx.h"

namespace pinode {
namespace {

// Seconds from 1904-01-01, the zero of the format's times, to 1970-01-01.
constexpr int64_t kSecondsTo1970 = 2082844800;

constexpr uint32_t kHasMetadata = 1U << 1;
constexpr uint32_t kHasNewList = 1U << 2;
constexpr uint32_t kHasRawData = 1U << 3;
constexpr uint32_t kIsInterleaved = 1U << 5;
constexpr uint32_t kIsBigEndian = 1U << 6;
constexpr size_t kLeadInSize = 28;

// Values of the word before an object's raw data index.
constexpr uint32_t kNoRawData = 0xFFFFFFFF;
constexpr uint32_t kSameAsBefore = 0;
constexpr uint32_t kDaqmxScaler = 0x1269;
// The second is what the format's description says, the first what is written.
constexpr uint32_t kDaqmxDigital = 0x126A;
constexpr uint32_t kDaqmxDigitalAsDescribed = 0x1369;

// Places in a file are signed.
constexpr uint64_t kMostBytes = std::numeric_limits<int64_t>::max();

std::string TdmsText(std::string_view bytes) {
  std::string text(bytes);
  if (FirstInvalidUtf8(text) == std::string::npos) return text;
  for (char& c : text) {
    if (static_cast<unsigned char>(c) >= 0x80) c = '?';
  }
  return text;
}

std::string_view ReadTdmsString(ByteReader* reader) {
  const uint32_t size = reader->Read<uint32_t>();
  return reader->Bytes(size);
}

// Splits "/'group'/'it''s a channel'" into its parts. Returns false for
// another form.
bool ParseTdmsPath(std::string_view path, std::vector<std::string>* parts) {
  if (path == "/") return true;
  size_t at = 0;
  while (at < path.size()) {
    if (path.size() - at < 3 || path[at] != '/' || path[at + 1] != '\'') {
      return false;
    }
    std::string part;
    bool is_closed = false;
    for (at += 2; at < path.size(); ++at) {
      if (path[at] != '\'') {
        part += path[at];
      } else if (at + 1 < path.size() && path[at + 1] == '\'') {
        part += path[at++];
      } else {
        is_closed = true;
        ++at;
        break;
      }
    }
    if (!is_closed) return false;
    parts->push_back(TdmsText(part));
  }
  return parts->size() <= 2;
}

// The numbers that an object has in each chunk of a segment.
struct TdmsRawIndex {
  bool is_known = false;
  TdmsType type = TdmsType::kVoid;
  uint64_t count = 0;
  uint64_t bytes = 0;
  bool is_daqmx = false;
  DaqmxIndex daqmx;
};

// An object in the list of a segment.
struct TdmsListed {
  size_t object = 0;
  bool has_data = false;
};

class TdmsStructureReader {
 public:
  TdmsStructureReader(std::string_view bytes, const std::string& path,
                      TdmsStructure* structure, std::string* error)
      : bytes_(bytes), path_(path), structure_(structure), error_(error) {}

  bool Read() {
    size_t position = 0;
    while (position < bytes_.size()) {
      if (!ReadSegment(&position)) return false;
    }
    return !structure_->objects.empty() ||
           Fail("holds no object, expected groups and channels");
  }

 private:
  bool Fail(const std::string& message) {
    *error_ = path_ + ": " + message;
    return false;
  }
  bool FailAt(size_t position, const std::string& message) {
    return Fail("segment at byte " + std::to_string(position) + ": " + message);
  }

  // Reads one segment and moves *position behind it.
  bool ReadSegment(size_t* position) {
    const size_t begin = *position;
    if (bytes_.size() - begin < kLeadInSize) {
      // A program that was stopped leaves part of a lead-in, or zeros.
      if (begin == 0) return Fail("is too short, expected a TDMS file");
      structure_->is_unfinished = true;
      *position = bytes_.size();
      return true;
    }
    if (bytes_.substr(begin, 4) != "TDSm") {
      return FailAt(begin, "does not begin with 'TDSm'. The file is broken");
    }
    const uint32_t flags = NumberAt<uint32_t>(bytes_.data() + begin + 4, false);
    const bool is_big = (flags & kIsBigEndian) != 0;
    ByteReader lead_in(bytes_.substr(begin + 8, kLeadInSize - 8), is_big);
    lead_in.Read<uint32_t>();  // version
    uint64_t next = lead_in.Read<uint64_t>();
    const uint64_t raw = lead_in.Read<uint64_t>();
    const uint64_t left = bytes_.size() - begin - kLeadInSize;
    if (next == std::numeric_limits<uint64_t>::max()) {
      next = left;
      structure_->is_unfinished = true;
    }
    if (next > left) {
      return FailAt(begin, "has " + std::to_string(next) +
                               " bytes, and the file ends after " +
                               std::to_string(left) +
                               ". The file is not whole: copy it again");
    }
    if (raw > next) {
      return FailAt(begin,
                    "its numbers begin after its end. The file is broken");
    }
    if ((flags & kHasMetadata) != 0) {
      ByteReader metadata(
          bytes_.substr(begin + kLeadInSize, static_cast<size_t>(raw)), is_big);
      if ((flags & kHasNewList) != 0) list_.clear();
      if (!ReadMetadata(begin, &metadata)) return false;
    }
    if ((flags & kHasRawData) != 0) {
      if (!PlaceNumbers(begin, begin + kLeadInSize + static_cast<size_t>(raw),
                        next - raw, (flags & kIsInterleaved) != 0, is_big)) {
        return false;
      }
    }
    *position = begin + kLeadInSize + static_cast<size_t>(next);
    return true;
  }

  bool ReadMetadata(size_t begin, ByteReader* reader) {
    const uint32_t count = reader->Read<uint32_t>();
    for (uint32_t i = 0; i < count && reader->ok(); ++i) {
      const std::string_view name = ReadTdmsString(reader);
      size_t object = 0;
      if (!reader->ok()) break;
      if (!FindObject(name, &object)) {
        return FailAt(
            begin,
            "'" + TdmsText(name) +
                "' is not a path of an object, expected /'group'/'channel'");
      }
      if (!ReadIndex(begin, object, reader)) return false;
      if (!ReadProperties(begin, object, reader)) return false;
    }
    return reader->ok() ||
           FailAt(begin, "its metadata are incomplete. The file is broken");
  }

  bool FindObject(std::string_view name, size_t* object) {
    const auto found = by_name_.find(std::string(name));
    if (found != by_name_.end()) {
      *object = found->second;
      return true;
    }
    TdmsObject added;
    if (!ParseTdmsPath(name, &added.path)) return false;
    *object = structure_->objects.size();
    structure_->objects.push_back(std::move(added));
    indices_.emplace_back();
    by_name_.emplace(name, *object);
    return true;
  }

  bool ReadIndex(size_t begin, size_t object, ByteReader* reader) {
    const uint32_t length = reader->Read<uint32_t>();
    TdmsRawIndex* index = &indices_[object];
    const bool is_digital =
        length == kDaqmxDigital || length == kDaqmxDigitalAsDescribed;
    if (length == kDaqmxScaler || is_digital) {
      *index = TdmsRawIndex();
      const std::string fault =
          ReadDaqmxIndex(is_digital, reader, &index->daqmx);
      if (!fault.empty()) return FailAt(begin, fault);
      index->is_daqmx = true;
      index->is_known = true;
    } else if (length != kNoRawData && length != kSameAsBefore) {
      *index = TdmsRawIndex();
      const uint32_t type = reader->Read<uint32_t>();
      const uint32_t dimension = reader->Read<uint32_t>();
      index->type = static_cast<TdmsType>(type);
      index->count = reader->Read<uint64_t>();
      const uint64_t size = TdmsTypeSize(index->type);
      if (index->type == TdmsType::kString) {
        index->bytes = reader->Read<uint64_t>();
      } else if (size == 0) {
        return FailAt(begin, "numbers of the unknown type " +
                                 std::to_string(type) +
                                 ". Export the file again as text");
      } else if (index->count > kMostBytes / size) {
        return FailAt(begin,
                      "more numbers than a file can hold. The file is "
                      "broken");
      } else {
        index->bytes = index->count * size;
      }
      if (dimension != 1 || index->bytes > kMostBytes) {
        return FailAt(begin, "an array of " + std::to_string(dimension) +
                                 " dimensions, expected one");
      }
      index->is_known = true;
    }
    if (length == kSameAsBefore && !index->is_known) {
      return FailAt(begin,
                    "an object refers to an earlier one that does not exist. "
                    "The file is broken");
    }
    const bool has_data = length != kNoRawData;
    const auto listed = places_.find(object);
    if (listed != places_.end() && listed->second < list_.size() &&
        list_[listed->second].object == object) {
      list_[listed->second].has_data = has_data;
    } else {
      places_[object] = list_.size();
      list_.push_back({object, has_data});
    }
    return true;
  }

  bool ReadProperties(size_t begin, size_t object, ByteReader* reader) {
    const uint32_t count = reader->Read<uint32_t>();
    for (uint32_t i = 0; i < count && reader->ok(); ++i) {
      const std::string name = TdmsText(ReadTdmsString(reader));
      const TdmsType type = static_cast<TdmsType>(reader->Read<uint32_t>());
      TdmsProperty property;
      if (type == TdmsType::kString) {
        property.text = TdmsText(ReadTdmsString(reader));
      } else {
        const size_t size = TdmsTypeSize(type);
        const std::string_view bytes = reader->Bytes(size);
        if (reader->ok() && size == 0 && type != TdmsType::kVoid) {
          return FailAt(begin, "property '" + name +
                                   "' of an unknown type. Export the file "
                                   "again as text");
        }
        if (reader->ok() && type == TdmsType::kTimestamp) {
          property.time = TdmsTimeAt(bytes.data(), reader->is_big_endian());
        } else if (reader->ok() && IsTdmsNumber(type)) {
          property.number =
              TdmsNumberAt(type, bytes.data(), reader->is_big_endian());
          property.is_number = true;
        }
      }
      structure_->objects[object].properties[name] = property;
    }
    return true;  // the caller asks the reader
  }

  // Finds the places of the numbers in the chunks of a segment.
  bool PlaceNumbers(size_t begin, size_t raw_begin, uint64_t raw_size,
                    bool is_interleaved, bool is_big) {
    bool has_daqmx = false;
    bool has_others = false;
    uint64_t chunk = 0;
    for (const TdmsListed& listed : list_) {
      if (!listed.has_data) continue;
      const TdmsRawIndex& index = indices_[listed.object];
      (index.is_daqmx ? has_daqmx : has_others) = true;
      if (index.bytes > kMostBytes - chunk) {
        return FailAt(begin,
                      "more numbers than a file can hold. The file is broken");
      }
      chunk += index.bytes;
    }
    if (has_daqmx) {
      if (has_others) {
        return FailAt(begin,
                      "DAQmx counts beside other numbers in one segment. "
                      "Export the file again as text");
      }
      return PlaceCounts(begin, raw_begin, raw_size, is_big);
    }
    if (chunk == 0 || raw_size == 0) return true;
    if (is_interleaved) {
      return PlaceInterleaved(begin, raw_begin, raw_size, is_big);
    }
    const bool is_whole = raw_size % chunk == 0;
    if (!is_whole && !structure_->is_unfinished) {
      return FailAt(begin, std::to_string(raw_size) +
                               " bytes of numbers are not a multiple of the " +
                               std::to_string(chunk) +
                               " that its channels have. The file is broken");
    }
    std::vector<size_t> with_data;
    for (const TdmsListed& listed : list_) {
      if (listed.has_data && indices_[listed.object].bytes > 0) {
        with_data.push_back(listed.object);
      }
    }
    for (uint64_t at = 0; at < raw_size; at += chunk) {
      uint64_t position = at;
      for (const size_t object : with_data) {
        if (position >= raw_size) break;
        const TdmsRawIndex& index = indices_[object];
        TdmsRun run;
        run.position = raw_begin + static_cast<size_t>(position);
        run.stride = TdmsTypeSize(index.type);
        // Texts are counted, not read.
        run.count =
            std::min(index.count,
                     (raw_size - position) / std::max<uint64_t>(run.stride, 1));
        run.is_big_endian = is_big;
        AddNumbers(object, run);
        position += index.bytes;
      }
    }
    return true;
  }

  // Does the same for raw data of DAQmx.
  bool PlaceCounts(size_t begin, size_t raw_begin, uint64_t raw_size,
                   bool is_big) {
    std::vector<size_t> objects;
    std::vector<const DaqmxIndex*> indices;
    for (const TdmsListed& listed : list_) {
      if (!listed.has_data) continue;
      objects.push_back(listed.object);
      indices.push_back(&indices_[listed.object].daqmx);
    }
    std::vector<DaqmxSeries> placed;
    const std::string fault =
        PlaceDaqmx(indices, raw_begin, raw_size, structure_->is_unfinished,
                   is_big, &placed);
    if (!fault.empty()) return FailAt(begin, fault);
    for (const DaqmxSeries& series : placed) {
      TdmsSeries kind;
      kind.scale = series.scaler.scale;
      kind.type = series.scaler.type;
      kind.bit = series.scaler.bit;
      kind.is_daqmx = true;
      for (const TdmsRun& run : series.runs) {
        AddRun(objects[series.channel], kind, run);
      }
    }
    return true;
  }

  bool PlaceInterleaved(size_t begin, size_t raw_begin, uint64_t raw_size,
                        bool is_big) {
    uint64_t row = 0;
    uint64_t per_chunk = 0;
    for (const TdmsListed& listed : list_) {
      if (!listed.has_data) continue;
      const TdmsRawIndex& index = indices_[listed.object];
      if (TdmsTypeSize(index.type) == 0 ||
          (row > 0 && index.count != per_chunk)) {
        return FailAt(begin,
                      "interleaved channels of different lengths, or of text. "
                      "The file is broken");
      }
      per_chunk = index.count;
      row += TdmsTypeSize(index.type);
    }
    if (raw_size % row != 0 && !structure_->is_unfinished) {
      return FailAt(begin, "its numbers end inside a row. The file is broken");
    }
    uint64_t offset = 0;
    for (const TdmsListed& listed : list_) {
      if (!listed.has_data) continue;
      TdmsRun run;
      run.position = raw_begin + static_cast<size_t>(offset);
      run.stride = row;
      run.count = raw_size / row;
      run.is_big_endian = is_big;
      AddNumbers(listed.object, run);
      offset += TdmsTypeSize(indices_[listed.object].type);
    }
    return true;
  }

  void AddNumbers(size_t object, const TdmsRun& run) {
    TdmsSeries kind;
    kind.type = indices_[object].type;
    AddRun(object, kind, run);
  }

  // Appends a run to the series with the scale of `kind`.
  void AddRun(size_t object, const TdmsSeries& kind, const TdmsRun& run) {
    if (run.count == 0) return;
    std::vector<TdmsSeries>* all = &structure_->objects[object].series;
    auto series = std::find_if(
        all->begin(), all->end(),
        [&kind](const TdmsSeries& s) { return s.scale == kind.scale; });
    if (series == all->end()) series = all->insert(series, kind);
    if (series->type != kind.type || series->bit != kind.bit) {
      series->has_several_types = true;
      series->type = kind.type;
    }
    series->count += run.count;
    // Chunks of one channel alone follow each other without a gap.
    if (!series->runs.empty()) {
      TdmsRun* last = &series->runs.back();
      if (run.stride > 0 && last->stride == run.stride &&
          last->is_big_endian == run.is_big_endian &&
          last->position + last->count * last->stride == run.position) {
        last->count += run.count;
        return;
      }
    }
    series->runs.push_back(run);
  }

  const std::string_view bytes_;
  const std::string& path_;
  TdmsStructure* const structure_;
  std::string* const error_;
  std::unordered_map<std::string, size_t> by_name_;
  std::vector<TdmsRawIndex> indices_;  // of all objects, as last stated
  // Objects of the current segment, and their places in it.
  std::vector<TdmsListed> list_;
  std::unordered_map<size_t, size_t> places_;
};

}  // namespace

size_t TdmsTypeSize(TdmsType type) {
  switch (type) {
    case TdmsType::kInt8:
    case TdmsType::kUint8:
    case TdmsType::kBoolean:
      return 1;
    case TdmsType::kInt16:
    case TdmsType::kUint16:
      return 2;
    case TdmsType::kInt32:
    case TdmsType::kUint32:
    case TdmsType::kFloat:
    case TdmsType::kFloatWithUnit:
      return 4;
    case TdmsType::kInt64:
    case TdmsType::kUint64:
    case TdmsType::kDouble:
    case TdmsType::kDoubleWithUnit:
    case TdmsType::kComplexFloat:
      return 8;
    case TdmsType::kExtended:
    case TdmsType::kTimestamp:
    case TdmsType::kComplexDouble:
      return 16;
    default:
      return 0;
  }
}

bool IsTdmsNumber(TdmsType type) {
  const size_t size = TdmsTypeSize(type);
  return size > 0 && size <= 8 && type != TdmsType::kComplexFloat;
}

double TdmsNumberAt(TdmsType type, const char* bytes, bool is_big_endian) {
  switch (type) {
    case TdmsType::kInt8:
      return NumberAt<int8_t>(bytes, is_big_endian);
    case TdmsType::kUint8:
    case TdmsType::kBoolean:
      return NumberAt<uint8_t>(bytes, is_big_endian);
    case TdmsType::kInt16:
      return NumberAt<int16_t>(bytes, is_big_endian);
    case TdmsType::kUint16:
      return NumberAt<uint16_t>(bytes, is_big_endian);
    case TdmsType::kInt32:
      return NumberAt<int32_t>(bytes, is_big_endian);
    case TdmsType::kUint32:
      return NumberAt<uint32_t>(bytes, is_big_endian);
    case TdmsType::kInt64:
      return static_cast<double>(NumberAt<int64_t>(bytes, is_big_endian));
    case TdmsType::kUint64:
      return static_cast<double>(NumberAt<uint64_t>(bytes, is_big_endian));
    case TdmsType::kFloat:
    case TdmsType::kFloatWithUnit:
      return static_cast<double>(NumberAt<float>(bytes, is_big_endian));
    case TdmsType::kDouble:
    case TdmsType::kDoubleWithUnit:
      return NumberAt<double>(bytes, is_big_endian);
    default:
      return std::numeric_limits<double>::quiet_NaN();
  }
}

StartTime TdmsTimeAt(const char* bytes, bool is_big_endian) {
  // Seconds and 2^-64 seconds; the more significant part is last in the order
  // of little endian.
  const char* seconds = is_big_endian ? bytes : bytes + 8;
  const char* fraction = is_big_endian ? bytes + 8 : bytes;
  StartTime time;
  const int64_t count = NumberAt<int64_t>(seconds, is_big_endian);
  // Zero is what programs write without a time. Others are far away from any
  // record only in broken files.
  constexpr int64_t kLatest = int64_t{1} << 40;
  if (count == 0 || count < -kLatest || count > kLatest) return time;
  time.is_known = true;
  time.seconds = count - kSecondsTo1970;
  time.fraction = std::ldexp(
      static_cast<double>(NumberAt<uint64_t>(fraction, is_big_endian)), -64);
  return time;
}

uint64_t TdmsObject::count() const {
  uint64_t count = series.empty() ? 0 : series[0].count;
  for (const TdmsSeries& s : series) count = std::min(count, s.count);
  return count;
}

bool ReadTdmsStructure(std::string_view bytes, const std::string& path,
                       TdmsStructure* structure, std::string* error) {
  return TdmsStructureReader(bytes, path, structure, error).Read();
}

}  // namespace pinode
