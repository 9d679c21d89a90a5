// Assessment of a problem before it is solved.

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

// Expected standard deviation of a free named parameter.
struct ExpectedDeviation {
  std::string name;
  std::string unit;
  double initial = 0.0;
  double sigma = 0.0;
};

struct ProblemAssessment {
  int num_free = 0;
  Eigen::Index num_residuals = 0;
  int num_starts = 0;  // number of unknown states at record starts
  // Expected standard deviation of each free named parameter, from the
  // Gauss-Newton Hessian at the initial values. The noise is as given, or 5 %
  // of a channel's spread. Noise of the excitation is included if it can be
  // fitted (CanFitWithInputNoise) and the model runs freely. Infinite if the
  // data do not determine the parameter. Empty if there are only measured modes
  // with unknown errors.
  std::vector<ExpectedDeviation> expected;
  // Directions of named parameters along which the cost does not change. The
  // cost includes the data, the priors, and the smoothness of curves and
  // unknown forces.
  std::vector<std::string> undetermined;
  // Remarks on the records for the user, one sentence each (TimeScaleRemarks,
  // SignRemarks).
  std::vector<std::string> remarks;
};

// Linearises `problem` at its initial values, on states that the smoother finds
// there. Returns false, with a sentence in *error, if problem or options are
// not valid or there is no finite trajectory.
[[nodiscard]] bool AssessProblem(const IdentificationProblem& problem,
                                 const IdentificationOptions& options,
                                 ProblemAssessment* assessment,
                                 std::string* error);

// Returns the initial smoothness precisions of curves and unknown forces, one
// per decay group, as in the fit. Parts that no data reach follow their
// neighbours. Weights of networks are left to the data.
Vector SmoothnessPrecisions(const ParameterLayout& layout,
                            const EvidenceTuning& tuning);

// Returns the deviations of all free named parameters. A deviation is infinite
// if a direction of `null_space` (num_free x count) contains a tenth or more of
// its parameter. `covariance`: num_free x num_free.
std::vector<ExpectedDeviation> ExpectedDeviations(const ParameterLayout& layout,
                                                  const Matrix& covariance,
                                                  const Matrix& null_space);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_ASSESSMENT_H_
