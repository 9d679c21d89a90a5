// Assessment of a problem before the fit: expected standard deviations, and
// parameters that the data do not determine.

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

// Expected standard deviation of a free named parameter, with its initial
// value. Both are in `unit`.
struct ExpectedDeviation {
  std::string name;
  std::string unit;
  double initial = 0.0;
  double sigma = 0.0;
};

// Result of AssessProblem.
struct ProblemAssessment {
  // Numbers of free parameters and of residuals.
  int num_free = 0;
  Eigen::Index num_residuals = 0;
  int num_starts = 0;  // number of unknown initial states
  // Expected standard deviation of each free named parameter, from the
  // Gauss-Newton Hessian at the initial values. It is infinite if the data do
  // not determine the parameter. The list is empty if the only data are
  // measured modes with unknown errors.
  //
  // The noise of a channel is the given one, or 5 % of the standard deviation
  // of its samples. Noise of the excitation is included if it can be fitted
  // (CanFitWithInputNoise) and the model is simulated without correction by the
  // records.
  std::vector<ExpectedDeviation> expected;
  // Combinations of named parameters that do not change the cost, one text
  // each. The cost includes the data, the priors, and the smoothness of curves
  // and unknown forces.
  std::vector<std::string> undetermined;
  // Remarks for the user on records that seem to have a wrong unit of time or a
  // wrong sign, one sentence each (TimeScaleRemarks, SignRemarks).
  std::vector<std::string> remarks;
};

// Assesses `problem`. Linearises it at its initial values, along the states
// that a smoother finds with these values. Returns false, with a sentence in
// *error, if problem or options are not valid or no finite trajectory is found.
[[nodiscard]] bool AssessProblem(const IdentificationProblem& problem,
                                 const IdentificationOptions& options,
                                 ProblemAssessment* assessment,
                                 std::string* error);

// Returns the precisions with which a fit begins, one per decay group (see
// ParameterLayout). Curves and unknown forces get precisions that keep parts
// without data close to their neighbours. Network weights get none.
Vector SmoothnessPrecisions(const ParameterLayout& layout,
                            const EvidenceTuning& tuning);

// Returns the deviations of all free named parameters. `covariance` is num_free
// x num_free. The columns of `null_space` (num_free x count) are directions
// that the data do not determine. A deviation is infinite if a parameter has at
// least 0.1 in one of these directions.
std::vector<ExpectedDeviation> ExpectedDeviations(const ParameterLayout& layout,
                                                  const Matrix& covariance,
                                                  const Matrix& null_space);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_ASSESSMENT_H_
