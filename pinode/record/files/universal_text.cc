#include "pinode/record/files/universal_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Returns true if a number ends before the sign at `at`. Fields may be full to
// the last column, so that numbers touch.
bool BeginsNumber(std::string_view line, size_t at) {
  const unsigned char before = static_cast<unsigned char>(line[at - 1]);
  return (line[at] == '-' || line[at] == '+') &&
         (std::isdigit(before) || before == '.');
}

// Returns the number with a decimal point and the shortest exponent: 1e-05
// becomes 1.e-5.
std::string Compact(std::string_view text) {
  const size_t e = text.find('e');
  std::string result(text.substr(0, e));
  if (result.find('.') == std::string::npos) result += '.';
  if (e == std::string_view::npos) return result;
  const size_t digits = text.find_first_not_of("+-0", e + 1);
  if (digits == std::string_view::npos) return result;
  result += text[e + 1] == '-' ? "e-" : "e";
  return result.append(text.substr(digits));
}

std::string Printed(double value, std::chars_format format, int digits) {
  std::array<char, 400> text;
  const std::to_chars_result end = std::to_chars(
      text.data(), text.data() + text.size(), value, format, digits);
  return Compact(std::string_view(text.data(),
                                  static_cast<size_t>(end.ptr - text.data())));
}

// Returns the form nearest to `value` that fits, one of two forms.
std::string Nearest(double value, size_t room) {
  std::string best;
  double smallest = std::numeric_limits<double>::infinity();
  for (const std::chars_format format :
       {std::chars_format::fixed, std::chars_format::scientific}) {
    for (int digits = 17; digits >= 0; --digits) {
      std::string text = Printed(value, format, digits);
      if (text.size() > room) continue;
      double read = 0.0;
      if (!ParseDouble(text, &read)) break;
      const double error = std::abs(read - value);
      if (error < smallest) {
        smallest = error;
        best = std::move(text);
      }
      break;
    }
  }
  return best;
}

}  // namespace

std::string_view UniversalLines::Next() {
  const size_t end = rest_.find('\n');
  std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::string_view UniversalLines::Peek() const {
  UniversalLines copy = *this;
  return copy.Next();
}

bool UniversalLines::AtEndOfSet() const {
  return AtEnd() || IsUniversalSeparator(Peek());
}

std::string_view UniversalLines::Bytes(size_t count) {
  const std::string_view bytes = rest_.substr(0, count);
  rest_.remove_prefix(bytes.size());
  return bytes;
}

UniversalLines UniversalLines::Behind(size_t skip) const {
  UniversalLines copy = *this;
  copy.Bytes(skip);
  return copy;
}

bool IsUniversalSeparator(std::string_view line) {
  return StripBlanks(line) == "-1";
}

std::string_view UniversalField(std::string_view line, size_t begin,
                                size_t width) {
  return begin >= line.size() ? std::string_view()
                              : StripBlanks(line.substr(begin, width));
}

std::string UniversalTextField(std::string_view line, size_t begin,
                               size_t width) {
  const std::string_view text = UniversalField(line, begin, width);
  return text == "NONE" ? std::string() : std::string(text);
}

bool UniversalIntField(std::string_view line, size_t begin, size_t width,
                       int* value) {
  const std::string_view text = UniversalField(line, begin, width);
  *value = 0;
  return text.empty() || ParseInt(text, value);
}

bool UniversalRealField(std::string_view line, size_t begin, size_t width,
                        double* value) {
  const std::string_view text = UniversalField(line, begin, width);
  *value = 0.0;
  return text.empty() || ParseDouble(text, value);
}

bool UniversalNumbers(std::string_view line, std::vector<double>* values) {
  size_t at = 0;
  while (at < line.size()) {
    while (at < line.size() &&
           std::isspace(static_cast<unsigned char>(line[at]))) {
      ++at;
    }
    size_t end = at;
    while (end < line.size() &&
           !std::isspace(static_cast<unsigned char>(line[end])) &&
           (end == at || !BeginsNumber(line, end))) {
      ++end;
    }
    if (end == at) break;
    double value = 0.0;
    if (!ParseDouble(line.substr(at, end - at), &value)) return false;
    values->push_back(value);
    at = end;
  }
  return true;
}

bool UniversalInteger(double number, int* value) {
  if (!(number == std::floor(number) && std::abs(number) <= 2e9)) return false;
  *value = static_cast<int>(number);
  return true;
}

bool UniversalIntegers(std::string_view line, std::vector<int>* values) {
  std::vector<double> numbers;
  if (!UniversalNumbers(line, &numbers)) return false;
  for (const double number : numbers) {
    int value = 0;
    if (!UniversalInteger(number, &value)) return false;
    values->push_back(value);
  }
  return true;
}

std::string UniversalNumber(double value, size_t width) {
  const size_t room = width - 1;
  std::string text = FormatNumber(value);
  if (std::isfinite(value)) {
    text = Compact(text);
    if (text.size() > room) text = Nearest(value, room);
  }
  return std::string(width - std::min(width, text.size()), ' ') + text;
}

}  // namespace pinode
