// Interpolation of a few missing samples in a signal that has to be complete.

#ifndef PINODE_RECORD_SHORT_GAPS_H_
#define PINODE_RECORD_SHORT_GAPS_H_

#include "pinode/base/types.h"

namespace pinode {

struct ShortGaps {
  Eigen::Index num_samples = 0;  // missing samples in short gaps
  Eigen::Index longest = 0;      // samples of the longest short gap
  // Expected root mean square over all samples of what the interpolation adds,
  // in parts of that of the signal about its mean. NaN: the signal has no
  // stretch on which the interpolation can be tried.
  double error = 0.0;
};

// Longest gap that is interpolated, in samples. Within a gap of 1, 2, 3 or 4
// samples, a sine of 20 samples a cycle is interpolated with an error of 0.2,
// 0.5, 1.1 or 2.2 %; one of 10 samples a cycle with 2.4, 7, 16 or 29 %.
constexpr Eigen::Index kMostShortGap = 3;

// Interpolates gaps of up to kMostShortGap samples (NaN) between two present
// samples on each side: by the cubic through these four. Other gaps stay.
//
// The error is measured, not assumed: complete stretches of the signal near
// each gap are interpolated likewise and compared with what was recorded there.
ShortGaps FillShortGaps(Vector* values);

}  // namespace pinode

#endif  // PINODE_RECORD_SHORT_GAPS_H_
