// The unknown spectrum of ambient loads, and a record's lines in its band.

#ifndef PINODE_PROBLEM_AMBIENT_SPECTRUM_H_
#define PINODE_PROBLEM_AMBIENT_SPECTRUM_H_

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Lines of a record.
struct SpectralLines {
  Vector frequency;         // cycles per unit of time
  Eigen::MatrixXcd values;  // channels x lines; |.|^2 is a one-sided density
  // For how many lines an independent one stands, n sum h^4 / (sum h^2)^2 of
  // the n samples' tapers h: powers of neighbours fluctuate together.
  double tied = 1.0;
  // Standard deviation of the frequencies that the tapers mix into a line.
  double bandwidth = 0.0;
};

// Fourier coefficients at the frequencies of a band: stationary noise of
// spectral density S makes them independent complex normal numbers of
// covariance S (P. Whittle, J. Roy. Statist. Soc. B 15 (1953) 125). The ends
// are tapered over a twentieth of the record, so that what is strong at one
// frequency does not leak over all. A few missing samples are bridged by
// straight lines; gaps longer than that, in whatever channel, are cut out of
// all with tapers of their own, eight cycles of the lowest frequency long, or
// shorter where gaps would leave little.
class LineTransform {
 public:
  // As the gaps of `samples`, channels x samples, ask for it.
  LineTransform(const Matrix& samples, double step, double lowest,
                double highest);

  // Of as many samples, linear in them: their weighted means are subtracted.
  Eigen::MatrixXcd Values(const Matrix& samples) const;
  SpectralLines Apply(const Matrix& samples) const;

 private:
  Eigen::Index first_ = 0;
  Vector frequency_;
  Vector taper_;  // of the samples that are used
  double scale_ = 1.0;
  double tied_ = 1.0;
  double bandwidth_ = 0.0;
};

// What is left of a record, as a fraction, where such gaps are cut out.
double ShareOutsideGaps(const Matrix& samples);
SpectralLines FindSpectralLines(const Matrix& samples, double step,
                                double lowest, double highest);

// The real and imaginary parts of a complex matrix's rows in turns, as it lies:
// products with real matrices, and sums of real parts, Re A^H B, are products
// of these.
inline Eigen::Map<const Matrix> RealRows(const Eigen::MatrixXcd& matrix) {
  return Eigen::Map<const Matrix>(
      reinterpret_cast<const double*>(matrix.data()), 2 * matrix.rows(),
      matrix.cols());
}

// Neighbouring lines within a band so narrow that S is the same for all of
// them: their products are all that the likelihood wants. How many there are
// does not grow with the record.
struct LineGroups {
  Vector frequency;  // means
  Vector spread;     // standard deviation of what is in it, with the bandwidth
  Vector count;      // of independent lines
  std::vector<Eigen::MatrixXcd> products;  // mean of Y Y^H, times that
  // Of each the first line, then the number of all.
  std::vector<Eigen::Index> first;

  Eigen::Index size() const { return frequency.size(); }
  // Products of other values at the same lines.
  void SetProducts(const Eigen::MatrixXcd& values);
};
// Bands `width` times the frequency wide.
LineGroups GroupLines(const SpectralLines& lines, double width);

// sum_b t_b(f) P_b with triangles over log f around knots that divide a band
// evenly, each side times a power of f that is one at the knot: with the powers
// of a spectrum between its knots, f^(-5/3) is met exactly. Of the P_b = L_b
// L_b^T the lower triangles are the unknowns, or their diagonals alone.
class LoadSpectrum {
 public:
  LoadSpectrum(double lowest, double highest, int knots, int areas,
               bool correlated);

  int num_areas() const { return areas_; }
  bool correlated() const { return correlated_; }
  int num_knots() const { return knots_; }
  // Unknowns of one knot; those of knot b begin at b times that.
  int per_knot() const { return static_cast<int>(entries_.size()); }
  int num_unknowns() const { return knots_ * per_knot(); }
  // Row and column of each unknown in L_b: its lower triangle by columns, or
  // its diagonal.
  const std::vector<std::pair<int, int>>& entries() const { return entries_; }

  // The knot below a frequency (of two the lower one; 0 where there is but
  // one), and the weights of its P and of the one above.
  int Weigh(double frequency, double* below, double* above) const;

  // Takes the powers between knots from what the traces of the P_b do there, or
  // from another spectrum of as many knots.
  void SetPowers(const Vector& unknowns);
  void SetPowers(const LoadSpectrum& other) { powers_ = other.powers_; }
  // The same knots, for loads that have nothing in common.
  LoadSpectrum Uncorrelated() const;
  // A knot between any two, and unknowns of it that are the same spectrum
  // everywhere: between knots it is a power of f times a straight line in log
  // f, of which any part is another one. Of two knots or more.
  LoadSpectrum Refined(const Vector& unknowns, Vector* refined) const;

  Matrix Root(const Vector& unknowns, int knot) const;  // L_b
  void SetRoot(const Matrix& root, int knot, Vector* unknowns) const;
  // The unknowns of P_b + L_b s^T + s L_b^T, s the matrices of `step`, which is
  // what a step of the unknowns is to first order; eigenvalues, relative to
  // P_b, fall to a tenth at most, so that it stays positive definite. A model
  // whose spectra are linear in P_b is solved by few such steps, however long.
  Vector Moved(const Vector& unknowns, const Vector& step) const;

  // By how much such a step would lower the covariances, relative to them: the
  // largest of all eigenvalues, 1 where one would vanish.
  double LargestFall(const Vector& unknowns, const Vector& step) const;

  // P_b = diag(column b).
  Vector Intensities(const Matrix& areas_by_knots) const;

 private:
  double log_lowest_;
  double log_step_;
  int knots_;
  int areas_;
  bool correlated_;
  std::vector<std::pair<int, int>> entries_;
  Vector powers_;  // between a knot and the next
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_AMBIENT_SPECTRUM_H_
