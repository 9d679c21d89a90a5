// The unknown spectrum of ambient loads, and a record's spectral lines in its
// band.

#ifndef PINODE_PROBLEM_AMBIENT_SPECTRUM_H_
#define PINODE_PROBLEM_AMBIENT_SPECTRUM_H_

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Spectral lines of a record.
struct SpectralLines {
  Vector frequency;         // cycles per unit of time
  Eigen::MatrixXcd values;  // channels x lines; |.|^2 is a one-sided density
  // Number of lines per independent line, n sum h^4 / (sum h^2)^2 for the
  // tapers h of the n samples: neighbouring powers are correlated.
  double tied = 1.0;
  // Standard deviation of the frequencies that the tapers mix into a line.
  double bandwidth = 0.0;
};

// Fourier coefficients at the frequencies of a band. Stationary noise of
// spectral density S makes them independent complex normal numbers of
// covariance S (P. Whittle, J. Roy. Statist. Soc. B 15 (1953) 125). The ends
// are tapered over a twentieth of the record, so that strong frequencies do not
// leak over all others. A few missing samples are bridged by straight lines.
// Longer gaps in any channel are cut out of all channels with tapers of their
// own. These are eight cycles of the lowest frequency long, or shorter if the
// gaps would leave little of the record.
class LineTransform {
 public:
  // Builds the tapers for the gaps of `samples`, channels x samples.
  LineTransform(const Matrix& samples, double step, double lowest,
                double highest);

  // Return the coefficients of as many samples, and are linear in them.
  // Weighted means are subtracted.
  Eigen::MatrixXcd Values(const Matrix& samples) const;
  SpectralLines Apply(const Matrix& samples) const;

 private:
  Eigen::Index first_ = 0;
  Vector frequency_;
  Vector taper_;  // of the samples in use
  double scale_ = 1.0;
  double tied_ = 1.0;
  double bandwidth_ = 0.0;
};

// Returns the fraction of a record that remains after its gaps are cut out.
double ShareOutsideGaps(const Matrix& samples);
SpectralLines FindSpectralLines(const Matrix& samples, double step,
                                double lowest, double highest);

// Returns the rows' real and imaginary parts in turns, as they lie in memory.
// Products with real matrices, and sums of real parts, Re A^H B, are products
// of these.
inline Eigen::Map<const Matrix> RealRows(const Eigen::MatrixXcd& matrix) {
  return Eigen::Map<const Matrix>(
      reinterpret_cast<const double*>(matrix.data()), 2 * matrix.rows(),
      matrix.cols());
}

// Groups of neighbouring lines in bands so narrow that S is constant within
// each. The likelihood needs only their products. The number of groups does not
// grow with the record.
struct LineGroups {
  Vector frequency;  // means
  Vector spread;     // standard deviation within the group, with the bandwidth
  Vector count;      // number of independent lines
  std::vector<Eigen::MatrixXcd> products;  // mean of Y Y^H, times that
  // First line of each group, then the number of all lines.
  std::vector<Eigen::Index> first;

  Eigen::Index size() const { return frequency.size(); }
  // Sets `products` from other values at the same lines.
  void SetProducts(const Eigen::MatrixXcd& values);
};
// Groups lines into bands that are `width` times the frequency wide.
LineGroups GroupLines(const SpectralLines& lines, double width);

// Spectrum sum_b t_b(f) P_b with triangles over log f around knots that divide
// a band evenly. Each side is multiplied by a power of f that is one at the
// knot. With the powers of a spectrum between its knots, f^(-5/3) is
// represented exactly. The unknowns are the lower triangles of L_b, P_b = L_b
// L_b^T, or their diagonals alone.
class LoadSpectrum {
 public:
  LoadSpectrum(double lowest, double highest, int knots, int areas,
               bool correlated);

  int num_areas() const { return areas_; }
  bool correlated() const { return correlated_; }
  int num_knots() const { return knots_; }
  // Number of unknowns per knot. Those of knot b begin at b * per_knot().
  int per_knot() const { return static_cast<int>(entries_.size()); }
  int num_unknowns() const { return knots_ * per_knot(); }
  // Row and column of each unknown in L_b: its lower triangle by columns, or
  // its diagonal.
  const std::vector<std::pair<int, int>>& entries() const { return entries_; }

  // Returns the knot below a frequency (the lower of two; 0 if there is only
  // one), and the weights of its P and of the next knot's P.
  int Weigh(double frequency, double* below, double* above) const;

  // Sets the powers between knots from the traces of the P_b there, or from
  // another spectrum with as many knots.
  void SetPowers(const Vector& unknowns);
  void SetPowers(const LoadSpectrum& other) { powers_ = other.powers_; }
  // Returns the spectrum with the same knots for uncorrelated loads.
  LoadSpectrum Uncorrelated() const;
  // Returns the spectrum with one more knot between any two, and its unknowns
  // that give the same spectrum everywhere. Between knots the spectrum is a
  // power of f times a straight line in log f, and so is any part of it. Needs
  // at least two knots.
  LoadSpectrum Refined(const Vector& unknowns, Vector* refined) const;

  Matrix Root(const Vector& unknowns, int knot) const;  // L_b
  void SetRoot(const Matrix& root, int knot, Vector* unknowns) const;
  // Returns the unknowns of P_b + L_b s^T + s L_b^T with s the matrices of
  // `step`, a step of the unknowns to first order. Eigenvalues relative to P_b
  // fall to a tenth at most, so that P_b stays positive definite. A model whose
  // spectra are linear in P_b is solved by few such steps, however long.
  Vector Moved(const Vector& unknowns, const Vector& step) const;

  // Returns the largest relative decrease of the covariances in such a step:
  // the largest of all eigenvalues, 1 where one would vanish.
  double LargestFall(const Vector& unknowns, const Vector& step) const;

  // Returns the unknowns with P_b = diag(column b).
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
