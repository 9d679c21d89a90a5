// Tells modes under measured loads from poles that explain nothing, and fits
// them together.

#ifndef PINODE_MODAL_FORCED_FIT_H_
#define PINODE_MODAL_FORCED_FIT_H_

#include <complex>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/forced_model.h"

namespace pinode {

// A pole from which a mode may be found.
struct ForcedCandidate {
  std::complex<double> s;
  double reach = 0.0;  // distance from s within which the mode must lie, 1 / s
};

struct ForcedPoles {
  std::vector<size_t> kept;  // indices of candidates, as in fit.s
  ForcedFit fit;
  // True if the residuals have a peak at a pole: loads that are not measured
  // excite the structure.
  bool has_peak = false;
};

// Finds the candidates that the data need, and refines them together. A
// candidate is needed if one of these holds:
//
// - Without it the responses to the loads and to the start explain less, by
//   more than noise near its frequency explains. The probability is 1e-3 that
//   noise is taken for a mode anywhere in the record. The other poles move to
//   compensate, so poles that are inexact or doubled are not needed.
// - Without it the residuals have a peak at its frequency: loads that are not
//   measured excite it.
//
// If two poles have one frequency and shape, the one that explains less is
// removed. Sets the weights of the model: by the noise of the channels, and, if
// it changes, by the noise over frequency.
ForcedPoles FindForcedPoles(const std::vector<ForcedCandidate>& candidates,
                            ForcedModel* model);

}  // namespace pinode

#endif  // PINODE_MODAL_FORCED_FIT_H_
