// Delays that are too large for a step from no delay.

#ifndef PINODE_STUDY_EXPLANATIONS_LIKELY_DELAYS_H_
#define PINODE_STUDY_EXPLANATIONS_LIKELY_DELAYS_H_

#include <cstddef>
#include <vector>

#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/study/explanations/suspect.h"

namespace pinode {

struct LikelyDelay {
  size_t suspect = 0;  // a delay, of all sensors or of one
  double delay = 0.0;  // model's unit of time; positive: the sensors are late
  // Largest delay that was tried, either way.
  double widest = 0.0;
  // Mean correlation of measured and simulated channels with this delay, and
  // without one.
  double correlation = 0.0;
  double without = 0.0;
};

// Returns delays with which the measured channels agree clearly better with a
// simulation, best first. A delay beyond a quarter of a period is behind a hill
// of the cost: a fit that begins without it ends in another valley. With the
// channels y_c and their simulation p_c, the delay d of all sensors has
//
//   mean over c of  sum_t y_c(t) p_c(t - d) / (|y_c| |p_c|)
//
// and that of one sensor its own term. Simulations are those of the initial
// model and of the fit (`fit`). Delays reach over 50 samples or two periods of
// the lowest mode, either way, and at most over a quarter of a record. Single
// sensors are looked at where no delay of all of them is likely.
std::vector<LikelyDelay> FindLikelyDelays(const IdentificationProblem& problem,
                                          const FitSummary& fit,
                                          const std::vector<Suspect>& suspects);

}  // namespace pinode

#endif  // PINODE_STUDY_EXPLANATIONS_LIKELY_DELAYS_H_
