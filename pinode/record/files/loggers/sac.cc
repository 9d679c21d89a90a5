#include "pinode/record/files/loggers/sac.h"

#include <cmath>
#include <cstdint>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/record/files/loggers/byte_reader.h"

namespace pinode {
namespace {

constexpr size_t kSacHeaderSize = 632;
constexpr size_t kSacNumber = 4;
// Places in the header: 70 floats, 40 integers, texts.
constexpr size_t kSacDelta = 0;
constexpr size_t kSacBegin = 5;
constexpr size_t kSacYear = 70;  // and day of the year, hour, ..., millisecond
constexpr size_t kSacVersion = 76;
constexpr size_t kSacCount = 79;
constexpr size_t kSacFileType = 85;
constexpr size_t kSacIsEven = 105;
constexpr size_t kSacComponent = 600;  // in bytes
constexpr size_t kSacTextSize = 8;
constexpr int32_t kSacUndefined = -12345;
constexpr int32_t kSacTimeSeries = 1;

class SacHeader {
 public:
  SacHeader(std::string_view bytes, bool is_big)
      : bytes_(bytes), is_big_(is_big) {}

  double Float(size_t place) const {
    return static_cast<double>(
        NumberAt<float>(bytes_.data() + kSacNumber * place, is_big_));
  }
  int32_t Integer(size_t place) const {
    return NumberAt<int32_t>(bytes_.data() + kSacNumber * place, is_big_);
  }
  // Returns a text without what fills it up.
  std::string Text(size_t position) const {
    std::string_view text = bytes_.substr(position, kSacTextSize);
    text = StripBlanks(text.substr(0, text.find('\0')));
    std::string result(text.substr(0, 6) == "-12345" ? "" : text);
    return FirstInvalidUtf8(result) == std::string::npos ? result : "";
  }
  StartTime Start() const {
    StartTime start;
    for (size_t i = 0; i < 6; ++i) {
      const int32_t value = Integer(kSacYear + i);
      if (value == kSacUndefined || value < 0 || value > 9999) return start;
    }
    const int64_t milliseconds = Integer(kSacYear + 5);
    start.seconds = SecondsOfDate(Integer(kSacYear), 1, 1) +
                    (Integer(kSacYear + 1) - 1) * int64_t{86400} +
                    Integer(kSacYear + 2) * int64_t{3600} +
                    Integer(kSacYear + 3) * int64_t{60} +
                    Integer(kSacYear + 4) + milliseconds / 1000;
    start.fraction = 1e-3 * static_cast<double>(milliseconds % 1000);
    start.is_known = true;
    return start;
  }

 private:
  std::string_view bytes_;
  bool is_big_;
};

// Finds the byte order from the version, which is small.
bool FindSacOrder(std::string_view begin, bool* is_big) {
  if (begin.size() < kSacNumber * (kSacCount + 1)) return false;
  for (const bool big : {false, true}) {
    const SacHeader header(begin, big);
    const int32_t version = header.Integer(kSacVersion);
    if ((version == 6 || version == 7) && header.Integer(kSacCount) > 0 &&
        (header.Float(kSacDelta) > 0.0 || version == 7)) {
      *is_big = big;
      return true;
    }
  }
  return false;
}

}  // namespace

bool IsSacHeader(std::string_view begin) {
  bool is_big = false;
  return FindSacOrder(begin, &is_big);
}

bool ParseSac(const std::string& bytes, const std::string& path,
              const ChannelFilter& wanted, LoggedFile* file,
              std::string* error) {
  const auto fail = [&](const std::string& message) {
    *error = path + ": " + message;
    return false;
  };
  bool is_big = false;
  if (bytes.size() < kSacHeaderSize || !FindSacOrder(bytes, &is_big)) {
    return fail(
        "has no header of SAC, expected 632 bytes of version 6 or 7 with a "
        "number of points and a step");
  }
  const SacHeader header(bytes, is_big);
  if (header.Integer(kSacFileType) != kSacTimeSeries ||
      header.Integer(kSacIsEven) != 1) {
    return fail(
        "is not an evenly spaced time series (IFTYPE and LEVEN). In SAC use "
        "'interpolate', or 'ifft' for a spectrum, then 'write'");
  }
  LoggerChannel channel;
  channel.size = header.Integer(kSacCount);
  const size_t data_size = kSacNumber * static_cast<size_t>(channel.size);
  if (bytes.size() - kSacHeaderSize < data_size) {
    return fail("ends after " +
                std::to_string((bytes.size() - kSacHeaderSize) / kSacNumber) +
                " of " + std::to_string(channel.size) +
                " points. The file is not whole: copy it again");
  }
  // Rounded: 0.01 as a float is 0.00999999978.
  double begin = header.Float(kSacBegin);
  if (!ParseDouble(FormatNumber(header.Float(kSacDelta), 7), &channel.step)) {
    channel.step = 0.0;
  }
  const size_t footer = kSacHeaderSize + data_size;
  if (header.Integer(kSacVersion) == 7 && bytes.size() >= footer + 16) {
    channel.step = NumberAt<double>(bytes.data() + footer, is_big);
    begin = NumberAt<double>(bytes.data() + footer + 8, is_big);
  }
  if (!(channel.step > 0.0) || !std::isfinite(channel.step) ||
      !std::isfinite(1.0 / channel.step)) {
    return fail("its step (DELTA) is not positive");
  }
  if (std::isfinite(begin) && begin != kSacUndefined) channel.start = begin;
  channel.name = header.Text(kSacComponent);
  if (channel.name.empty()) channel.name = "data";
  channel.short_name = channel.name;
  if (wanted(channel)) {
    channel.values.resize(channel.size);
    for (Eigen::Index i = 0; i < channel.size; ++i) {
      const double value = static_cast<double>(NumberAt<float>(
          bytes.data() + kSacHeaderSize + kSacNumber * static_cast<size_t>(i),
          is_big));
      channel.values[i] = std::isfinite(value) ? value : std::nan("");
    }
  }
  LoggedFile result;
  result.format = "SAC";
  result.remarks.emplace_back("SAC states no unit");
  result.channels.push_back(std::move(channel));
  SetStartTimes({header.Start()}, &result);
  *file = std::move(result);
  return true;
}

}  // namespace pinode
