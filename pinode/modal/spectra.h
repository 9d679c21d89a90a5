// Spectral densities of a record.

#ifndef PINODE_MODAL_SPECTRA_H_
#define PINODE_MODAL_SPECTRA_H_

#include "pinode/base/types.h"
#include "pinode/modal/response_record.h"

namespace pinode {

// One-sided spectral densities, by frequency.
struct Spectra {
  Vector frequency_hz;
  // Spectral densities, channels x frequencies, channel unit^2 / Hz.
  Matrix densities;
  // Singular values of the matrix of spectral densities, largest first; 1 / Hz.
  // Each channel is divided by its standard deviation. The first value peaks at
  // a mode. If the second peaks with it, there are two modes (R. Brincker, L.
  // Zhang, P. Andersen, Smart Mater. Struct. 10 (2001) 441).
  Matrix singular_values;
  // Number of averaged segments of the record. They overlap by half.
  Eigen::Index num_segments = 0;
};

// Estimates spectra by Welch's method: Hann's window, segments of
// `segment_samples` (a power of two; 0: at most the record's length divided by
// 32, 256 to 8192). Means are removed, and missing samples are set to the mean.
// Returns at most `num_singular_values` singular values.
Spectra EstimateSpectra(const ResponseRecord& record,
                        Eigen::Index segment_samples, int num_singular_values);

}  // namespace pinode

#endif  // PINODE_MODAL_SPECTRA_H_
