#include "pinode/report/number_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Plain notation inside [kSmall, kLarge).
constexpr double kSmall = 1e-4;
constexpr double kLarge = 1e7;

int Exponent(double magnitude) {
  return static_cast<int>(std::floor(std::log10(magnitude)));
}

// Writes by std::to_chars, which is the same in every locale.
std::string Write(double value, std::chars_format format, int precision) {
  std::array<char, 400> buffer;  // the longest double has 309 digits
  const auto result =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, format,
                    std::max(precision, 0));
  CHECK(result.ec == std::errc()) << "number does not fit its buffer";
  std::string text(buffer.data(), result.ptr);
  // A rounded "-0.00" is a zero.
  if (text[0] == '-' && text.find_first_of("123456789") == std::string::npos) {
    text.erase(0, 1);
  }
  return text;
}

std::string Fixed(double value, int decimals) {
  return Write(value, std::chars_format::fixed, decimals);
}

}  // namespace

std::string PercentText(double fraction) {
  return ReadableNumber(100.0 * fraction, 3);
}

std::string ReadableNumber(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  if (value == 0.0) return "0";
  const double magnitude = std::abs(value);
  if (magnitude < kSmall || magnitude >= kLarge) {
    return Write(value, std::chars_format::scientific, digits - 1);
  }
  // 0.99999 has become 1.000 with four digits, not 1.0000.
  const int exponent = Exponent(magnitude);
  const double next = std::pow(10.0, exponent + 1);
  const bool carries =
      magnitude >= next * (1.0 - 0.5 * std::pow(10.0, -digits));
  return Fixed(value, digits - 1 - exponent - (carries ? 1 : 0));
}

EstimateText FormatEstimate(double initial, double value, double half_width) {
  EstimateText text;
  const bool has_width = std::isfinite(half_width) && half_width > 0.0;
  if (!has_width || !std::isfinite(value) || !std::isfinite(initial)) {
    text.initial = ReadableNumber(initial, 5);
    text.value = ReadableNumber(value, 5);
    if (has_width) text.half_width = ReadableNumber(half_width, 2);
    return text;
  }
  const double scale =
      std::max({std::abs(initial), std::abs(value), half_width});
  int exponent = Exponent(scale);
  std::string suffix;
  double unit = 1.0;
  if (scale < kSmall || scale >= kLarge) {
    unit = std::pow(10.0, exponent);
    suffix = (exponent < 0 ? "e-" : "e+");
    const std::string digits = std::to_string(std::abs(exponent));
    suffix += digits.size() < 2 ? "0" + digits : digits;
    exponent = 0;
  }
  // At most nine digits, however small the interval.
  const int decimals = std::min(1 - Exponent(half_width / unit), 8 - exponent);
  text.initial =
      initial == 0.0 ? "0" : Fixed(initial / unit, decimals) + suffix;
  text.value = Fixed(value / unit, decimals) + suffix;
  text.half_width = Fixed(half_width / unit, decimals) + suffix;
  // An interval below the last digit must not be printed as zero.
  if (text.half_width.find_first_of("123456789") >=
      text.half_width.size() - suffix.size()) {
    text.half_width = ReadableNumber(half_width, 2);
  }
  return text;
}

std::string UnitText(const std::string& unit) {
  if (unit == "1") return "";
  std::string text = unit;
  ReplaceAll("^2", "\u00b2", &text);
  ReplaceAll("^3", "\u00b3", &text);
  ReplaceAll("*", "\u00b7", &text);
  return text;
}

std::string Count(int count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string Duration(double seconds) {
  if (!std::isfinite(seconds)) return "-";
  if (seconds < 119.5) return ReadableNumber(seconds, 3) + " s";
  const int whole = static_cast<int>(std::lround(seconds));
  const std::string rest = std::to_string(whole % 60);
  return std::to_string(whole / 60) + " min " +
         (rest.size() < 2 ? "0" + rest : rest) + " s";
}

}  // namespace pinode
