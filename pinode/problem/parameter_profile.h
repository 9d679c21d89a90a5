// Result of a likelihood profile for one parameter.

#ifndef PINODE_PROBLEM_PARAMETER_PROFILE_H_
#define PINODE_PROBLEM_PARAMETER_PROFILE_H_

#include <string>
#include <vector>

#include "pinode/base/constants.h"

namespace pinode {

// Degree to which the data determine a parameter.
enum class Determination {
  kDetermined,  // the 95 % interval has two ends
  kOneSided,    // it has one
  kNotHere,     // it has none: other data of this kind may give it ends
  kNotAtAll,    // the cost does not change at all: no data of this kind will
};
// Returns "determined", "one-sided", "not determined by these data" or "not
// determined at all".
const char* DeterminationName(Determination determination);

struct ParameterProfile {
  struct Point {
    double value = 0.0;
    double ratio = 0.0;  // D of profile.h
  };

  std::string name;
  std::string unit;
  double estimate = 0.0;
  // Points of the profile, ascending by value, with the estimate among them.
  std::vector<Point> points;
  // Bounds of the intervals. Infinite if the likelihood ratio does not reach
  // its threshold before a bound, or far away.
  double lower95 = -kInfinity, upper95 = kInfinity;
  double lower99 = -kInfinity, upper99 = kInfinity;
  // Thresholds of the ratio for the 95 and 99 % intervals.
  double threshold95 = 0.0, threshold99 = 0.0;
  // Linear 95 % interval; infinite if there is none.
  double linear_lower95 = -kInfinity, linear_upper95 = kInfinity;
  Determination determination = Determination::kNotHere;
  // If the parameter is not determined: combination that the data keep constant
  // along the profile, such as "a * b". Empty: no simple one.
  std::vector<std::string> combinations;
  // True if the profile met a value with a lower cost than the fit's.
  bool found_lower = false;
  // True if the other parameters could not be fitted again to a minimum at some
  // point. The ratio may be smaller there, and the interval wider.
  bool unsettled = false;
  int linearizations = 0;

  // True if an end differs from the linear interval's by more than a fifth of
  // its distance from the estimate.
  bool DiffersFromLinear() const;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_PARAMETER_PROFILE_H_
