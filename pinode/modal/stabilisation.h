// Finds modes among the poles of many orders, by reading the stabilisation
// diagram.

#ifndef PINODE_MODAL_STABILISATION_H_
#define PINODE_MODAL_STABILISATION_H_

#include <complex>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/modal/stabilisation_options.h"
#include "pinode/modal/subspace.h"

namespace pinode {

// Poles of several orders that belong to one mode.
struct PoleCluster {
  std::vector<int> members;  // indices of poles, by order
  // Poles that agree and are averaged in the estimate.
  std::vector<int> chosen;
  // Mean of the chosen poles, weighted by the inverse variances of their
  // frequencies. Their influences are averaged in the same way, which includes
  // the correlation between orders. The shape is one at `reference`.
  SubspacePole mean;
  int reference = 0;
  int first_order = 0;
  // Scatter of the chosen poles: standard deviations over orders, with the same
  // weights.
  double frequency_spread = 0.0;  // Hz
  double damping_spread = 0.0;

  double frequency_sigma = 0.0;  // Hz
  double damping_sigma = 0.0;
  // Standard deviation of the frequency, divided by the smallest possible one
  // under noise. 0 if the record is not one under noise.
  double excess = 0.0;
};

// Covariance of frequency (Hz), damping ratio, and real and imaginary parts of
// the shape of a pole, from its influences. Their windows are `window_seconds`
// long. With 0, each influence is a change of the whole estimate, independent
// of the others.
struct PoleMoments {
  Matrix covariance;
  double degrees_of_freedom = 0.0;
};
PoleMoments FindPoleMoments(const SubspacePole& pole, double window_seconds);

// Standard deviations of frequency (Hz) and damping ratio alone.
struct PoleSigmas {
  double frequency = 0.0;
  double damping = 0.0;
};
PoleSigmas FindPoleSigmas(const SubspacePole& pole, double window_seconds);

// Returns the modes among `poles` (of IdentifySubspace), by frequency. The most
// certain pole without a cluster starts a new cluster. The cluster takes the
// nearest pole of each other order. Clusters in too few orders, or with too
// large an uncertainty, are left out.
std::vector<PoleCluster> FindClusters(const std::vector<SubspacePole>& poles,
                                      int max_order, double window_seconds,
                                      const StabilisationOptions& options);

// Increases the influences on frequency and damping ratio to the smallest
// standard deviations that a record of `duration` seconds under an unmeasured
// random load allows: the fraction sqrt(zeta / (2 pi f T)) of the frequency,
// and as much for the damping ratio (see StabilisationOptions). Smaller ones
// come from the scatter of few windows, or from loads that are no stationary
// noise.
void RespectAmbientBound(double window_seconds, double duration,
                         PoleCluster* cluster);

// Returns the pole with its shape scaled to one at the channel `reference`.
SubspacePole NormalisedPole(const SubspacePole& pole, int reference);

// Returns the complex number of modulus one whose product with `shape` has the
// smallest imaginary parts (sum of squares). Only finite entries of `shape`
// count.
std::complex<double> TurnToReal(const Eigen::VectorXcd& shape);

// Returns |a^H b|^2 / (|a|^2 |b|^2).
double ComplexMac(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b);

// Returns true if two estimated poles a and b (1/s) are one mode: they are
// nearer than half a decay rate, and the MAC of their shapes is above 0.9.
bool IsOneMode(std::complex<double> a, const Eigen::VectorXcd& shape_a,
               std::complex<double> b, const Eigen::VectorXcd& shape_b);

}  // namespace pinode

#endif  // PINODE_MODAL_STABILISATION_H_
