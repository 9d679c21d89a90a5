#include "pinode/record/files/loggers/bhrc.h"

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/record/files/loggers/text_lines.h"

namespace pinode {
namespace {

constexpr std::string_view kTitle = "* vol";
constexpr std::string_view kVolume = "* vol1ds";
constexpr int kHeaderLines = 7;  // of whole numbers, and of real ones
constexpr int kWidth = 13;       // of a real number
constexpr int kMostTextLines = 30;

// Returns the first word behind `mark`; empty without it.
std::string_view WordBehind(std::string_view line, std::string_view mark) {
  const size_t at = line.find(mark);
  if (at == std::string_view::npos) return {};
  const std::vector<std::string_view> words =
      WordsOf(line.substr(at + mark.size()));
  return words.empty() ? std::string_view() : words[0];
}

// Text of the header of one component.
struct ComponentText {
  std::string name;
  std::string unit;
  double factor = 1.0;  // on the samples, to that unit
  int64_t count = 0;
  double duration = 0.0;  // s
};

class BhrcParser {
 public:
  BhrcParser(const std::string& text, const std::string& path,
             const ChannelFilter& wanted)
      : lines_(text, path), wanted_(wanted) {}

  bool Parse(LoggedFile* file, std::string* error) {
    file_.format = "BHRC";
    std::string_view line;
    while (lines_.Next(&line)) {
      if (!IsBhrcTitle(line)) continue;
      if (LowerCase(line).rfind(kVolume, 0) != 0) {
        return lines_.Fail(
            "this is not Volume 1 of BHRC, the only one that is read. Use the "
            "file "
            "of Volume 1 (its first line begins with * VOL1DS), or a text file "
            "of times and accelerations",
            error);
      }
      ComponentText component;
      LoggerChannel channel;
      if (!ReadText(&component, error) ||
          !ReadChannel(component, &channel, error)) {
        return false;
      }
      file_.channels.push_back(std::move(channel));
    }
    file_.remarks.push_back("Volume 1 of BHRC is not corrected");
    MakeNamesUnique(&file_);
    *file = std::move(file_);
    return true;
  }

 private:
  // Reads up to the line of the units.
  bool ReadText(ComponentText* component, std::string* error) {
    std::string_view line;
    for (int i = 0; i < kMostTextLines && lines_.Next(&line); ++i) {
      const std::string lower = LowerCase(line);
      if (lower.rfind("comp ", 0) == 0) {
        component->name = std::string(WordBehind(line, " "));
      } else if (lower.find("no. of points") != std::string::npos) {
        if (!ParseInt(WordBehind(lower, "points ="), &component->count) ||
            !ParseDouble(WordBehind(lower, "duration ="),
                         &component->duration)) {
          return lines_.Fail(
              "expected 'NO. OF POINTS = ... DURATION = ...' with two numbers",
              error);
        }
      } else if (lower.find("units are") != std::string::npos) {
        const size_t at = lower.find(" and ");
        if (at != std::string::npos) {
          component->unit = std::string(StripBlanks(line.substr(at + 5)));
        }
        if (LowerCase(component->unit) == "g/10") {
          component->unit = "g";
          component->factor = 0.1;
        }
        return CheckText(*component, error);
      }
    }
    return lines_.Fail(
        "the header has no line such as 'UNITS ARE SECONDS AND G/10'; the file "
        "is cut, or is not Volume 1 of BHRC",
        error);
  }

  bool CheckText(const ComponentText& component, std::string* error) const {
    if (component.unit.empty()) {
      return lines_.Fail("expected units such as 'SECONDS AND G/10'", error);
    }
    if (component.name.empty()) {
      return lines_.Fail("no line such as 'COMP L1' above", error);
    }
    if (component.count < 2 ||
        component.count > static_cast<int64_t>(lines_.bytes())) {
      return lines_.Fail(std::to_string(component.count) +
                             " points, expected as many as the file holds",
                         error);
    }
    return true;
  }

  // Reads the numbers.
  bool ReadChannel(const ComponentText& component, LoggerChannel* channel,
                   std::string* error) {
    std::string_view line;
    for (int i = 0; i < 1 + kHeaderLines; ++i) {
      if (!lines_.Next(&line)) return Short(error);
    }
    double rate = 0.0;
    for (int i = 0; i < kHeaderLines; ++i) {
      if (!lines_.Next(&line)) return Short(error);
      if (i == 1 && !ParseDouble(StripBlanks(line.substr(0, kWidth)), &rate)) {
        rate = 0.0;
      }
    }
    const auto count = static_cast<double>(component.count);
    // The duration may be that of the samples or of the steps between them, and
    // has three decimals.
    const double steps = rate * component.duration;
    if (!(rate > 0.0) || !std::isfinite(1.0 / rate) ||
        !(std::abs(steps - count) <= 1.5 + 1e-3 * rate)) {
      return lines_.Fail(
          "a sampling rate of " + FormatNumber(rate, 6) +
              " Hz in the header "
              "and " +
              std::to_string(component.count) + " points in " +
              FormatNumber(component.duration, 6) +
              " s contradict each other. Write the samples to a text file and "
              "give its sampling rate",
          error);
    }
    channel->name = channel->short_name = component.name;
    channel->unit = component.unit;
    channel->step = 1.0 / rate;
    channel->size = component.count;
    const bool is_wanted = wanted_(*channel);
    if (!ReadNumbers(&lines_, component.count, kWidth, &channel->values,
                     error)) {
      return false;
    }
    channel->values *= component.factor;
    if (!is_wanted) channel->values.resize(0);
    return true;
  }

  bool Short(std::string* error) const {
    return lines_.Fail("the file ends inside of a header. Copy the file again",
                       error);
  }

  TextLines lines_;
  const ChannelFilter& wanted_;
  LoggedFile file_;
};

}  // namespace

bool IsBhrcTitle(std::string_view line) {
  const std::string lower = LowerCase(line);
  return lower.rfind(kTitle, 0) == 0 &&
         lower.find(" file:") != std::string::npos;
}

bool ParseBhrc(const std::string& text, const std::string& path,
               const ChannelFilter& wanted, LoggedFile* file,
               std::string* error) {
  return BhrcParser(text, path, wanted).Parse(file, error);
}

}  // namespace pinode
