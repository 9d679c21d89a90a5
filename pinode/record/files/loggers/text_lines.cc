#include "pinode/record/files/loggers/text_lines.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"

namespace pinode {

bool TextLines::Next(std::string_view* line) {
  if (AtEnd()) return false;
  const size_t end = std::min(text_.find('\n', position_), text_.size());
  *line = text_.substr(position_, end - position_);
  if (!line->empty() && line->back() == '\r') line->remove_suffix(1);
  position_ = end + 1;
  ++number_;
  return true;
}

bool TextLines::Fail(const std::string& message, std::string* error) const {
  *error = path_ + ":" + std::to_string(std::max<int64_t>(number_, 1)) + ": " +
           message;
  return false;
}

std::vector<std::string_view> WordsOf(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r";
  std::vector<std::string_view> words;
  size_t begin = line.find_first_not_of(kBlanks);
  while (begin != std::string_view::npos) {
    const size_t end =
        std::min(line.find_first_of(kBlanks, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlanks, end);
  }
  return words;
}

bool ReadNumbers(TextLines* lines, int64_t count, int width, Vector* values,
                 std::string* error) {
  std::vector<double> numbers;
  // No more than the text can hold, whatever its header claims.
  numbers.reserve(std::min(static_cast<size_t>(count), lines->bytes() / 2 + 1));
  const auto number_missing = [&] {
    return std::to_string(numbers.size()) + " of " + std::to_string(count) +
           " values were read";
  };
  std::string_view line;
  while (static_cast<int64_t>(numbers.size()) < count) {
    if (!lines->Next(&line)) {
      return lines->Fail("the file ends where " + number_missing(), error);
    }
    std::vector<std::string_view> cells;
    if (width > 0) {
      for (size_t at = 0; at < line.size(); at += static_cast<size_t>(width)) {
        const std::string_view cell =
            StripBlanks(line.substr(at, static_cast<size_t>(width)));
        if (!cell.empty()) cells.push_back(cell);
      }
    } else {
      cells = WordsOf(line);
    }
    for (const std::string_view cell : cells) {
      double value = 0.0;
      if (!ParseDouble(cell, &value) || !std::isfinite(value)) {
        return lines->Fail(
            Quote(cell) + " is not a number; " + number_missing(), error);
      }
      if (static_cast<int64_t>(numbers.size()) == count) {
        return lines->Fail("more values than the " + std::to_string(count) +
                               " that the header states",
                           error);
      }
      numbers.push_back(value);
    }
  }
  *values = Eigen::Map<const Vector>(numbers.data(),
                                     static_cast<Eigen::Index>(numbers.size()));
  return true;
}

int FortranWidth(std::string_view text) {
  // Number of fields, letter, width: "8f10.5".
  for (size_t i = 0; i < text.size(); ++i) {
    const char letter =
        static_cast<char>(std::tolower(static_cast<unsigned char>(text[i])));
    if (i == 0 ||
        (letter != 'f' && letter != 'e' && letter != 'i' && letter != 'g') ||
        std::isdigit(static_cast<unsigned char>(text[i - 1])) == 0) {
      continue;
    }
    size_t end = i + 1;
    while (end < text.size() &&
           std::isdigit(static_cast<unsigned char>(text[end])) != 0) {
      ++end;
    }
    int width = 0;
    if (ParseInt(text.substr(i + 1, end - i - 1), &width) && width > 0 &&
        width < 100) {
      return width;
    }
  }
  return 0;
}

bool ParseTimeOfDay(std::string_view text, int64_t* seconds, double* fraction) {
  const std::vector<std::string_view> parts = Split(text, ':');
  int hours = 0;
  int minutes = 0;
  double second = 0.0;
  if (parts.size() != 3 || !ParseInt(parts[0], &hours) ||
      !ParseInt(parts[1], &minutes) || !ParseDouble(parts[2], &second) ||
      hours < 0 || hours > 24 || minutes < 0 || minutes > 59 ||
      !(second >= 0.0 && second < 61.0)) {
    return false;
  }
  const double whole = std::floor(second);
  *seconds = hours * 3600 + minutes * 60 + static_cast<int64_t>(whole);
  *fraction = second - whole;
  return true;
}

}  // namespace pinode
