// Curve of periodic responses over the frequency of the input.

#ifndef PINODE_INTEGRATE_PERIODIC_RESPONSE_CURVE_H_
#define PINODE_INTEGRATE_PERIODIC_RESPONSE_CURVE_H_

#include <functional>
#include <string>

#include "pinode/base/types.h"
#include "pinode/integrate/periodic/harmonic_balance.h"

namespace pinode {

// One periodic response.
struct PeriodicResponse {
  double omega = 0.0;
  // Coefficients of the states as in HarmonicBalance.
  Matrix states;
  // Relative size of the harmonics that were left out.
  double neglected = 0.0;
  // See HarmonicBalance::LargestMultiplier.
  double largest_multiplier = 0.0;
};

struct ResponseCurveOptions {
  // First and last angular frequency, both positive. The curve may turn back in
  // between, where several responses belong to one frequency.
  double from = 0.0;
  double to = 0.0;
  // Number of points if the curve does not turn back; at least 2.
  int num_points = 200;
  // Harmonics at first and at most. Their number is doubled where the next ones
  // would change the response by more than `tolerance`, relative.
  int harmonics = 7;
  int most_harmonics = 63;
  double tolerance = 1e-6;
  // Called with each point of the curve. The curve ends if it returns false.
  std::function<bool(const PeriodicResponse&)> each;
};

// Follows the periodic responses from options.from to options.to by
// pseudo-arclength continuation (H. B. Keller 1977), also around the points at
// which the curve turns back. Returns false with a sentence in *error if it
// cannot begin, or cannot go on.
[[nodiscard]] bool FollowResponseCurve(const ResponseCurveOptions& options,
                                       HarmonicBalance* balance,
                                       std::string* error);

}  // namespace pinode

#endif  // PINODE_INTEGRATE_PERIODIC_RESPONSE_CURVE_H_
