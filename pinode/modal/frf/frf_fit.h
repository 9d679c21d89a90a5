// Maximum likelihood of a modal model of frequency response functions.

#ifndef PINODE_MODAL_FRF_FRF_FIT_H_
#define PINODE_MODAL_FRF_FRF_FIT_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/frf/frf_model.h"

namespace pinode {

// Noise of the FRFs. Its variance at a line is floor_o + share_o |H|^2 for
// output o, with H of the model.
struct FrfNoise {
  Vector floors;     // per output, square of its unit
  Vector shares;     // per output; zero: the noise is the same at all lines
  bool even = true;  // all shares are zero
  double log_likelihood = 0.0;
};

// Estimates the noise from what a fit leaves, corrected for what it has taken
// in. Shares are estimated, by maximum likelihood, if they raise the likelihood
// by more than their number explains (Schwarz' criterion). They are not if the
// residuals are smooth from line to line: those are errors of the model, which
// are largest at resonances. Variances of correlated lines are increased by
// (1 + r) / (1 - r), with r the correlation of neighbours, so that intervals
// count only what is independent. *variances: lines x pairs.
FrfNoise EstimateFrfNoise(const FrfModel& model, const FrfFit& fit,
                          Matrix* variances);

// Fits the modes by maximum likelihood: by Levenberg-Marquardt under given
// variances, which are then estimated anew, until they stay. `start`: at least
// one mode. `fresh`: the first variances are what the start leaves, not those
// of the model. Sets the model's variances.
FrfFit FitFrfModes(const std::vector<FrfMode>& start, bool fresh,
                   FrfModel* model, FrfNoise* noise);

}  // namespace pinode

#endif  // PINODE_MODAL_FRF_FRF_FIT_H_
