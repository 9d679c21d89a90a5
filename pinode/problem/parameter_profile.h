// What a profile of the likelihood says of one parameter.

#ifndef PINODE_PROBLEM_PARAMETER_PROFILE_H_
#define PINODE_PROBLEM_PARAMETER_PROFILE_H_

#include <string>
#include <vector>

#include "pinode/base/constants.h"

namespace pinode {

// How far the data determine a parameter.
enum class Determination {
  kDetermined,  // the 95 % interval has two ends
  kOneSided,    // it has one
  kNotHere,     // it has none: other data of this kind may give it ends
  kNotAtAll,    // the cost does not change at all: no data of this kind will
};
// "determined", "one-sided", "not determined by these data", "not determined
// at all".
const char* DeterminationName(Determination determination);

struct ParameterProfile {
  struct Point {
    double value = 0.0;
    double ratio = 0.0;  // D of profile.h
  };

  std::string name;
  std::string unit;
  double estimate = 0.0;
  // Ascending by value, the estimate among them.
  std::vector<Point> points;
  // Infinite where the likelihood ratio does not come to its threshold before a
  // bound, or far away.
  double lower95 = -kInfinity, upper95 = kInfinity;
  double lower99 = -kInfinity, upper99 = kInfinity;
  // The ratios of the 95 and 99 % intervals.
  double threshold95 = 0.0, threshold99 = 0.0;
  // The linear interval; infinite where there is none.
  double linear_lower95 = -kInfinity, linear_upper95 = kInfinity;
  Determination determination = Determination::kNotHere;
  // Where it is not determined, what the data hold on to along the way, such as
  // "a * b"; empty: nothing simple.
  std::vector<std::string> combinations;
  // A value with a lower cost than the fit's was met on the way.
  bool found_lower = false;
  // The others could not be fitted again to a minimum somewhere on the way: the
  // ratio may be smaller there, and the interval wider.
  bool unsettled = false;
  int linearizations = 0;

  // Whether an end lies elsewhere than the linear interval has it, by more than
  // a fifth of its distance from the estimate.
  bool DiffersFromLinear() const;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_PARAMETER_PROFILE_H_
