// Search for the modes of frequency response functions.

#ifndef PINODE_MODAL_FRF_FRF_SEARCH_H_
#define PINODE_MODAL_FRF_FRF_SEARCH_H_

#include <vector>

#include "pinode/modal/frf/frf_data.h"
#include "pinode/modal/frf/frf_fit.h"
#include "pinode/modal/frf/frf_model.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/modal/stabilisation.h"

namespace pinode {

// A mode that stable poles suggest.
struct FrfCandidate {
  PoleCluster cluster;
  FrfMode mode;
  std::vector<int> places;  // of its poles in the band
};

// Finds candidates among the poles of orders 2, 4, ... max_order, which are
// added to the band.
std::vector<FrfCandidate> FindFrfCandidates(
    const FrfData& data, const ModeIdentificationOptions& options,
    AnalysedBand* band);

// Modes that the data need.
struct FrfSearchResult {
  std::vector<size_t> kept;  // indices of candidates, as in fit.modes
  FrfFit fit;
  FrfNoise noise;
  bool complex_residuals = false;
};

// Fits the candidates together, and removes those that explain no more than
// noise near their frequency, one at a time. The probability is 1e-3 that noise
// is taken for a mode anywhere. Of two modes with one frequency and shape the
// weaker is removed, and those outside of the limits are. Residuals become
// complex if that raises the likelihood by more than their number explains
// (Schwarz' criterion).
FrfSearchResult FitFrfCandidates(const std::vector<FrfCandidate>& candidates,
                                 const AnalysedBand& band,
                                 const StabilisationOptions& options,
                                 FrfModel* model);

}  // namespace pinode

#endif  // PINODE_MODAL_FRF_FRF_SEARCH_H_
