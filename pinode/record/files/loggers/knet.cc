#include "pinode/record/files/loggers/knet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/record/files/loggers/text_lines.h"

namespace pinode {
namespace {

// Delay of the recorder's time stamp, and the distance of Japan from UTC (s).
constexpr int64_t kRecorderDelay = 15;
constexpr int64_t kJapanFromUtc = 9 * 3600;
constexpr int kMostLinesOfKnet = 40;

struct KnetHeader {
  std::string station;
  StartTime start;
  double rate = 0.0;
  double duration = 0.0;
  std::string direction;
  double scale = 0.0;  // gal
};

// Takes the text behind a label at the beginning of a line.
bool TakeLabel(std::string_view line, std::string_view label,
               std::string_view* rest) {
  if (line.substr(0, label.size()) != label) return false;
  *rest = StripBlanks(line.substr(label.size()));
  return true;
}

// Parses the number at the beginning of "100Hz" or "3920(gal)".
bool LeadingNumber(std::string_view text, double* value) {
  size_t end = 0;
  while (end < text.size() &&
         ((text[end] >= '0' && text[end] <= '9') || text[end] == '.')) {
    ++end;
  }
  return ParseDouble(text.substr(0, end), value);
}

bool ParseScale(std::string_view text, double* scale) {
  const size_t slash = text.find('/');
  if (slash == std::string_view::npos) return false;
  double full = 0.0;
  double counts = 0.0;
  if (!LeadingNumber(text.substr(0, slash), &full) ||
      !ParseDouble(text.substr(slash + 1), &counts) || !(counts > 0.0) ||
      !(full > 0.0)) {
    return false;
  }
  *scale = full / counts;
  return std::isfinite(*scale) && *scale > 0.0;
}

bool ParseRecordTime(std::string_view text, StartTime* start) {
  const std::vector<std::string_view> words = WordsOf(text);
  if (words.size() != 2) return false;
  const std::vector<std::string_view> date = Split(words[0], '/');
  std::array<int, 3> numbers = {0, 0, 0};
  if (date.size() != 3) return false;
  for (size_t i = 0; i < 3; ++i) {
    if (!ParseInt(date[i], &numbers[i]) || numbers[i] < 1 ||
        numbers[i] > 9999) {
      return false;
    }
  }
  int64_t of_day = 0;
  if (!ParseTimeOfDay(words[1], &of_day, &start->fraction)) return false;
  start->seconds = SecondsOfDate(numbers[0], numbers[1], numbers[2]) + of_day -
                   kRecorderDelay - kJapanFromUtc;
  start->is_known = true;
  return true;
}

std::string ChannelName(std::string_view direction) {
  static constexpr std::array<const char*, 6> kKikNet = {"NS1", "EW1", "UD1",
                                                         "NS2", "EW2", "UD2"};
  int number = 0;
  if (ParseInt(direction, &number) && number >= 1 && number <= 6) {
    return kKikNet[static_cast<size_t>(number - 1)];
  }
  std::string name(direction);
  name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
  return name;
}

// Takes one line of the header. Returns false if its value is broken.
bool TakeLine(std::string_view line, KnetHeader* header,
              const char** expected) {
  std::string_view rest;
  if (TakeLabel(line, "Station Code", &rest)) {
    header->station = std::string(rest);
  } else if (TakeLabel(line, "Record Time", &rest)) {
    *expected = "a date and a time such as 1996/08/11 03:12:45";
    return ParseRecordTime(rest, &header->start);
  } else if (TakeLabel(line, "Sampling Freq(Hz)", &rest)) {
    *expected = "a rate such as 100Hz";
    return LeadingNumber(rest, &header->rate) && header->rate > 0.0 &&
           std::isfinite(1.0 / header->rate);
  } else if (TakeLabel(line, "Duration Time(s)", &rest)) {
    *expected = "a number of seconds";
    return LeadingNumber(rest, &header->duration);
  } else if (TakeLabel(line, "Dir.", &rest)) {
    *expected = "a direction such as N-S";
    header->direction = ChannelName(rest);
    return !header->direction.empty();
  } else if (TakeLabel(line, "Scale Factor", &rest)) {
    *expected = "a factor such as 3920(gal)/6182761";
    return ParseScale(rest, &header->scale);
  }
  return true;
}

}  // namespace

bool ParseKnet(const std::string& text, const std::string& path,
               const ChannelFilter& wanted, LoggedFile* file,
               std::string* error) {
  TextLines lines(text, path);
  KnetHeader header;
  std::string_view line;
  bool is_ended = false;
  for (int i = 0; i < kMostLinesOfKnet && !is_ended; ++i) {
    if (!lines.Next(&line)) break;
    const char* expected = "";
    if (!TakeLine(line, &header, &expected)) {
      return lines.Fail(Quote(StripBlanks(line)) + ", expected " + expected,
                        error);
    }
    is_ended = line.substr(0, 4) == "Memo";
  }
  if (!is_ended || header.rate == 0.0 || header.scale == 0.0 ||
      header.direction.empty()) {
    return lines.Fail(
        "the header of K-NET is incomplete, expected the lines from 'Origin "
        "Time' to 'Memo.', with rate, direction and scale factor",
        error);
  }
  LoggerChannel channel;
  channel.name = channel.short_name = header.direction;
  channel.unit = "gal";
  channel.step = 1.0 / header.rate;
  const double samples = std::round(header.rate * header.duration);
  if (!(samples >= 2.0 && samples <= static_cast<double>(text.size()))) {
    return lines.Fail("'Duration Time(s)' of " + FormatNumber(header.duration) +
                          " at " + FormatNumber(header.rate) +
                          " Hz, expected as many samples as the file holds",
                      error);
  }
  channel.size = static_cast<Eigen::Index>(samples);
  if (wanted(channel)) {
    if (!ReadNumbers(&lines, channel.size, 0, &channel.values, error)) {
      return false;
    }
    channel.values *= header.scale;
  }
  LoggedFile result;
  result.format = "K-NET";
  result.channels.push_back(std::move(channel));
  if (!header.station.empty()) {
    result.remarks.push_back("station " + header.station);
  }
  SetStartTimes({header.start}, &result);
  *file = std::move(result);
  return true;
}

}  // namespace pinode
