// Spectra of a record beside those of the modes that were found in it.

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
  // What part of each channel's power in the band is that of the modes; in all
  // of it but for chance where they are all there is beside noise.
  Vector explained;
  Eigen::Index num_segments = 0;  // that `measured` is the mean of
};

// Poles and their residues: with s_m the poles of the modes the correlation of
// a channel is
//
//   R(t) = sum_m Re(a_m exp(s_m |t|)) + noise,
//
// whatever the spectrum of the loads, as long as it is smooth at the modes. The
// a_m of each channel and the noise, no less than zero, are found by least
// squares on its spectrum between lowest_hz and highest_hz, lines weighted by
// what the model itself has there; that a segment's window widens a peak is
// taken into account. (The last step of modal identification in the frequency
// domain: P. Guillaume et al., Proc. IMAC XXI (2003), for half spectra.)
ModalSpectra FitModalSpectra(const ResponseRecord& record,
                             const std::vector<IdentifiedMode>& modes,
                             double lowest_hz, double highest_hz);

// The same over the bands that `modes` were found in. Empty for a free decay:
// there is no spectrum of loads.
ModalSpectra FitModalSpectra(const ResponseRecord& record,
                             const ModesOfRecord& modes);

}  // namespace pinode

#endif  // PINODE_MODAL_MODAL_SPECTRA_H_
