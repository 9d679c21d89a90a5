// What a problem can tell before it is solved.

#ifndef PINODE_ESTIMATE_CERTAINTY_ASSESSMENT_H_
#define PINODE_ESTIMATE_CERTAINTY_ASSESSMENT_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/tuning.h"

namespace pinode {

// What a free named parameter is expected to be found within.
struct ExpectedDeviation {
  std::string name;
  std::string unit;
  double initial = 0.0;
  double sigma = 0.0;
};

struct ProblemAssessment {
  int num_free = 0;
  Eigen::Index num_residuals = 0;
  int num_starts = 0;  // unknown states at record starts
  // Expected standard deviation of each free named parameter from the
  // Gauss-Newton Hessian at the initial values, with the noise given or 5 % of
  // a channel's spread; noise of the excitation included where it can be fitted
  // (CanFitWithInputNoise) and the model runs freely. Infinite where the data
  // do not determine it. Empty where there are only measured modes whose errors
  // are not known.
  std::vector<ExpectedDeviation> expected;
  // Directions of named parameters along which the cost does not change: data,
  // priors, and what keeps curves and unknown forces smooth.
  std::vector<std::string> undetermined;
  // What a user should hear of the records, one sentence each
  // (TimeScaleRemarks, SignRemarks).
  std::vector<std::string> remarks;
};

// Linearises `problem` at its initial values, on states that the smoother finds
// there. False, with a sentence, where problem or options are not valid or no
// finite trajectory is found.
[[nodiscard]] bool AssessProblem(const IdentificationProblem& problem,
                                 const IdentificationOptions& options,
                                 ProblemAssessment* assessment,
                                 std::string* error);

// First precisions of what keeps curves and unknown forces smooth, one per
// decay group, as the fit has them: what no data reach follows from its
// neighbours. Networks' weights are left to the data.
Vector SmoothnessPrecisions(const ParameterLayout& layout,
                            const EvidenceTuning& tuning);

// Of all free named parameters; infinite where a direction of `null_space`
// (num_free x count) has a tenth or more of one. `covariance`: num_free x
// num_free.
std::vector<ExpectedDeviation> ExpectedDeviations(const ParameterLayout& layout,
                                                  const Matrix& covariance,
                                                  const Matrix& null_space);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_ASSESSMENT_H_
