// Unknown forces: their histories and uncertainties.

#ifndef PINODE_ESTIMATE_CERTAINTY_FORCE_BANDS_H_
#define PINODE_ESTIMATE_CERTAINTY_FORCE_BANDS_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/tuning.h"

namespace pinode {

// Returns precisions for the bands of forces with separate smoothness for each
// neighbourhood of knots. The evidence takes each second difference to be about
// as large as estimated, and many to be zero. Bands from that are far too
// narrow where a force strikes, above all between the samples. Therefore each
// variance becomes the mean of those within `tuning.pooled_samples` samples.
// `decays` and the result: one per decay group of the layout.
Vector BandDecays(const IdentificationProblem& problem,
                  const ParameterLayout& layout, const Vector& decays,
                  const ForceBandTuning& tuning);

// Returns unknown forces in the dynamics' order, then networks of time, one
// entry per output, with bands of `quantile` standard deviations,
//
//   sigma(t)^2 = g(t)' covariance g(t),   g = d force / d parameters.
//
// `covariance`: of all free parameters; if it is empty, sigma is infinite.
// `parameters`: all of the problem's.
std::vector<ForceEstimate> EstimateForces(const IdentificationProblem& problem,
                                          const ParameterLayout& layout,
                                          const Vector& parameters,
                                          const Matrix& covariance,
                                          double quantile);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_FORCE_BANDS_H_
