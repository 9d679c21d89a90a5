#include "pinode/structure/matrices/fortran_text.h"

#include <cctype>
#include <string>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Counts and widths beyond this are no lines that a program writes.
constexpr int kMaxPlaces = 1000;

// Reads the digits that begin `rest`. Returns `fallback` if there are none, and
// -1 for a number that is too large.
int TakeNumber(std::string_view* rest, int fallback) {
  size_t end = 0;
  while (end < rest->size() &&
         std::isdigit(static_cast<unsigned char>((*rest)[end]))) {
    ++end;
  }
  if (end == 0) return fallback;
  int number = 0;
  const bool parsed = ParseInt(rest->substr(0, end), &number);
  rest->remove_prefix(end);
  return parsed && number <= kMaxPlaces ? number : -1;
}

}  // namespace

bool ParseFortranFormat(std::string_view text, FortranFormat* format) {
  CHECK(format != nullptr);
  std::string compact;
  for (const char c : text) {
    if (c != ' ' && c != '\t' && c != '\r') {
      compact += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    }
  }
  std::string_view rest = compact;
  int groups = 0;
  int count = 1;
  bool is_scaled = false;
  // Before the letter: parentheses, repetitions, a scale factor.
  for (;;) {
    const int number = TakeNumber(&rest, 1);
    if (number < 0 || rest.empty()) return false;
    if (rest[0] == '(') {
      ++groups;
      count *= number;
    } else if (rest[0] == 'P') {
      is_scaled = number != 0;
      if (rest.size() > 1 && rest[1] == ',') rest.remove_prefix(1);
    } else {
      count *= number;
      break;
    }
    if (count > kMaxPlaces || groups > 2) return false;
    rest.remove_prefix(1);
  }
  const char letter = rest[0];
  if (std::string_view("IEDFG").find(letter) == std::string_view::npos ||
      (is_scaled && (letter == 'F' || letter == 'I')) || count < 1 ||
      count > kMaxPlaces) {
    return false;
  }
  rest.remove_prefix(1);
  const int width = TakeNumber(&rest, -1);
  if (width < 1) return false;
  if (!rest.empty() && rest[0] == '.') {
    rest.remove_prefix(1);
    // Digits behind the point may be none: `F20.0`.
    while (!rest.empty() && std::isdigit(static_cast<unsigned char>(rest[0]))) {
      rest.remove_prefix(1);
    }
    if (!rest.empty() && rest[0] == 'E') {  // digits of the exponent: E20.12E3
      rest.remove_prefix(1);
      if (TakeNumber(&rest, -1) < 0) return false;
    }
  }
  if (rest != std::string(static_cast<size_t>(groups), ')')) return false;
  format->letter = letter;
  format->count = count;
  format->width = width;
  return true;
}

std::string_view FixedField(std::string_view line, int index, int width) {
  const auto begin = static_cast<size_t>(index) * static_cast<size_t>(width);
  return begin < line.size()
             ? StripBlanks(line.substr(begin, static_cast<size_t>(width)))
             : std::string_view();
}

bool ParseFortranDouble(std::string_view text, double* value) {
  if (ParseDouble(text, value)) return true;
  const std::string_view number = StripBlanks(text);
  const size_t sign = number.find_last_of("+-");
  if (sign == std::string_view::npos || sign == 0) return false;
  const char before = number[sign - 1];
  if (before != '.' && !std::isdigit(static_cast<unsigned char>(before))) {
    return false;
  }
  return ParseDouble(std::string(number.substr(0, sign)) + "e" +
                         std::string(number.substr(sign)),
                     value);
}

}  // namespace pinode
