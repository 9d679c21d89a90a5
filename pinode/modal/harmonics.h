// Tells harmonics of machines from modes of a structure under ambient loads.

#ifndef PINODE_MODAL_HARMONICS_H_
#define PINODE_MODAL_HARMONICS_H_

#include "pinode/base/types.h"

namespace pinode {

// Vibration of a record in a narrow band around one frequency.
struct NarrowBand {
  // Share of the power in the band that one sine of constant amplitude and
  // phase explains. 1: a sine.
  double coherence = 0.0;
  // Kurtosis of the band's vibration: 1.5 for a sine, 3 for a random vibration.
  double kurtosis = 0.0;
};

// Looks at the motion with this shape (channels): Hann windows of a twelfth of
// the record, each half over the next, each with its amplitude and phase. The
// sine's frequency is the one in the band that explains most. samples: channels
// x samples, of mean zero; NaN: missing, counts as zero.
NarrowBand FindNarrowBand(const Matrix& samples, double step,
                          const ComplexVector& shape, double frequency_hz);

// Returns true if the band holds a sine of constant amplitude.
bool IsSine(const NarrowBand& band);

}  // namespace pinode

#endif  // PINODE_MODAL_HARMONICS_H_
