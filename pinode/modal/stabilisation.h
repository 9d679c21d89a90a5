// From the poles of many orders to modes: the stabilisation diagram, read.

#ifndef PINODE_MODAL_STABILISATION_H_
#define PINODE_MODAL_STABILISATION_H_

#include <complex>
#include <vector>

#include "pinode/base/types.h"
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

struct StabilisationOptions {
  // Two poles may be one mode where their frequencies differ by less than this
  // fraction and the MAC of their shapes is larger than that.
  double frequency_tolerance = 0.01;
  double smallest_mac = 0.9;
  // A mode is seen in this fraction of the orders above the first in which it
  // is seen, and in that one of all orders.
  double smallest_share = 0.5;
  double smallest_share_of_all = 0.3;
  // A mode under noise cannot be known better than to a fraction
  // sqrt(zeta / (2 pi f T)) of its frequency, T the record's length (S. K. Au,
  // Mech. Syst. Signal Process. 48 (2014) 15). What is so many times as
  // uncertain is no mode: poles of noise are fifty times. (The damping ratio's
  // bound is the same number; held to six times that, one record in a hundred
  // loses a mode that has most of its power.)
  double largest_excess = 6.0;
  double largest_frequency_sigma = 0.02;  // as a fraction, in all
  double largest_damping_ratio = 0.15;
  // Root mean square over the channels, each in units of what it records, of
  // the standard deviations of a shape whose entry at the reference is one.
  // Shapes of two modes side by side may be as uncertain as those of noise.
  double largest_shape_sigma = 1e300;
  // Frequencies (Hz): of each the mode is taken that the most certain pole
  // within frequency_tolerance belongs to, whether or not it is stable; nothing
  // else is. Empty: the diagram is read as above.
  std::vector<double> pick;
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
