// Zero-phase Butterworth filters.

#ifndef PINODE_RECORD_FILTER_H_
#define PINODE_RECORD_FILTER_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

enum class FilterType { kLowPass, kHighPass, kBandPass };

// Options of a Butterworth filter.
struct FilterOptions {
  FilterType type = FilterType::kLowPass;
  // Corner frequencies in cycles per unit of time: one for low and high pass,
  // two (lower, upper) for band pass. At a corner the gain is 1/2, because each
  // of the two passes has the gain 1/sqrt(2).
  std::vector<double> corner_frequencies;
  // Order of one pass, 1 to 10. A band pass has twice as many poles.
  int order = 4;

  // Checks the order, and that corners ascend and are between 0 and half the
  // sampling rate. `sampling_step` is in the same unit of time. On failure
  // returns false, with the reason in *error.
  [[nodiscard]] bool IsValid(double sampling_step, std::string* error) const;
};

// Butterworth filter that runs forward and backward over a time history. This
// cancels its phase and squares its gain. A low pass of order n with the corner
// frequency fc has
//
//   gain(f) = 1 / (1 + W(f)^(2 n)),   W = tan(pi f dt) / tan(pi fc dt)
//
// with dt the sampling step. The usual mappings of W give high pass and band
// pass. Each pass is a cascade of second-order sections, from the analog
// prototype by the bilinear transform with prewarped corners.
//
// The history is extended at both ends by its odd reflection about the end
// sample, 2 x(0) - x(k). Each pass starts in the steady state of its first
// sample, as SciPy's sosfiltfilt does. The reflection is as long as there, or
// as long as possible for a short history.
//
// The result is a linear function of the history, also at its ends. Filtering
// therefore commutes with sums, factors and derivatives with respect to
// parameters.
class ZeroPhaseFilter {
 public:
  // Creates the filter. `options` must be valid for `sampling_step`.
  ZeroPhaseFilter(const FilterOptions& options, double sampling_step);

  // Filters a history, or each column of a matrix (samples x histories), in
  // place. All values must be finite.
  void Apply(Vector* values) const;
  void Apply(Matrix* columns) const;

  // Returns the gain of both passes together for a long sine of this frequency,
  // in cycles per unit of time.
  double Gain(double frequency) const;

  // Number of samples by which each end of the history is extended.
  int padding() const { return padding_; }

 private:
  // One section: y_i = b0 x_i + b1 x_(i-1) + b2 x_(i-2) - a1 y_(i-1) - a2
  // y_(i-2).
  struct Section {
    double b0, b1, b2, a1, a2;
    // Steady state (direct form II transposed) of this section for a constant
    // input of 1 into the *cascade*.
    double state1, state2;
  };

  template <int kNumLanes>
  void Filter(double* columns, Eigen::Index num_samples,
              Eigen::Index stride) const;
  template <int kNumLanes>
  void Pass(double* work, Eigen::Index size, int direction) const;
  void ApplyToColumns(double* columns, Eigen::Index num_samples,
                      Eigen::Index num_columns) const;

  double sampling_step_;
  std::vector<Section> sections_;
  int padding_ = 0;
};

}  // namespace pinode

#endif  // PINODE_RECORD_FILTER_H_
