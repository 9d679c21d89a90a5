#include "pinode/record/files/at2.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Lines before the samples. With more, the text is of another format.
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

// Parses "0.01" or "0.01SEC".
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

// Parses the line that gives the number of points and the step.
SizeLine ParseSizeLine(std::string_view line, int64_t* num_points,
                       double* step) {
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

// Returns the word behind "UNITS OF", upper case, without parentheses; empty if
// there is none.
std::string StatedUnit(std::string_view line) {
  const std::vector<std::string> words = Words(Upper(line), " \t,.()");
  for (size_t i = 0; i + 2 < words.size(); ++i) {
    if (words[i] == "UNITS" && words[i + 1] == "OF") return words[i + 2];
  }
  return "";
}

// A PEER AT2 file line by line: a title that ends with the line of number of
// points and step, then values in g, any number a line.
class At2Parser {
 public:
  // `size` is the size of the file in bytes.
  At2Parser(const std::string& path, size_t size) : path_(path), size_(size) {}

  bool TakeLine(std::string_view line, std::string* error) {
    ++line_number_;
    if (line.empty()) return true;
    return in_title_ ? TakeTitle(line, error) : TakeValues(line, error);
  }

  // Returns true if the text cannot be such a file.
  bool gave_up() const { return in_title_ && line_number_ >= kMostTitleLines; }

  bool Finish(At2Motion* motion, std::string* error) const {
    if (in_title_) {
      *error = path_ +
               ": no line such as 'NPTS= 4000, DT= .0050 SEC' found, expected "
               "a PEER AT2 file";
      return false;
    }
    if (!is_complete()) {
      return Fail("the file ends after " + std::to_string(values_.size()) +
                      " points, expected NPTS= " + std::to_string(num_points_),
                  error);
    }
    motion->title = Join(title_, " | ");
    motion->sampling_step = step_;
    motion->acceleration = Eigen::Map<const Vector>(
        values_.data(), static_cast<Eigen::Index>(values_.size()));
    return true;
  }

 private:
  bool Fail(const std::string& message, std::string* error) const {
    *error = path_ + ":" + std::to_string(line_number_) + ": " + message;
    return false;
  }
  bool is_complete() const {
    return static_cast<int64_t>(values_.size()) == num_points_;
  }

  bool TakeTitle(std::string_view line, std::string* error) {
    const SizeLine kind = ParseSizeLine(line, &num_points_, &step_);
    if (kind == SizeLine::kBad ||
        (kind == SizeLine::kGood &&
         (num_points_ < 2 || !(step_ > 0.0) || !std::isfinite(step_)))) {
      return Fail("'" + std::string(line) +
                      "', expected at least two points and a positive step, "
                      "as in 'NPTS= 4000, DT= .0050 SEC'",
                  error);
    }
    if (kind == SizeLine::kGood) {
      in_title_ = false;
      // No more than the text can hold, whatever NPTS claims.
      values_.reserve(std::min(static_cast<size_t>(num_points_), size_ / 2));
      return true;
    }
    const std::string unit = StatedUnit(line);
    if (!unit.empty() && unit != "G") {
      return Fail("values in units of " + unit +
                      ", expected an acceleration in units of g",
                  error);
    }
    title_.emplace_back(line);
    return true;
  }

  bool TakeValues(std::string_view line, std::string* error) {
    for (const std::string& word : Words(line, " \t\r,")) {
      double value = 0.0;
      if (!ParseDouble(word, &value)) {
        if (is_complete()) break;
        return Fail("'" + word + "' is not a number; " +
                        std::to_string(values_.size()) + " of " +
                        std::to_string(num_points_) + " points were read",
                    error);
      }
      if (is_complete()) {
        return Fail("more points than the NPTS= " +
                        std::to_string(num_points_) + " stated above",
                    error);
      }
      if (!std::isfinite(value)) {
        return Fail("'" + word + "' is not finite", error);
      }
      values_.push_back(value);
    }
    return true;
  }

  const std::string& path_;
  const size_t size_;
  int64_t line_number_ = 0;
  bool in_title_ = true;
  std::vector<std::string> title_;
  int64_t num_points_ = 0;
  double step_ = 0.0;
  std::vector<double> values_;
};

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
  At2Parser parser(path, text.size());
  for (size_t position = 0; position < text.size() && !parser.gave_up();) {
    const size_t end = std::min(text.find('\n', position), text.size());
    const std::string_view line =
        StripBlanks(std::string_view(text).substr(position, end - position));
    position = end + 1;
    if (!parser.TakeLine(line, error)) return false;
  }
  return parser.Finish(motion, error);
}

}  // namespace pinode
