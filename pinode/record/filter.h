// Zero-phase Butterworth filters.

#ifndef PINODE_RECORD_FILTER_H_
#define PINODE_RECORD_FILTER_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

enum class FilterType { kLowPass, kHighPass, kBandPass };

struct FilterOptions {
  FilterType type = FilterType::kLowPass;
  // Corner frequencies in cycles per unit of time: one for low and high pass,
  // two (lower, upper) for band pass. The one-way gain there is 1/sqrt(2), so
  // the gain of the filter is 1/2.
  std::vector<double> corner_frequencies;
  // Order of the one-way filter (a band pass has twice as many poles).
  int order = 4;

  // Checks that corners are inside (0, Nyquist) and in order, and that the
  // order is 1 to 10. On failure *error gives the reason.
  [[nodiscard]] bool IsValid(double sampling_step, std::string* error) const;
};

// Runs a Butterworth filter forward and backward over a time history, which
// cancels its phase and squares its gain:
//
//   gain(f) = 1 / (1 + W(f)^(2 n)),   W = tan(pi f dt) / tan(pi fc dt)
//
// for the low pass of order n with corner fc (for the others W is mapped the
// usual way). The one-way filter is a cascade of second-order sections. It
// comes from the analog prototype by the bilinear transform with prewarped
// corners.
//
// Ends: both sides are extended by the odd reflection about the end sample, 2
// x(0) - x(k). Each pass starts in the steady state of its first sample.
// Source: F. Gustafsson, "Determining the initial states in forward-backward
// filtering", IEEE Trans. Signal Processing 44 (1996) 988. The reflection's
// length is that of SciPy's sosfiltfilt, or the longest possible one for a
// short history.
//
// The result is a linear function of the history, including its ends: filtering
// commutes with sums, factors and derivatives.
class ZeroPhaseFilter {
 public:
  // `options` must be valid for `sampling_step`.
  ZeroPhaseFilter(const FilterOptions& options, double sampling_step);

  // Filters a history, or each column of a matrix (samples x histories), in
  // place. No value may be NaN or infinite.
  void Apply(Vector* values) const;
  void Apply(Matrix* columns) const;

  // Returns the gain of the whole filter, both ways, for a long sine of that
  // frequency.
  double Gain(double frequency) const;

  // Number of samples by which each side of the history is extended.
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
