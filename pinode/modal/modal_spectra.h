// Compares the spectra of a record with those of its identified modes.

#ifndef PINODE_MODAL_MODAL_SPECTRA_H_
#define PINODE_MODAL_MODAL_SPECTRA_H_

#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/modal/response_record.h"

namespace pinode {

// One-sided densities, channels x frequencies, channel unit^2 / Hz.
struct ModalSpectra {
  Vector frequency_hz;
  Matrix measured;
  Matrix modelled;  // modes and noise
  // Part of each channel's power in the band that the modes explain. It is all
  // of the power, except for chance, if the record contains only these modes
  // and noise.
  Vector explained;
  Eigen::Index num_segments = 0;  // averaged in `measured`
};

// Fits spectra of poles and residues. With s_m the poles of the modes, the
// correlation of a channel is
//
//   R(t) = sum_m Re(a_m exp(s_m |t|)) + noise,
//
// for any spectrum of the loads that is smooth at the modes. The a_m of each
// channel and the noise (not negative) are found by least squares on its
// spectrum between lowest_hz and highest_hz. Lines are weighted by the model's
// own value there. The fit includes the widening of a peak by a segment's
// window. (This is the last step of modal identification in the frequency
// domain: P. Guillaume et al., Proc. IMAC XXI (2003), for half spectra.)
ModalSpectra FitModalSpectra(const ResponseRecord& record,
                             const std::vector<IdentifiedMode>& modes,
                             double lowest_hz, double highest_hz);

// Does the same over the bands in which `modes` were found. Empty for a free
// decay, which has no spectrum of loads.
ModalSpectra FitModalSpectra(const ResponseRecord& record,
                             const ModesOfRecord& modes);

}  // namespace pinode

#endif  // PINODE_MODAL_MODAL_SPECTRA_H_
