// Changes the sampling rate.

#ifndef PINODE_RECORD_RESAMPLE_H_
#define PINODE_RECORD_RESAMPLE_H_

#include "pinode/base/types.h"
#include "pinode/record/record.h"

namespace pinode {

// Returns the values at times k * new_step (k = 0, 1, ... up to the last
// sample) of a history sampled at multiples of `step`.
//
// The interpolation is band-limited: a sinc cut off by a Blackman window 32 of
// its zeros from the middle, with weights that add up to one,
//
//   y(t) = sum_i x_i w(t - t_i) / sum_i w(t - t_i),
//   w(s) = sinc(2 fc s) (0.42 + 0.5 cos(pi s / r) + 0.08 cos(2 pi s / r)).
//
// To the same or a higher rate, fc is the old Nyquist frequency, and old
// samples are kept. To a lower rate, fc is 0.92 of the new Nyquist frequency.
// Below 0.83 of that frequency the gain is one. Content above it is suppressed
// by 70 dB and does not alias. The phase is zero in both cases. Ends are
// extended by odd reflection. Source: J. O. Smith, P. Gossett, "A flexible
// sampling-rate conversion method", ICASSP 1984.
//
// NaN marks missing samples, in the input and the result. A new sample is
// missing if one of its two old neighbours is missing, or the old sample at the
// same time. Nearby samples see a straight line across the gap. For a history
// shorter than new_step only its first sample is returned.
Vector Resample(const Vector& values, double step, double new_step);

// Resamples all channels of a record. The start time stays.
Record ResampleRecord(const Record& record, double new_step);

}  // namespace pinode

#endif  // PINODE_RECORD_RESAMPLE_H_
