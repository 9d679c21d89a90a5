// Measured inputs of a structure (ground accelerations, forces), at any time.

#ifndef PINODE_RECORD_EXCITATION_H_
#define PINODE_RECORD_EXCITATION_H_

#include <memory>
#include <string>

#include "pinode/base/types.h"

namespace pinode {

struct Channel;
struct Record;

// Interpolation of an input between two samples. The user states it; it is
// never guessed. Held instead of linear moves an identified stiffness by one
// per cent.
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
// Parses such a name. Returns false, with *interpolation unchanged, for any
// other.
[[nodiscard]] bool ParseInterpolation(const std::string& name,
                                      Interpolation* interpolation);

// Uniformly sampled inputs. A time is given by its sample interval and the
// fraction of that interval. Integrators step inside intervals. A held input
// must keep the left sample up to the interval's right end, where the next
// interval begins with another value.
class Excitation {
 public:
  // `samples` is inputs x samples, and sample i is at start_time + i * step. No
  // inputs (0 rows) are allowed. The constructor checks nothing.
  // IdentificationProblem::IsValid checks that numbers are finite, that the
  // step is positive and that there are samples. With `periodic` the samples
  // are whole periods, and the first sample follows the last one. Otherwise the
  // last values hold.
  Excitation(double start_time, double step, Matrix samples,
             Interpolation interpolation, bool periodic = false);

  // Computes the inputs at start_time + (interval + fraction) * step, 0 <=
  // fraction <= 1, into inputs[0 .. num_inputs()). Allocates no memory.
  void Evaluate(Eigen::Index interval, double fraction, double* inputs) const;

  int num_inputs() const { return static_cast<int>(samples_->rows()); }
  Eigen::Index num_samples() const { return samples_->cols(); }
  double start_time() const { return start_time_; }
  double step() const { return step_; }
  double time(Eigen::Index sample) const {
    return start_time_ + static_cast<double>(sample) * step_;
  }
  Interpolation interpolation() const { return interpolation_; }
  bool periodic() const { return periodic_; }
  // Returns the number of samples on either side of an instant that affect its
  // value.
  int reach() const;
  // Returns the samples, inputs x samples.
  const Matrix& samples() const { return *samples_; }
  // Returns the same samples, which copies share.
  const std::shared_ptr<const Matrix>& shared_samples() const {
    return samples_;
  }

 private:
  // Adds sample number `sample` times `weight` to *result. Numbers beyond both
  // ends mean the extended samples.
  template <typename Target>
  void AddSample(Eigen::Index sample, double weight, Target* result) const;

  double start_time_;
  double step_;
  std::shared_ptr<const Matrix> samples_;
  Interpolation interpolation_;
  bool periodic_;
};

// Checks that no sample of the channel is missing. A response may have gaps. An
// excitation may not, because the structure responded to it. On failure *error
// names the record, the channel and the times of the first gap.
[[nodiscard]] bool IsCompleteExcitation(const Record& record,
                                        const Channel& channel,
                                        std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_EXCITATION_H_
