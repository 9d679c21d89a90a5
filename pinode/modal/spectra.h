// Spectral densities of a record.

#ifndef PINODE_MODAL_SPECTRA_H_
#define PINODE_MODAL_SPECTRA_H_

#include "pinode/base/types.h"
#include "pinode/modal/response_record.h"

namespace pinode {

// One-sided spectral densities, by frequency.
struct Spectra {
  Vector frequency_hz;
  // channels x frequencies, channel unit^2 / Hz.
  Matrix densities;
  // Singular values of the matrix of spectral densities of the channels, each
  // divided by its standard deviation, largest first; 1 / Hz. The first rises
  // where a mode is; where a second rises with it, there are two (R. Brincker,
  // L. Zhang, P. Andersen, Smart Mater. Struct. 10 (2001) 441).
  Matrix singular_values;
  // Segments of the record that they are means of (half over the next).
  Eigen::Index num_segments = 0;
};

// Welch's method: Hann's window, segments of `segment_samples` (a power of two;
// 0: the record's length by 32 at the most, 256 to 8192), means removed,
// missing samples taken as the mean. At most `num_singular_values` of these.
Spectra EstimateSpectra(const ResponseRecord& record,
                        Eigen::Index segment_samples, int num_singular_values);

}  // namespace pinode

#endif  // PINODE_MODAL_SPECTRA_H_
