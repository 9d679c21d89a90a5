// The unknown loads and noise of an ambient record.

#ifndef PINODE_ESTIMATE_AMBIENT_AMBIENT_LOADS_H_
#define PINODE_ESTIMATE_AMBIENT_AMBIENT_LOADS_H_

#include <Eigen/Core>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/problem/ambient_spectrum.h"

namespace pinode {

// Derivatives of the cost by the unknowns of loads and noise and, if they were
// asked for, by the free groups after them.
struct LikelihoodSums {
  Vector gradient;
  Matrix information;
  Matrix products;  // of the scores; empty if not asked for
};

// The spectrum of the loads, the noise of each channel, and the prior of the
// loads, with their present values.
//
// The unknowns are the factors of the loads' covariances at the knots, then
// half the logarithm of the noise density of each channel. The prior weighs as
// much as kPriorLines lines in which the loads themselves are seen. Without it,
// the record does not determine the force on a mode far from a knot there, and
// the estimate would make such forces perfectly correlated.
class AmbientLoads {
 public:
  // Number of lines of the loads themselves that the prior stands for.
  static constexpr double kPriorLines = 2.0;
  // Information of one line on the noise of a channel.
  static constexpr double kMetricOfNoise = 4.0;

  // `smallest_noise`: density of each channel below which noise makes no
  // difference. The unknowns are empty, and there is no prior.
  AmbientLoads(const LoadSpectrum& spectrum, const Vector& smallest_noise);

  const LoadSpectrum& spectrum() const { return spectrum_; }
  Eigen::Index num_channels() const { return smallest_noise_.size(); }
  const Vector& smallest_noise() const { return smallest_noise_; }
  bool has_prior() const { return prior_.size() > 0; }

  int num_unknowns() const { return static_cast<int>(unknowns_.size()); }
  const Vector& unknowns() const { return unknowns_; }
  void SetUnknowns(const Vector& unknowns) { unknowns_ = unknowns; }
  // Sets diagonal covariances, areas x knots, and the logarithms of the noise.
  void SetIntensities(const Matrix& intensities, const Vector& half_logarithms);
  // Noise density of each channel.
  Vector Noise() const;

  // Covariance of the loads at each knot, areas x areas.
  std::vector<Matrix> KnotCovariances() const;
  // Covariance of the loads at a frequency, from those at the knots.
  Matrix Covariance(double frequency,
                    const std::vector<Matrix>& at_knots) const;

  // The unknowns after a step from `unknowns`. Noise moves in its variance, and
  // no step makes it vanish.
  Vector Moved(const Vector& unknowns, const Vector& step) const;
  // Largest relative fall of a covariance or noise variance in such a step.
  double LargestFall(const Vector& unknowns, const Vector& step) const;
  // Removes from `sums` the noise that is at its smallest and would fall.
  void HoldNoise(LikelihoodSums* sums) const;

  // Adds the cost of the prior and, unless `sums` is null, its derivatives.
  void AddPrior(double* cost, LikelihoodSums* sums) const;
  // The cost and the derivatives of the prior alone. `cost` may be null.
  LikelihoodSums PriorSums(double* cost) const;

  // Information of one line that sees all loads themselves, and of one line on
  // the noise: a measure of relative changes of the unknowns.
  Matrix RelativeMetric() const;
  // The same for the loads of one knot.
  Matrix MetricOfKnot(int knot) const;

  // Makes loads of different areas uncorrelated, without a prior. The unknowns
  // are to be set afterwards.
  void MakeUncorrelated();
  // Takes the powers of frequency between the knots from the present loads.
  void SetPowers() { spectrum_.SetPowers(unknowns_); }
  // From uncorrelated loads to those of `correlated`. The present intensities
  // become the start of the unknowns and the prior.
  void MakeCorrelated(const LoadSpectrum& correlated);
  // Restores a spectrum; the unknowns are to be set afterwards.
  void SetSpectrum(const LoadSpectrum& spectrum) { spectrum_ = spectrum; }
  // The same loads with one more knot between any two; needs two knots.
  AmbientLoads Refined() const;

 private:
  LoadSpectrum spectrum_;
  Vector smallest_noise_;
  Vector unknowns_;
  // Intensities of the loads at the knots, areas x knots, to which the prior
  // holds the covariances. Empty: no prior.
  Matrix prior_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_AMBIENT_AMBIENT_LOADS_H_
