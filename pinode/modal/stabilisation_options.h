// Limits by which a stabilisation diagram is read.

#ifndef PINODE_MODAL_STABILISATION_OPTIONS_H_
#define PINODE_MODAL_STABILISATION_OPTIONS_H_

#include <vector>

namespace pinode {

// Limits for what counts as a mode.
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

}  // namespace pinode

#endif  // PINODE_MODAL_STABILISATION_OPTIONS_H_
