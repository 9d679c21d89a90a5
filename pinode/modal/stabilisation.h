// From the poles of many orders to modes: the stabilisation diagram, read.

#ifndef PINODE_MODAL_STABILISATION_H_
#define PINODE_MODAL_STABILISATION_H_

#include <complex>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/stabilisation_options.h"
#include "pinode/modal/subspace.h"

namespace pinode {

// Poles of several orders that are one mode.
struct PoleCluster {
  std::vector<int> members;  // indices of poles, by order
  // Those of them that the estimate is the mean of: those that agree.
  std::vector<int> chosen;
  // Their mean by the inverse variances of their frequencies, with that of
  // their influences: how orders hang together is counted. The shape is one at
  // `reference`.
  SubspacePole mean;
  int reference = 0;
  int first_order = 0;
  // How far the chosen ones lie apart: standard deviations over orders, by the
  // same weights.
  double frequency_spread = 0.0;  // Hz
  double damping_spread = 0.0;

  double frequency_sigma = 0.0;  // Hz
  double damping_sigma = 0.0;
  // The frequency's standard deviation over the smallest that it can have under
  // noise; 0 where the record is none of that.
  double excess = 0.0;
};

// Covariance of frequency (Hz), damping ratio, real parts and imaginary parts
// of the shape of a pole, from its influences, whose windows are
// `window_seconds` long; 0: each influence is a change of the whole estimate,
// independent of the others.
struct PoleMoments {
  Matrix covariance;
  double degrees_of_freedom = 0.0;
};
PoleMoments FindPoleMoments(const SubspacePole& pole, double window_seconds);

// Of frequency (Hz) and damping ratio alone.
struct PoleSigmas {
  double frequency = 0.0;
  double damping = 0.0;
};
PoleSigmas FindPoleSigmas(const SubspacePole& pole, double window_seconds);

// The modes among `poles` (of IdentifySubspace), by frequency. The most certain
// pole that is in none yet begins a cluster and takes, of each other order, the
// one nearest to it; what is seen in too few orders, or is too uncertain, is
// left out.
std::vector<PoleCluster> FindClusters(const std::vector<SubspacePole>& poles,
                                      int max_order, double window_seconds,
                                      const StabilisationOptions& options);

// The pole with a shape that is one at the channel `reference`.
SubspacePole NormalisedPole(const SubspacePole& pole, int reference);

// The number of size one by which the entries of `shape` that are finite, taken
// times it, have the smallest imaginary parts (sum of squares).
std::complex<double> TurnToReal(const Eigen::VectorXcd& shape);

// |a^H b|^2 / (|a|^2 |b|^2).
double ComplexMac(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b);

}  // namespace pinode

#endif  // PINODE_MODAL_STABILISATION_H_
