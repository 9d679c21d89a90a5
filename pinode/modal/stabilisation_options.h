// Limits for reading a stabilisation diagram.

#ifndef PINODE_MODAL_STABILISATION_OPTIONS_H_
#define PINODE_MODAL_STABILISATION_OPTIONS_H_

#include <vector>

namespace pinode {

// Limits for poles that count as modes.
struct StabilisationOptions {
  // Tolerances for two poles to be one mode. Their frequencies must differ by
  // less than the fraction frequency_tolerance. The modal assurance criterion
  // (MAC) of their shapes must be above smallest_mac.
  double frequency_tolerance = 0.01;
  double smallest_mac = 0.9;
  // Smallest fraction of the model orders that must contain a mode: of the
  // orders from the first one that contains it, and of all orders.
  double smallest_share = 0.5;
  double smallest_share_of_all = 0.3;
  // Largest accepted uncertainty of a frequency f, as a multiple of its lower
  // bound. Under random loads the standard deviation of f is at least f
  // sqrt(zeta / (2 pi f T)), with zeta the damping ratio and T the record's
  // duration (S. K. Au, Mech. Syst. Signal Process. 48 (2014) 15). Poles due to
  // noise are about fifty times as uncertain as this bound. The limit does not
  // apply to damping ratios: one record in a hundred would then lose its
  // strongest mode.
  double largest_excess = 6.0;
  double largest_frequency_sigma = 0.02;  // fraction of f
  double largest_damping_ratio = 0.15;
  // Largest accepted uncertainty of a shape that is 1 at its reference channel.
  // It is the RMS over the channels of the entries' standard deviations. By
  // default there is no limit, because shapes of two close modes may be as
  // uncertain as those of noise.
  double largest_shape_sigma = 1e300;
  // Frequencies in Hz of the modes to accept. The most certain pole within
  // frequency_tolerance of each one is the mode, stable or not. No other pole
  // is a mode. Empty: the limits above select the modes.
  std::vector<double> pick;
};

}  // namespace pinode

#endif  // PINODE_MODAL_STABILISATION_OPTIONS_H_
