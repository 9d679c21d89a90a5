// Measured inputs of a structure, such as ground accelerations and forces, at
// any time.

#ifndef PINODE_RECORD_EXCITATION_H_
#define PINODE_RECORD_EXCITATION_H_

#include <memory>
#include <string>

#include "pinode/base/types.h"

namespace pinode {

struct Channel;
struct Record;

// Interpolation of an input between two samples. The user must state it,
// because the wrong one changes the result: with kHeld in place of kLinear, an
// identified stiffness may change by 1 %.
//
//   held    the left sample, up to the next one
//   linear  the straight line
//   cubic   Catmull-Rom: the cubic with slopes (u_(i+1) - u_(i-1)) / 2 per
//           step; the end samples are repeated outside, as in Ceres'
//           CubicInterpolator
//   band_limited  the signal with these samples, as behind a logger's
//           anti-aliasing filter: 64 samples weighted by a sinc in a Kaiser
//           window, exact to 2e-5 of the amplitude below 0.88 of half the
//           sampling rate. The signal is mirrored at the end samples. For a
//           signal that is not periodic this causes errors within 32 samples
//           of an end.
enum class Interpolation { kHeld, kLinear, kCubic, kBandLimited };

// Returns "held", "linear", "cubic" or "band_limited".
const char* InterpolationName(Interpolation interpolation);
// Parses such a name. For any other text returns false and leaves
// *interpolation unchanged.
[[nodiscard]] bool ParseInterpolation(const std::string& name,
                                      Interpolation* interpolation);

// Uniformly sampled inputs. An instant is given by its sample interval and a
// fraction of this interval, because integrators step inside intervals. At the
// right end of an interval a held input still has the left sample. The next
// interval begins with the next sample.
class Excitation {
 public:
  // Creates the excitation. `samples` is inputs x samples, in any units; 0 rows
  // are allowed. Sample i is at start_time + i * step, with both in one unit of
  // time. If `periodic` is true, the samples are whole periods, and the first
  // sample follows the last one. Otherwise the last values hold.
  //
  // The constructor checks nothing. IdentificationProblem::IsValid checks that
  // numbers are finite, that the step is positive and that there are samples.
  Excitation(double start_time, double step, Matrix samples,
             Interpolation interpolation, bool periodic = false);

  // Computes the inputs at start_time + (interval + fraction) * step, with 0 <=
  // fraction <= 1. `inputs` has num_inputs() entries. Allocates no memory.
  void Evaluate(Eigen::Index interval, double fraction, double* inputs) const;

  // Values that were given to the constructor.
  int num_inputs() const { return static_cast<int>(samples_->rows()); }
  Eigen::Index num_samples() const { return samples_->cols(); }
  double start_time() const { return start_time_; }
  double step() const { return step_; }
  // Time of a sample, counted from 0.
  double time(Eigen::Index sample) const {
    return start_time_ + static_cast<double>(sample) * step_;
  }
  Interpolation interpolation() const { return interpolation_; }
  bool periodic() const { return periodic_; }
  // Number of samples on either side of an instant that affect the value there.
  int reach() const;
  // Samples, inputs x samples.
  const Matrix& samples() const { return *samples_; }
  // Pointer to the same samples, which copies of this object share.
  const std::shared_ptr<const Matrix>& shared_samples() const {
    return samples_;
  }

 private:
  // Adds `weight` times a sample to *result. Numbers beyond the ends stand for
  // extended samples.
  template <typename Target>
  void AddSample(Eigen::Index sample, double weight, Target* result) const;

  double start_time_;
  double step_;
  std::shared_ptr<const Matrix> samples_;
  Interpolation interpolation_;
  bool periodic_;
};

// Checks that no sample of the channel is missing. A response may have gaps. An
// excitation may not, because the structure also responds to it in the gap. On
// failure returns false, and *error names the record, the channel and the times
// of the first gap.
[[nodiscard]] bool IsCompleteExcitation(const Record& record,
                                        const Channel& channel,
                                        std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_EXCITATION_H_
