// Result of a likelihood profile of one parameter.

#ifndef PINODE_PROBLEM_PARAMETER_PROFILE_H_
#define PINODE_PROBLEM_PARAMETER_PROFILE_H_

#include <string>
#include <vector>

#include "pinode/base/constants.h"

namespace pinode {

// Degree to which the data determine a parameter.
enum class Determination {
  kDetermined,  // the 95 % interval has two finite ends
  kOneSided,    // it has one finite end
  kNotHere,     // it has none; more data may give it ends
  kNotAtAll,    // the cost is constant; more data of this kind do not help
};
// Returns "determined", "one-sided", "not determined by these data" or "not
// determined at all".
const char* DeterminationName(Determination determination);

// Likelihood profile of one parameter (S. A. Murphy and A. W. van der Vaart
// 2000; A. Raue et al. 2009). All values of the parameter are in `unit`.
struct ParameterProfile {
  struct Point {
    double value = 0.0;
    double ratio = 0.0;  // likelihood ratio D of profile.h
  };

  std::string name;
  std::string unit;
  double estimate = 0.0;
  // Points of the profile, ascending by value, with the estimate among them.
  std::vector<Point> points;
  // Ends of the 95 % and 99 % intervals. Infinite if the likelihood ratio does
  // not reach its threshold.
  double lower95 = -kInfinity, upper95 = kInfinity;
  double lower99 = -kInfinity, upper99 = kInfinity;
  // Thresholds of the ratio for the 95 and 99 % intervals.
  double threshold95 = 0.0, threshold99 = 0.0;
  // 95 % interval of the fit, from the linearised model. Infinite if the fit
  // has none.
  double linear_lower95 = -kInfinity, linear_upper95 = kInfinity;
  Determination determination = Determination::kNotHere;
  // Combinations such as "a * b" that stay constant along the profile of a
  // parameter that is not determined. Empty: no simple one was found.
  std::vector<std::string> combinations;
  // True if the profile has found a lower cost than the fit.
  bool found_lower = false;
  // True if the fit of the other parameters did not reach a minimum at some
  // point. The true ratio may be smaller there, and the interval wider.
  bool unsettled = false;
  // Number of linearisations that the profile has needed.
  int linearizations = 0;

  // True if an end of the 95 % interval is far from that of the linear
  // interval. The limit is 20 % of the end's distance from the estimate.
  bool DiffersFromLinear() const;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_PARAMETER_PROFILE_H_
