// Sums of decaying vibrations, fitted to samples by least squares.

#ifndef PINODE_MODAL_DECAY_MODEL_H_
#define PINODE_MODAL_DECAY_MODEL_H_

#include <complex>
#include <functional>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// One term of a decay: exp(s t). A real s is a decay without vibration; a
// complex one (Im s > 0) stands for a pair.
struct DecayTerm {
  std::complex<double> s;
  // True for the image of a vibration above half the sampling rate.
  bool is_alias = false;
  // True for a term that stays in the fit, needed or not.
  bool is_fixed = false;

  bool vibrates() const { return s.imag() > 0.0; }
};

// A fit of terms and a constant to weighted samples.
struct DecayFit {
  std::vector<DecayTerm> terms;
  Matrix basis;       // samples x columns: Re, Im of each pair, ..., constant
  Matrix q;           // orthonormal basis of the same space
  Matrix amplitudes;  // columns x channels, weighted by channel
  Matrix residuals;   // samples x channels, weighted
  double cost = 0.0;  // sum of their squares

  // Returns the first column of each term in `basis`.
  std::vector<Eigen::Index> Columns() const;
  // Returns amplitudes a of a vibration, one per channel: it is Re(a exp(s t)).
  ComplexVector Shape(size_t term) const;
};

// Samples with weights. The model of channel c is
//
//   y_c(k) = sum_m Re(a_mc exp(s_m k step)) + constant,
//
// and the fit minimises sum (row_weight_k channel_weight_c residual)^2. The
// amplitudes are linear: they are eliminated (G. H. Golub, V. Pereyra, SIAM J.
// Numer. Anal. 10 (1973) 413), with the Jacobian of L. Kaufman, BIT 15 (1975)
// 49. With white noise of the weights' inverse the estimate has the variance of
// the Cramer-Rao bound.
class DecayModel {
 public:
  // samples: channels x samples.
  DecayModel(const Matrix& samples, double step);

  double step() const { return step_; }
  Eigen::Index num_samples() const { return samples_.rows(); }
  Eigen::Index num_channels() const { return samples_.cols(); }
  const Vector& channel_weights() const { return channel_weights_; }
  const Vector& row_weights() const { return row_weights_; }
  void set_channel_weights(const Vector& weights);
  void set_row_weights(const Vector& weights);

  // Fits the amplitudes.
  DecayFit Solve(const std::vector<DecayTerm>& terms) const;

  // Fits the poles too, by Levenberg-Marquardt from those of `fit`. Poles stay
  // between zero and half the sampling rate, and do not grow by more than
  // the factor e over the record.
  void Refine(DecayFit* fit) const;

  // Returns the square of the residual that a further term would explain, with
  // all poles fixed.
  double Explained(const DecayFit& fit, const DecayTerm& term) const;

  // Returns the mean square that the residuals have at vibrations of the same
  // decay as the term at neighbouring frequencies, corrected upwards for its
  // own scatter. White residuals have their variance.
  double NoiseNear(const DecayFit& fit, const DecayTerm& term) const;

  // First-order changes of s (terms x series) and of the shapes (per term
  // channels x series, not weighted) by additive noise (channels x samples, not
  // weighted): series(0), ..., series(count - 1).
  struct Influences {
    ComplexMatrix s;
    std::vector<ComplexMatrix> shapes;
    // Covariance of (Re s, Im s) of each term for white noise with the variance
    // of the residuals: the Cramer-Rao bound.
    std::vector<Eigen::Matrix2d> bounds;
  };
  Influences FindInfluences(const DecayFit& fit, int count,
                            const std::function<Matrix(int)>& series) const;

 private:
  struct Slopes;
  bool IsAllowed(const DecayTerm& term) const;
  void AppendColumns(const DecayTerm& term, Matrix* basis,
                     Eigen::Index column) const;
  Slopes FindSlopes(const DecayFit& fit) const;
  Matrix NormalMatrix(const DecayFit& fit, const Slopes& slopes) const;
  Vector Gradient(const DecayFit& fit, const Slopes& slopes,
                  const Matrix& residuals) const;
  std::vector<DecayTerm> Moved(const std::vector<DecayTerm>& terms,
                               const Vector& change) const;

  Matrix data_;     // samples x channels
  Matrix samples_;  // the same, weighted
  double step_;
  Vector row_weights_;
  Vector channel_weights_;
};

}  // namespace pinode

#endif  // PINODE_MODAL_DECAY_MODEL_H_
