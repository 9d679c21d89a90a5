// Change of sampling rate.

#ifndef PINODE_RECORD_RESAMPLE_H_
#define PINODE_RECORD_RESAMPLE_H_

#include "pinode/base/types.h"
#include "pinode/record/record.h"

namespace pinode {

// Values at times k * new_step (k = 0, 1, ... up to the last sample) of a
// history sampled at multiples of `step`.
//
// Band-limited interpolation: a sinc cut off by a Blackman window 32 of its
// zeros from the middle, with weights that add up to one,
//
//   y(t) = sum_i x_i w(t - t_i) / sum_i w(t - t_i),
//   w(s) = sinc(2 fc s) (0.42 + 0.5 cos(pi s / r) + 0.08 cos(2 pi s / r)).
//
// To a higher or the same rate fc is the old Nyquist frequency: old samples
// are kept as they are. To a lower rate fc is 0.92 of the new one: below 0.83
// of it the gain is one, what lies above it is suppressed by 70 dB instead of
// being folded into the band. Zero phase in both cases. Ends are continued by
// odd reflection. Source: J. O. Smith, P. Gossett, "A flexible sampling-rate
// conversion method", ICASSP 1984.
//
// NaN marks missing samples, in and out: a new sample is missing if one of the
// two old ones around it is (or the old one at its very time). Nearby samples
// see a straight line across the gap. Of a history shorter than new_step its
// first sample is left.
Vector Resample(const Vector& values, double step, double new_step);

// All channels of a record; the start time stays.
Record ResampleRecord(const Record& record, double new_step);

}  // namespace pinode

#endif  // PINODE_RECORD_RESAMPLE_H_
