// Responses of poles to measured loads, fitted to spectra by least squares.

#ifndef PINODE_MODAL_FORCED_MODEL_H_
#define PINODE_MODAL_FORCED_MODEL_H_

#include <complex>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// A fit of poles to the spectra of a record. Rows are real and imaginary parts
// of lines.
struct ForcedFit {
  std::vector<std::complex<double>> s;  // Im s > 0, for a pair
  Matrix q;           // orthonormal basis of what the poles add
  Matrix inside;      // basis = q * inside
  Matrix triangle;    // basis = (orthonormal columns) * triangle
  Matrix products;    // those columns' products with the data
  Matrix amplitudes;  // columns of the basis x channels
  Matrix residuals;   // rows x channels, weighted
  double cost = 0.0;  // sum of their squares
};

// Spectra Y of channels and U of loads. The model of channel c is
//
//   y_c(k) = sum_m Re(a_mc x_m0(k) + sum_i b_mci x_mi(k))
//            + sum_i sum_j d_cij u_i(k + j),
//   x_m0(k) = l_m^k,  x_mi(k + 1) = l_m x_mi(k) + u_i(k),  l_m = exp(s_m step).
//
// x_m0 is the decay from the start. Loads between samples depend on samples on
// both sides: a sum over u(k + j), |j| <= 24, holds them, together with what
// loads cause at once, and with modes far away. Amplitudes a, b and d are
// linear and eliminated, as in DecayModel.
//
// The fit is one of discrete Fourier transforms over a stretch, at the lines of
// a band. With z = exp(2 pi i line / samples), the states of a pole are
// combinations of z / (z - l) and U_i / (z - l): no approximation, because
// z^samples = 1. Outside of the band the sum of loads need not be a good one.
// Terms of the stretch's edges from there are left to the samples beside them.
class ForcedModel {
 public:
  // A band of frequencies, Hz, with so many lines at most. If there are more,
  // those next to the poles `centres` are used.
  struct Band {
    double lowest_hz = 0.0;
    double highest_hz = 0.0;
    Eigen::Index most_lines = 0;
    std::vector<std::complex<double>> centres;
  };

  // outputs: channels x samples; inputs: loads x samples. Both complete.
  ForcedModel(const Matrix& outputs, const Matrix& inputs, double step,
              const Band& band);

  double step() const { return step_; }
  Eigen::Index num_rows() const { return data_.rows(); }
  Eigen::Index num_lines() const { return angular_.size(); }
  Eigen::Index num_channels() const { return data_.cols(); }
  Eigen::Index num_inputs() const { return inputs_.cols(); }
  // Number of columns of a pole.
  Eigen::Index own_columns() const { return 2 * (1 + num_inputs()); }
  // Returns the fewest lines for so many poles and loads.
  static Eigen::Index FewestLines(size_t poles, Eigen::Index inputs);

  // Angular frequencies of the lines, and their distance in the transform.
  const Vector& angular() const { return angular_; }
  double line_spacing() const;
  const Vector& channel_weights() const { return channel_weights_; }
  const Vector& line_weights() const { return line_weights_; }
  void set_weights(const Vector& channel_weights, const Vector& line_weights);
  // Rows x channels, weighted, without what the loads explain.
  const Matrix& data() const { return data_; }
  // Variance of rounding of each channel, not weighted.
  const Vector& rounding() const { return rounding_; }

  // Fits the amplitudes.
  ForcedFit Solve(const std::vector<std::complex<double>>& s) const;

  // Fits the poles too, by Levenberg-Marquardt. Each stays within reach[m] of
  // centre[m] (both 1 / s).
  void Refine(const std::vector<std::complex<double>>& centre,
              const std::vector<double>& reach, ForcedFit* fit) const;

  // Returns what remains of the data without pole m, with the other poles
  // fixed: the increase of each channel's squares, and the columns it is due
  // to.
  struct Gain {
    Vector squares;
    Eigen::Index columns = 0;
  };
  Gain GainOf(const ForcedFit& fit, size_t m) const;

  // Returns the part of white noise that a fit leaves at each line.
  Vector FractionsLeft(const ForcedFit& fit) const;

  // Squares of each channel's residuals at each line, in the mean the variance
  // of white noise (lines x channels), corrected for what the fit has removed.
  Matrix Spectrum(const ForcedFit& fit) const;

  // Derivatives of the columns of each pole by its s, weighted, without what
  // the loads explain.
  Matrix Slopes(const ForcedFit& fit) const;
  // Returns what turns the slopes into the derivatives of a channel by (Re s,
  // Im s) of each pole, with fixed amplitudes: slopes x 2 poles.
  Matrix SlopeAmplitudes(const ForcedFit& fit, Eigen::Index channel) const;

  // Columns of a pole, weighted, without what the loads explain. Pairs: real
  // and imaginary parts of the amplitudes of the decay and of each load.
  Matrix ColumnsOf(std::complex<double> s) const;

 private:
  void ChooseLines(const Band& band, Eigen::Index length);
  void FindCommon(const Matrix& inputs, Eigen::Index length);
  Matrix States(std::complex<double> s, bool derivatives) const;
  Matrix WithoutCommon(Matrix columns) const;

  double step_;
  Eigen::Index begin_ = 0;   // first sample of the stretch
  Eigen::Index length_ = 0;  // samples of the stretch
  Vector angular_;           // rad / s, by line
  ComplexVector z_;
  ComplexMatrix inputs_;  // lines x loads
  Matrix all_common_;     // rows x columns, not weighted
  Matrix common_;         // orthonormal: loads and edges, weighted
  Matrix raw_;            // rows x channels
  Matrix data_;           // the same, weighted, without what is common
  Vector channel_weights_;
  Vector line_weights_;
  Vector rounding_;
};

}  // namespace pinode

#endif  // PINODE_MODAL_FORCED_MODEL_H_
