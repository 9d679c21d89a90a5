// First mode of a building as its records show it: frequency, and sensors that
// are upside down.

#ifndef PINODE_CASE_DRAFT_FIRST_MODE_H_
#define PINODE_CASE_DRAFT_FIRST_MODE_H_

#include <vector>

#include "pinode/base/types.h"

namespace pinode {

struct FirstMode {
  // Frequency of the first mode; 0: no peak was found.
  double hz = 0.0;
  // Peaks in the band, Hz, ascending; `hz` is the lowest.
  std::vector<double> peaks;
  // For each channel, true if it moves against most of the others in this mode.
  std::vector<bool> is_reversed;
  // True if all floors move as if the base's sensor were upside down.
  bool is_base_reversed = false;
};

// Finds the first mode of a shear building from the accelerations of floors,
// channels x samples, absolute and in one unit, and that of the base, which is
// empty if it was not measured. NaN: missing.
//
// With a base: the peaks of sum_c |H_c(f)|^2, H_c being the transfer function
// from the base to the acceleration of floor c relative to it, S_cb / S_bb by
// Welch's method. At the first peak all H_c have the phase -90 degrees (A. K.
// Chopra, Dynamics of Structures, section 3.2). Without: the peaks of the sum
// of the floors' spectral densities, and the phases of the cross spectra with
// the last channel.
FirstMode FindFirstMode(const Matrix& floors, const Vector& base, double step);

}  // namespace pinode

#endif  // PINODE_CASE_DRAFT_FIRST_MODE_H_
