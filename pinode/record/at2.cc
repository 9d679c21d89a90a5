#include "pinode/record/at2.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

constexpr int kMostTitleLines = 40;

std::string Upper(std::string_view text) {
  std::string upper(text);
  for (char& c : upper) {
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  }
  return upper;
}

std::vector<std::string> Words(std::string_view text,
                               std::string_view separators) {
  std::vector<std::string> words;
  size_t begin = text.find_first_not_of(separators);
  while (begin != std::string_view::npos) {
    const size_t end =
        std::min(text.find_first_of(separators, begin), text.size());
    words.emplace_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(separators, end);
  }
  return words;
}

// "0.01" or "0.01SEC".
bool ParseStep(std::string word, double* step) {
  for (const std::string_view suffix : {"SEC", "S"}) {
    if (word.size() > suffix.size() &&
        word.compare(word.size() - suffix.size(), suffix.size(), suffix) == 0) {
      word.resize(word.size() - suffix.size());
      break;
    }
  }
  return ParseDouble(word, step);
}

enum class SizeLine { kAbsent, kBad, kGood };

// The line that gives the number of points and the step.
SizeLine ParseSizeLine(std::string_view line, int* num_points, double* step) {
  const std::vector<std::string> words = Words(Upper(line), " \t,=:");
  const auto points = std::find(words.begin(), words.end(), "NPTS");
  const auto dt = std::find(words.begin(), words.end(), "DT");
  if (points == words.end() || dt == words.end()) return SizeLine::kAbsent;
  bool good = false;
  if (points + 1 < words.end() && dt + 1 < words.end() && points + 1 != dt) {
    good = ParseInt(*(points + 1), num_points) && ParseStep(*(dt + 1), step);
  } else if (words.size() >= 4 && points == words.begin() + 2) {
    good = ParseInt(words[0], num_points) && ParseStep(words[1], step);
  }
  return good ? SizeLine::kGood : SizeLine::kBad;
}

// The word behind "UNITS OF", upper case, without parentheses; empty if none.
std::string StatedUnit(std::string_view line) {
  const std::vector<std::string> words = Words(Upper(line), " \t,.()");
  for (size_t i = 0; i + 2 < words.size(); ++i) {
    if (words[i] == "UNITS" && words[i + 1] == "OF") return words[i + 2];
  }
  return "";
}

}  // namespace

bool ReadAt2(const std::string& path, At2Motion* motion, std::string* error) {
  std::string text;
  return ReadTextFile(path, &text, error) &&
         ParseAt2(text, path, motion, error);
}

bool ParseAt2(const std::string& text, const std::string& path,
              At2Motion* motion, std::string* error) {
  CHECK(motion != nullptr);
  CHECK(error != nullptr);
  std::vector<std::string> title;
  int num_points = 0;
  double step = 0.0;
  bool in_title = true;
  std::vector<double> values;
  int line_number = 0;
  size_t position = 0;
  auto fail = [&](const std::string& message) {
    *error = path + ":" + std::to_string(line_number) + ": " + message;
    return false;
  };

  while (position < text.size()) {
    const size_t end = std::min(text.find('\n', position), text.size());
    const std::string_view line =
        StripBlanks(std::string_view(text).substr(position, end - position));
    position = end + 1;
    ++line_number;
    if (line.empty()) continue;

    if (in_title) {
      const SizeLine kind = ParseSizeLine(line, &num_points, &step);
      if (kind == SizeLine::kBad ||
          (kind == SizeLine::kGood &&
           (num_points < 2 || !(step > 0.0) || !std::isfinite(step)))) {
        return fail("'" + std::string(line) +
                    "', expected at least two points and a positive step, as "
                    "in 'NPTS= 4000, DT= .0050 SEC'");
      }
      if (kind == SizeLine::kGood) {
        in_title = false;
        // No more than the text can hold, whatever NPTS claims.
        values.reserve(
            std::min(static_cast<size_t>(num_points), text.size() / 2));
        continue;
      }
      const std::string unit = StatedUnit(line);
      if (!unit.empty() && unit != "G") {
        return fail("values in units of " + unit +
                    ", expected an acceleration in units of g");
      }
      title.emplace_back(line);
      if (line_number >= kMostTitleLines) break;
      continue;
    }

    for (const std::string& word : Words(line, " \t\r,")) {
      double value = 0.0;
      if (!ParseDouble(word, &value)) {
        if (static_cast<int>(values.size()) == num_points) break;
        return fail("'" + word + "' is not a number; " +
                    std::to_string(values.size()) + " of " +
                    std::to_string(num_points) + " points were read");
      }
      if (static_cast<int>(values.size()) == num_points) {
        return fail("more points than the NPTS= " + std::to_string(num_points) +
                    " stated above");
      }
      if (!std::isfinite(value)) {
        return fail("'" + word + "' is not finite");
      }
      values.push_back(value);
    }
  }

  if (in_title) {
    *error = path +
             ": no line such as 'NPTS= 4000, DT= .0050 SEC' found, expected a "
             "PEER AT2 file";
    return false;
  }
  if (static_cast<int>(values.size()) != num_points) {
    return fail("the file ends after " + std::to_string(values.size()) +
                " points, expected NPTS= " + std::to_string(num_points));
  }
  motion->title = Join(title, " | ");
  motion->sampling_step = step;
  motion->acceleration = Eigen::Map<const Vector>(
      values.data(), static_cast<Eigen::Index>(values.size()));
  return true;
}

}  // namespace pinode
