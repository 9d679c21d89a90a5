// Forces that nobody measured: their histories and how sure they are.

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

// Precisions for the bands of forces with a smoothness of its own for each
// neighbourhood of knots. The evidence takes each second difference as known to
// be about as large as it came out, and many as none at all: a band from that
// is far too narrow where a force strikes, between the samples above all. So
// there every variance is the mean of those within `tuning.pooled_samples`
// samples. `decays`: per decay group of the layout, as is what comes back.
Vector BandDecays(const IdentificationProblem& problem,
                  const ParameterLayout& layout, const Vector& decays,
                  const ForceBandTuning& tuning);

// Unknown forces in the dynamics' order, then networks of time, an entry per
// output, with bands of `quantile` standard deviations,
//
//   sigma(t)^2 = g(t)' covariance g(t),   g = d force / d parameters.
//
// `covariance` of all free parameters; empty: there is none, and sigma is
// infinite. `parameters`: all of the problem's.
std::vector<ForceEstimate> EstimateForces(const IdentificationProblem& problem,
                                          const ParameterLayout& layout,
                                          const Vector& parameters,
                                          const Matrix& covariance,
                                          double quantile);

}  // namespace pinode

#endif  // PINODE_ESTIMATE_CERTAINTY_FORCE_BANDS_H_
