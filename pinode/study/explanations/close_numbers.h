// Numbers that are close to each other, in one sentence.

#ifndef PINODE_STUDY_EXPLANATIONS_CLOSE_NUMBERS_H_
#define PINODE_STUDY_EXPLANATIONS_CLOSE_NUMBERS_H_

#include <set>
#include <string>
#include <vector>

#include "pinode/base/strings.h"

namespace pinode {

// Returns the fewest significant digits, three or more and at most eight, with
// which FormatNumber tells `values` apart: "0.9993 (0.9988 to 0.9998)", not "1
// (1 to 1)". Equal values need no more digits.
inline int DigitsToTellApart(const std::vector<double>& values) {
  constexpr int kFewest = 3;
  constexpr int kMost = 8;
  const std::set<double> different(values.begin(), values.end());
  for (int digits = kFewest; digits < kMost; ++digits) {
    std::set<std::string> texts;
    for (const double value : different) {
      texts.insert(FormatNumber(value, digits));
    }
    if (texts.size() == different.size()) return digits;
  }
  return kMost;
}

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_CLOSE_NUMBERS_H_
