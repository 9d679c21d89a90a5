// Numbers as readable text.

#ifndef PINODE_REPORT_NUMBER_TEXT_H_
#define PINODE_REPORT_NUMBER_TEXT_H_

#include <string>

namespace pinode {

// Returns `value` with `digits` significant digits and no needless exponent:
// plain from 1e-4 up to 1e7 (integer digits are never rounded away), 1.234e-06
// outside; "-" if it is not finite.
std::string ReadableNumber(double value, int digits = 4);

// Returns a fraction in per cent with three significant digits, without the
// sign of per cent.
std::string PercentText(double fraction);

// An estimate with its uncertainty and its initial value. The three share one
// exponent and one number of decimals, that of two significant digits of the
// uncertainty: 4001200, 1300, 3200000 or 5.6251e-06, 0.0023e-06, 5.0000e-06.
struct EstimateText {
  std::string initial;
  std::string value;
  std::string half_width;
};

// Formats an estimate. half_width: of the interval. If it is not finite and
// positive, its text is empty and the values have five significant digits.
EstimateText FormatEstimate(double initial, double value, double half_width);

// Returns "m/s^2" as "m/s²", "N*s/m" as "N·s/m"; "" for "1".
std::string UnitText(const std::string& unit);

// Returns "1 sample", "3 samples".
std::string Count(int count, const std::string& noun);

// Returns "0.42 s", "12.3 s", "2 min 05 s".
std::string Duration(double seconds);

}  // namespace pinode

#endif  // PINODE_REPORT_NUMBER_TEXT_H_
