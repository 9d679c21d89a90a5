// Measured inputs of a structure (ground accelerations, forces), at any time.

#ifndef PINODE_RECORD_EXCITATION_H_
#define PINODE_RECORD_EXCITATION_H_

#include <memory>
#include <string>

#include "pinode/base/types.h"

namespace pinode {

struct Channel;
struct Record;

// What an input is taken to do between two samples. It is stated, never
// guessed: held against linear alone moves an identified stiffness by a per
// cent.
//   held    the left sample, up to the next one
//   linear  the straight line
//   cubic   Catmull-Rom: the cubic with slopes (u_(i+1) - u_(i-1)) / 2 per
//   step;
//           the end samples are repeated outside, as in Ceres'
//           CubicInterpolator
//   band_limited  the signal of which these are the samples, as a logger behind
//           an anti-aliasing filter leaves them: 64 samples weighed by a sinc
//           in a Kaiser window, exact to 2e-5 of the amplitude of what is below
//           0.88 of half the sampling rate. Beyond the end samples it is
//           mirrored at them, which shows within 32 samples of an end of what
//           is not periodic.
enum class Interpolation { kHeld, kLinear, kCubic, kBandLimited };

// "held", "linear", "cubic" or "band_limited".
const char* InterpolationName(Interpolation interpolation);
// False, with *interpolation untouched, if the name is another.
[[nodiscard]] bool ParseInterpolation(const std::string& name,
                                      Interpolation* interpolation);

// Uniformly sampled inputs. Time is addressed by sample interval and fraction
// of it rather than as one number: integrators step inside intervals, and a
// held input must keep the left sample up to the interval's right end, where
// the next interval begins with another value.
class Excitation {
 public:
  // `samples` is inputs x samples; sample i is at start_time + i * step. No
  // inputs (0 rows) are allowed. It holds whatever it is given: that numbers
  // are finite, the step positive and samples there is asked by
  // IdentificationProblem::IsValid. `periodic`: the samples are whole periods,
  // behind the last one comes the first again; for the others the last values
  // hold.
  Excitation(double start_time, double step, Matrix samples,
             Interpolation interpolation, bool periodic = false);

  // Inputs at start_time + (interval + fraction) * step, 0 <= fraction <= 1,
  // into inputs[0 .. num_inputs()). Allocates nothing.
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
  // How many samples on either side of an instant take part in its value.
  int reach() const;
  // inputs x samples.
  const Matrix& samples() const { return *samples_; }
  // The same, which copies share.
  const std::shared_ptr<const Matrix>& shared_samples() const {
    return samples_;
  }

 private:
  // The samples as they go on beyond both ends.
  template <typename Target>
  void AddSample(Eigen::Index sample, double weight, Target* result) const;

  double start_time_;
  double step_;
  std::shared_ptr<const Matrix> samples_;
  Interpolation interpolation_;
  bool periodic_;
};

// False if a sample of the channel is missing: a response may have gaps, an
// excitation may not, for the structure felt it. *error names record, channel
// and the times of the first gap.
[[nodiscard]] bool IsCompleteExcitation(const Record& record,
                                        const Channel& channel,
                                        std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_EXCITATION_H_
