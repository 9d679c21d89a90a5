#include "pinode/base/strings.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <system_error>

#include "pinode/base/logging.h"

namespace pinode {
namespace {

// Returns the text in lower case. Names are usually ASCII; other bytes are
// compared unchanged.
std::string Lower(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

// Optimal string alignment distance (Damerau-Levenshtein in which no part is
// edited twice).
size_t EditDistance(const std::string& a, const std::string& b) {
  std::vector<size_t> before_last(b.size() + 1);
  std::vector<size_t> last(b.size() + 1);
  std::vector<size_t> row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t substitution = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, substitution});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
    before_last.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

// Strips the parts that std::from_chars does not read: a leading '+' and
// blanks. Returns false if nothing is left that could be a number.
bool StripForNumber(std::string_view* text) {
  *text = StripBlanks(*text);
  if (!text->empty() && text->front() == '+') {
    text->remove_prefix(1);
    if (!text->empty() && text->front() == '-') return false;
  }
  return !text->empty();
}

template <typename Integer>
bool ParseInteger(std::string_view text, Integer* value) {
  CHECK(value != nullptr);
  if (!StripForNumber(&text)) return false;
  Integer parsed = 0;
  const auto [end, status] =
      std::from_chars(text.data(), text.data() + text.size(), parsed);
  if (end != text.data() + text.size() || status != std::errc()) return false;
  *value = parsed;
  return true;
}

}  // namespace

std::string NearestName(const std::string& name,
                        const std::vector<std::string>& known) {
  const std::string lower = Lower(name);
  const std::string* nearest = nullptr;
  size_t smallest = std::numeric_limits<size_t>::max();
  for (const std::string& candidate : known) {
    const size_t distance = EditDistance(lower, Lower(candidate));
    const size_t tolerated =
        std::max<size_t>(1, std::max(name.size(), candidate.size()) / 3);
    if (distance > tolerated || distance >= smallest) continue;
    // One edit turns any one-letter name into any other: that is no hint.
    if (distance >= std::max(name.size(), candidate.size())) continue;
    smallest = distance;
    nearest = &candidate;
  }
  return nearest == nullptr ? std::string() : *nearest;
}

std::string NameHint(const std::string& name,
                     const std::vector<std::string>& known) {
  if (known.empty()) return "";
  const std::string nearest = NearestName(name, known);
  if (!nearest.empty()) return "; did you mean '" + nearest + "'?";
  return "; known are: " + Join(known, ", ");
}

bool ParseDouble(std::string_view text, double* value) {
  CHECK(value != nullptr);
  if (!StripForNumber(&text)) return false;
  std::string fortran;
  const size_t exponent = text.find_first_of("dD");
  // Only behind a digit or point; "inf" and "nan" have no such letter.
  if (exponent != std::string_view::npos && exponent > 0) {
    fortran.assign(text);
    fortran[exponent] = 'e';
    text = fortran;
  }
  // The exponent's own sign may be '+', which from_chars accepts there.
  double parsed = 0.0;
  const auto [end, status] =
      std::from_chars(text.data(), text.data() + text.size(), parsed);
  if (end != text.data() + text.size()) return false;
  if (status == std::errc::result_out_of_range) {
    // Overflow and underflow give the same error here. A tiny number is taken
    // as zero; a huge one is a mistake.
    const size_t e = text.find_first_of("eE");
    const bool underflow =
        e != std::string_view::npos && text.find('-', e) != text.npos;
    if (!underflow) return false;
    parsed = 0.0;
  } else if (status != std::errc()) {
    return false;
  }
  *value = parsed;
  return true;
}

bool ParseInt(std::string_view text, int* value) {
  return ParseInteger(text, value);
}

bool ParseInt(std::string_view text, int64_t* value) {
  return ParseInteger(text, value);
}

std::string FormatNumber(double value, int digits) {
  CHECK_GE(digits, 0) << "digits is 0 (shortest) or 1 to 17";
  CHECK_LE(digits, 17) << "a double has no more than 17 significant digits";
  // The longest: sign, 17 digits, point, exponent.
  std::array<char, 64> buffer;
  char* const first = buffer.data();
  char* const last = first + buffer.size();
  const auto result = digits == 0
                          ? std::to_chars(first, last, value)
                          : std::to_chars(first, last, value,
                                          std::chars_format::general, digits);
  CHECK(result.ec == std::errc()) << "number does not fit its buffer";
  return std::string(first, result.ptr);
}

std::string_view StripBlanks(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string Join(const std::vector<std::string>& parts,
                 std::string_view separator) {
  std::string joined;
  for (size_t i = 0; i < parts.size(); ++i) {
    if (i > 0) joined += separator;
    joined += parts[i];
  }
  return joined;
}

void ReplaceAll(const std::string& from, const std::string& to,
                std::string* text) {
  for (size_t at = text->find(from); at != std::string::npos;
       at = text->find(from, at + to.size())) {
    text->replace(at, from.size(), to);
  }
}

}  // namespace pinode
