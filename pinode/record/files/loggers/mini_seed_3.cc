#include "pinode/record/files/loggers/mini_seed_3.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pinode/record/files/loggers/byte_reader.h"
#include "pinode/record/files/loggers/seed_records.h"

namespace pinode {
namespace {

// Bytes of the fixed header, and place of the checksum in it.
constexpr size_t kHeaderSize = 40;
constexpr size_t kChecksumPlace = 28;

// Encodings of the samples, as the format counts them.
enum SeedEncoding : uint8_t {
  kSeedInt16 = 1,
  kSeedInt32 = 3,
  kSeedFloat = 4,
  kSeedDouble = 5,
  kSteim1 = 10,
  kSteim2 = 11,
};

// A fuzzer does not find the sums of what it makes.
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
constexpr bool kChecksSums = false;
#else
constexpr bool kChecksSums = true;
#endif

// Returns CRC-32C (Castagnoli) of a record, whose own checksum counts as zero.
uint32_t ChecksumOf(std::string_view record) {
  static const std::array<uint32_t, 256> table = [] {
    std::array<uint32_t, 256> t{};
    for (uint32_t i = 0; i < t.size(); ++i) {
      uint32_t value = i;
      for (int bit = 0; bit < 8; ++bit) {
        value = (value >> 1) ^ ((value & 1U) != 0 ? 0x82F63B78U : 0U);
      }
      t[i] = value;
    }
    return t;
  }();
  uint32_t sum = 0xFFFFFFFFU;
  for (size_t i = 0; i < record.size(); ++i) {
    const bool is_own = i >= kChecksumPlace && i < kChecksumPlace + 4;
    const auto byte = is_own ? 0U : static_cast<unsigned char>(record[i]);
    sum = (sum >> 8) ^ table[(sum ^ byte) & 0xFFU];
  }
  return ~sum;
}

// Header of a record, and its parts.
struct Seed3Record {
  size_t length = 0;
  int64_t seconds = 0;  // since 1970
  int64_t nanosecond = 0;
  double rate = 0.0;
  int encoding = 0;
  int64_t count = 0;
  uint32_t checksum = 0;
  std::string name;
  std::string_view data;
};

// Turns "FDSN:XX_STA_00_H_N_Z" into "XX.STA.00.HNZ".
std::string NameOfSource(std::string_view identifier) {
  std::string name(identifier);
  for (char& c : name) {
    if (c < ' ' || c > '~') c = '?';
  }
  constexpr std::string_view kScheme = "FDSN:";
  if (name.compare(0, kScheme.size(), kScheme) != 0 ||
      std::count(name.begin(), name.end(), '_') != 5) {
    return name;
  }
  std::string result;
  int part = 0;
  for (const char c : name.substr(kScheme.size())) {
    if (c != '_') {
      result += c;
    } else if (part++ < 3) {
      result += '.';
    }
  }
  return result;
}

// Reads a record at the beginning of `bytes`. Returns what is wrong.
std::string ReadRecord(std::string_view bytes, Seed3Record* record) {
  if (!IsMiniSeed3(bytes)) {
    return "it does not begin with 'MS' and 3, expected records of miniSEED 3 "
           "only. Copy the file again, or split it there";
  }
  if (bytes.size() < kHeaderSize) {
    return "the file ends inside it. Copy the file again";
  }
  ByteReader reader(bytes);
  reader.Bytes(4);  // "MS", version, flags
  const auto nanosecond = reader.Read<uint32_t>();
  const auto year = reader.Read<uint16_t>();
  const auto day = reader.Read<uint16_t>();
  const auto hour = reader.Read<uint8_t>();
  const auto minute = reader.Read<uint8_t>();
  const auto second = reader.Read<uint8_t>();
  record->encoding = reader.Read<uint8_t>();
  record->rate = reader.Read<double>();
  // A negative number is the step in seconds.
  if (record->rate < 0.0) record->rate = -1.0 / record->rate;
  record->count = reader.Read<uint32_t>();
  record->checksum = reader.Read<uint32_t>();
  reader.Read<uint8_t>();  // version of the publication
  const auto name_size = reader.Read<uint8_t>();
  const auto extra_size = reader.Read<uint16_t>();
  const auto data_size = reader.Read<uint32_t>();
  record->name = NameOfSource(reader.Bytes(name_size));
  reader.Bytes(extra_size);
  record->data = reader.Bytes(data_size);
  if (!reader.ok()) return "the file ends inside it. Copy the file again";
  record->length = reader.position();
  if (kChecksSums &&
      ChecksumOf(bytes.substr(0, record->length)) != record->checksum) {
    return "its checksum is wrong. Copy the file again";
  }
  if (day < 1 || day > 366 || hour > 23 || minute > 59 || second > 60 ||
      nanosecond >= kSeedTicks) {
    return "its start is no time. The file is broken";
  }
  record->seconds =
      SecondsOfDate(year, 1, day) + hour * 3600 + minute * 60 + second;
  record->nanosecond = nanosecond;
  return "";
}

// Reads numbers of one type that stand one behind the other.
template <typename T>
std::string ReadUnpacked(const Seed3Record& record,
                         std::vector<double>* values) {
  if (static_cast<uint64_t>(record.count) * sizeof(T) > record.data.size()) {
    return "it is too short for its " + std::to_string(record.count) +
           " samples. The file is broken";
  }
  for (size_t i = 0; i < static_cast<size_t>(record.count); ++i) {
    const auto value = static_cast<double>(
        NumberAt<T>(record.data.data() + i * sizeof(T), false));
    values->push_back(std::isfinite(value) ? value : std::nan(""));
  }
  return "";
}

std::string ReadSamples(const Seed3Record& record,
                        std::vector<double>* values) {
  switch (record.encoding) {
    case kSeedInt16:
      return ReadUnpacked<int16_t>(record, values);
    case kSeedInt32:
      return ReadUnpacked<int32_t>(record, values);
    case kSeedFloat:
      return ReadUnpacked<float>(record, values);
    case kSeedDouble:
      return ReadUnpacked<double>(record, values);
    default:
      return UnpackSteim(record.data, record.encoding == kSteim1 ? 1 : 2,
                         record.count, values);
  }
}

bool IsKnown(int encoding) {
  for (const int known :
       {kSeedInt16, kSeedInt32, kSeedFloat, kSeedDouble, kSteim1, kSteim2}) {
    if (encoding == known) return true;
  }
  return false;
}

// Number of differences in a word and their bits, by its two bits in the
// control word and its own two upper bits. No differences: none.
struct SteimForm {
  int count = 0;
  int bits = 0;
};

SteimForm FormOf(int version, uint32_t nibble, uint32_t word) {
  const uint32_t own = word >> 30;
  if (nibble == 1) return {4, 8};
  if (version == 1) {
    if (nibble == 2) return {2, 16};
    return nibble == 3 ? SteimForm{1, 32} : SteimForm{};
  }
  constexpr SteimForm kTwo[] = {{0, 0}, {1, 30}, {2, 15}, {3, 10}};
  constexpr SteimForm kThree[] = {{5, 6}, {6, 5}, {7, 4}, {0, 0}};
  if (nibble == 2) return kTwo[own];
  return nibble == 3 ? kThree[own] : SteimForm{};
}

}  // namespace

bool IsMiniSeed3(std::string_view begin) {
  return begin.substr(0, 3) == "MS\x03";
}

std::string UnpackSteim(std::string_view frames, int version, int64_t count,
                        std::vector<double>* values) {
  constexpr size_t kFrame = 64;
  constexpr size_t kWords = 16;
  const auto word_at = [&frames](size_t frame, size_t word) {
    return NumberAt<uint32_t>(frames.data() + frame * kFrame + 4 * word, true);
  };
  if (count == 0) return "";
  const std::string too_short = "it is too short for its " +
                                std::to_string(count) +
                                " samples. The file is broken";
  if (frames.size() < kFrame) return too_short;
  // Sums wrap around at 32 bits, as those of the recorder did.
  uint32_t sample = word_at(0, 1);
  const uint32_t last = word_at(0, 2);
  int64_t done = 0;
  for (size_t frame = 0; (frame + 1) * kFrame <= frames.size(); ++frame) {
    const uint32_t control = word_at(frame, 0);
    for (size_t w = frame == 0 ? 3 : 1; w < kWords && done < count; ++w) {
      const uint32_t nibble = (control >> (2 * (kWords - 1 - w))) & 3U;
      if (nibble == 0) continue;
      const uint32_t word = word_at(frame, w);
      const SteimForm form = FormOf(version, nibble, word);
      if (form.count == 0) return "its packed samples are broken";
      for (int i = form.count - 1; i >= 0 && done < count; --i) {
        uint32_t difference = word >> (form.bits * i);
        if (form.bits < 32) {
          const uint32_t sign = uint32_t{1} << (form.bits - 1);
          difference &= (sign << 1) - 1;
          difference = (difference ^ sign) - sign;
        }
        // The first difference is to the record before.
        if (done > 0) sample += difference;
        values->push_back(static_cast<double>(static_cast<int32_t>(sample)));
        ++done;
      }
    }
  }
  if (done < count) return too_short;
  return sample == last ? "" : "its last sample is not the one that it states";
}

bool ParseMiniSeed3(const std::string& bytes, const std::string& path,
                    const ChannelFilter& wanted, LoggedFile* file,
                    std::string* error) {
  const std::string_view view = bytes;
  SeedRecords records(path);
  size_t position = 0;
  const auto fail = [&](const std::string& what) {
    *error =
        path + ": record at byte " + std::to_string(position) + ": " + what;
    return false;
  };
  while (position < view.size()) {
    Seed3Record record;
    std::string fault = ReadRecord(view.substr(position), &record);
    if (!fault.empty()) return fail(fault);
    SeedSource* source = records.Source(record.name, record.rate);
    if (source->fault.empty() && record.count > 0 &&
        !IsKnown(record.encoding)) {
      source->fault = "it holds text or an unknown encoding, expected numbers";
    }
    if (source->fault.empty() && record.count > 0) {
      fault = SeedRecords::Add(source, record.rate, record.seconds,
                               record.nanosecond, record.count);
      if (!fault.empty()) return fail(fault);
      if (wanted(source->Outline())) {
        fault = ReadSamples(record, &source->pieces.back().values);
        if (!fault.empty()) return fail(fault);
      }
    }
    position += record.length;
  }
  return records.MakeFile(wanted, file, error);
}

}  // namespace pinode
