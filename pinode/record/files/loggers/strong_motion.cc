#include "pinode/record/files/loggers/strong_motion.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/record/files/loggers/text_lines.h"

namespace pinode {
namespace {

// Value of a number in COSMOS' headers that is not known.
constexpr double kUnknown = -999.0;
// Place of the sampling interval (ms) in COSMOS' real header, from 0.
constexpr Eigen::Index kIntervalPlace = 61;
constexpr int64_t kMostHeaderNumbers = 10000;

// MotionQuantity of a section, as its line names it, and the ending of its
// column.
struct MotionQuantity {
  const char* word;
  const char* ending;
};
constexpr std::array<MotionQuantity, 3> kQuantities = {
    {{"accel", "_acc"}, {"veloc", "_vel"}, {"displ", "_disp"}}};

// The line above the numbers of a section.
struct MotionSection {
  int64_t count = 0;
  const MotionQuantity* quantity = nullptr;
  double step = 0.0;  // 0: in the real header
  std::string unit;
  int width = 0;  // of a number; 0: numbers between blanks
};

bool HasText(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

// Parses the whole number at the beginning of a line.
bool LeadingCount(std::string_view line, int64_t* count) {
  const std::vector<std::string_view> words = WordsOf(line);
  return !words.empty() && ParseInt(words[0], count);
}

// Returns the text from behind `mark` to the first of `ends`.
std::string TextBehind(std::string_view line, std::string_view mark,
                       std::string_view ends) {
  const size_t at = line.find(mark);
  if (at == std::string_view::npos) return "";
  line = line.substr(at + mark.size());
  return std::string(StripBlanks(line.substr(0, line.find_first_of(ends))));
}

// Finds the quantity whose word stands behind `mark`.
const MotionQuantity* QuantityBehind(std::string_view line,
                                     std::string_view mark) {
  for (const MotionQuantity& quantity : kQuantities) {
    if (HasText(line, std::string(mark) + quantity.word)) return &quantity;
  }
  return nullptr;
}

// Parses "12000 points of accel data equally spaced at .005 sec, in cm/sec2.",
// "12000 Accelerogram points at 200 pts/sec in units of g." or "12091
// acceleration pts, approx 120 secs, units=cm/s^2". False for other lines.
bool ParseSection(std::string_view original, MotionSection* section) {
  const std::string line = LowerCase(original);
  if (!LeadingCount(line, &section->count)) return false;
  if (HasText(line, "points of ")) {
    section->quantity = QuantityBehind(line, "points of ");
    const std::string step = TextBehind(line, "spaced at", "s");
    if (section->quantity == nullptr || !ParseDouble(step, &section->step)) {
      return false;
    }
    section->unit = TextBehind(original, ", in ", "( ");
    while (!section->unit.empty() && section->unit.back() == '.') {
      section->unit.pop_back();
    }
  } else if (HasText(line, "accelerogram points at")) {
    section->quantity = &kQuantities[0];
    double rate = 0.0;
    if (!ParseDouble(TextBehind(line, "points at", "p"), &rate) ||
        !(rate > 0.0)) {
      return false;
    }
    section->step = 1.0 / rate;
    const std::vector<std::string_view> unit = WordsOf(
        original.substr(std::min(original.size(), line.find("in units of"))));
    // "in units of g." or "in units of g ."
    if (unit.size() > 3) {
      section->unit = std::string(unit[3].substr(0, unit[3].find('.')));
    }
  } else if (HasText(line, " pts")) {
    section->quantity = QuantityBehind(line.substr(0, line.find(" pts")), "");
    if (section->quantity == nullptr) return false;
    const size_t units = line.find("units=");
    if (units != std::string::npos) {
      section->unit = TextBehind(original.substr(units), "=", ",( ");
    }
  } else {
    return false;
  }
  const size_t format = line.rfind('(');
  if (format != std::string::npos) {
    section->width = FortranWidth(std::string_view(line).substr(format));
  }
  return true;
}

// Returns the zone's distance from UTC in seconds. False for an unknown one.
bool ZoneFromUtc(std::string_view zone, int64_t* seconds) {
  constexpr int64_t kHour = 3600;
  const std::string name = LowerCase(zone.substr(0, 3));
  *seconds = name == "pst" ? -8 * kHour : name == "pdt" ? -7 * kHour : 0;
  return name == "utc" || name == "gmt" || *seconds != 0;
}

// Parses "2/13/12, 21:06:45.0 UTC (GPS)": month, day, year.
StartTime ParseStart(std::string_view text) {
  StartTime start;
  std::string plain(text);
  for (char& c : plain) {
    if (c == ',') c = ' ';
  }
  const std::vector<std::string_view> words = WordsOf(plain);
  if (words.size() < 3) return start;
  const std::vector<std::string_view> date = Split(words[0], '/');
  std::array<int, 3> numbers = {0, 0, 0};
  if (date.size() != 3) return start;
  for (size_t i = 0; i < 3; ++i) {
    if (!ParseInt(date[i], &numbers[i])) return start;
  }
  int year = numbers[2];
  // The first strong motion was recorded in 1933.
  if (year < 100) year += year < 33 ? 2000 : 1900;
  int64_t of_day = 0;
  int64_t zone = 0;
  if (numbers[0] < 1 || numbers[0] > 12 || numbers[1] < 1 || numbers[1] > 31 ||
      year < 1900 || year > 9999 ||
      !ParseTimeOfDay(words[1], &of_day, &start.fraction) ||
      !ZoneFromUtc(words[2], &zone)) {
    return start;
  }
  start.seconds = SecondsOfDate(year, numbers[0], numbers[1]) + of_day - zone;
  start.is_known = true;
  return start;
}

// A file section by section.
class StrongMotionParser {
 public:
  StrongMotionParser(const std::string& text, const std::string& path,
                     const ChannelFilter& wanted)
      : lines_(text, path), path_(path), wanted_(wanted) {}

  bool Parse(LoggedFile* file, std::string* error) {
    std::string_view line;
    while (lines_.Next(&line)) {
      const std::string lower = LowerCase(line);
      MotionSection section;
      if (ParseSection(line, &section)) {
        if (!TakeSection(section, error)) return false;
      } else if (HasText(lower, "real-header values follow")) {
        if (!TakeRealHeader(lower, error)) return false;
      } else {
        TakeHeader(line, lower);
      }
    }
    if (file_.channels.empty() && is_of_film_) {
      *error = path_ +
               ": is Volume 1 of a film recorder, with values at uneven "
               "times, which is not read. Ask the data centre for Volume 2";
      return false;
    }
    if (file_.channels.empty()) {
      *error = path_ +
               ": no line such as '12000 points of accel data equally spaced "
               "at .005 sec' or '12000 acceleration pts' found. Give Volume 1 "
               "or 2 of CSMIP, or COSMOS 1.20; data centres have them";
      return false;
    }
    file_.format = is_cosmos_ ? "COSMOS" : "CSMIP";
    MakeNamesUnique(&file_);
    SetStartTimes(starts_, &file_);
    *file = std::move(file_);
    return true;
  }

 private:
  // Takes channel and start time from lines of text.
  void TakeHeader(std::string_view line, const std::string& lower) {
    // "Chan  1: 360 Deg", and "Sta Cha:  1: 340 deg (Rcrdr Chan  1)".
    for (const std::string_view mark : {"sta cha:", "chan "}) {
      const size_t at = lower.find(mark);
      if (at == std::string::npos) continue;
      int64_t number = 0;
      const std::string text =
          TextBehind(line.substr(at + mark.size()), "", ":");
      if (ParseInt(text, &number) && number > 0) channel_ = number;
      break;
    }
    is_of_film_ = is_of_film_ || HasText(lower, "uncor accel are sec");
    for (const std::string_view mark : {"start time:", "rcrd start time:"}) {
      const size_t time = lower.find(mark);
      if (time != std::string::npos) {
        start_ = ParseStart(line.substr(time + mark.size()));
      }
    }
  }

  bool TakeRealHeader(const std::string& line, std::string* error) {
    int64_t count = 0;
    if (!LeadingCount(line, &count) || count < 1 ||
        count > kMostHeaderNumbers) {
      return lines_.Fail(
          "expected the number of real-header values at the line's beginning",
          error);
    }
    is_cosmos_ = true;
    const size_t format = line.rfind('(');
    const int width = format == std::string::npos
                          ? 0
                          : FortranWidth(std::string_view(line).substr(format));
    return ReadNumbers(&lines_, count, width, &real_header_, error);
  }

  bool TakeSection(const MotionSection& section, std::string* error) {
    LoggerChannel channel;
    channel.name = "ch" + std::to_string(channel_) + section.quantity->ending;
    channel.short_name = channel.name;
    channel.unit = section.unit;
    channel.is_derived = section.quantity != &kQuantities[0];
    channel.step = section.step;
    if (channel.step == 0.0 && real_header_.size() > kIntervalPlace &&
        real_header_[kIntervalPlace] != kUnknown) {
      channel.step = 1e-3 * real_header_[kIntervalPlace];
    }
    if (!(channel.step > 0.0) || !std::isfinite(1.0 / channel.step)) {
      return lines_.Fail(
          "the sampling interval of this section is not stated, expected it "
          "in this line, or in number 62 of the real header (ms)",
          error);
    }
    if (section.count < 2 ||
        section.count > static_cast<int64_t>(lines_.bytes())) {
      return lines_.Fail(std::to_string(section.count) +
                             " points, expected as many as the file holds",
                         error);
    }
    channel.size = section.count;
    const bool is_wanted = wanted_(channel);
    // Sections that are not wanted are read past, so that their numbers are not
    // taken for headers.
    if (!ReadNumbers(&lines_, section.count, section.width, &channel.values,
                     error)) {
      return false;
    }
    if (!is_wanted) channel.values.resize(0);
    file_.channels.push_back(std::move(channel));
    starts_.push_back(start_);
    return true;
  }

  TextLines lines_;
  const std::string& path_;
  const ChannelFilter& wanted_;
  LoggedFile file_;
  std::vector<StartTime> starts_;
  // From the headers so far.
  int64_t channel_ = 1;
  StartTime start_;
  Vector real_header_;
  bool is_cosmos_ = false;
  bool is_of_film_ = false;  // if no section follows
};

}  // namespace

bool IsStrongMotionTitle(std::string_view line) {
  const std::string lower = LowerCase(line);
  return lower.rfind("corrected accelerogram", 0) == 0 ||
         lower.rfind("uncorrected accelerogram", 0) == 0 ||
         (HasText(lower, "(format v") && HasText(lower, "text lines"));
}

bool ParseStrongMotion(const std::string& text, const std::string& path,
                       const ChannelFilter& wanted, LoggedFile* file,
                       std::string* error) {
  return StrongMotionParser(text, path, wanted).Parse(file, error);
}

}  // namespace pinode
