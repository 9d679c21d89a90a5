#include "pinode/record/number_rows.h"

#include <cstdint>
#include <string>

#include "pinode/base/file_text.h"

namespace pinode {
namespace {

constexpr double kPowers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,
                              1e7,  1e8,  1e9,  1e10, 1e11, 1e12, 1e13,
                              1e14, 1e15, 1e16, 1e17, 1e18, 1e19};
constexpr uint64_t kLargestExactMantissa = uint64_t{1} << 53;
// Digits that fit 64 bits, whatever they are.
constexpr std::ptrdiff_t kMostDigits = 19;

unsigned DigitOf(char c) {
  return static_cast<unsigned>(static_cast<unsigned char>(c)) - '0';
}

bool IsBlankOf(char c, char delimiter) {
  return c == ' ' || (c == '\t' && delimiter != '\t');
}

}  // namespace

bool IsMissing(std::string_view cell) {
  if (cell.empty()) return true;
  if (cell.size() > 8) return false;
  if (cell.find_first_not_of('-') == std::string_view::npos) {
    return cell.size() <= 4;
  }
  const std::string lower = LowerCase(cell);
  // The longest are those of programs by Microsoft's compiler.
  for (const char* name :
       {"nan", "-nan", "na", "n/a", "n.a.", "#n/a", "null", "none", "1.#qnan",
        "-1.#qnan", "1.#ind", "-1.#ind"}) {
    if (lower == name) return true;
  }
  return false;
}

const char* ParseSimpleNumber(const char* at, const char* end, char decimal,
                              double* value) {
  bool is_negative = false;
  if (at != end && (*at == '-' || *at == '+')) {
    is_negative = *at == '-';
    ++at;
  }
  const char* const begin = at;
  uint64_t mantissa = 0;
  while (at != end && DigitOf(*at) < 10) {
    mantissa = 10 * mantissa + DigitOf(*at);
    ++at;
  }
  std::ptrdiff_t digits = at - begin;
  std::ptrdiff_t decimals = 0;
  if (at != end && *at == decimal) {
    const char* const first = ++at;
    while (at != end && DigitOf(*at) < 10) {
      mantissa = 10 * mantissa + DigitOf(*at);
      ++at;
    }
    decimals = at - first;
    if (decimals == 0) return nullptr;
    digits += decimals;
  }
  // More digits have overflown the mantissa, which does no harm.
  if (digits == 0 || digits > kMostDigits || mantissa > kLargestExactMantissa) {
    return nullptr;
  }
  const double number = static_cast<double>(mantissa) / kPowers[decimals];
  *value = is_negative ? -number : number;
  return at;
}

bool NumberRow::Parse(std::string_view line, double* values,
                      std::ptrdiff_t stride) const {
  const char* at = line.data();
  const char* end = at + line.size();
  if (at != end && end[-1] == '\r') --end;
  // A comment, even if its first cell would be passed over.
  const size_t begin = line.find_first_not_of(" \t");
  if (begin != std::string_view::npos && line[begin] == '#') return false;
  for (size_t cell = 0; cell < columns_.size(); ++cell) {
    if (cell > 0) {
      if (delimiter_ == ' ') {
        if (at == end || !IsBlankOf(*at, ' ')) return false;
      } else if (at == end || *at++ != delimiter_) {
        return false;
      }
    }
    while (at != end && IsBlankOf(*at, delimiter_)) ++at;
    if (columns_[cell] >= 0) {
      at = ParseSimpleNumber(at, end, decimal_,
                             values + columns_[cell] * stride);
      if (at == nullptr) return false;
      if (delimiter_ == ' ') continue;
      while (at != end && IsBlankOf(*at, delimiter_)) ++at;
    } else {
      // A cell of blanks alone is none between blanks.
      if (at == end && delimiter_ == ' ') return false;
      while (at != end && *at != delimiter_ &&
             (delimiter_ != ' ' || *at != '\t')) {
        if (*at++ == '"') return false;
      }
    }
  }
  while (at != end && IsBlankOf(*at, delimiter_)) ++at;
  return at == end;
}

}  // namespace pinode
