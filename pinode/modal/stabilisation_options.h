// Limits by which a stabilisation diagram is read.

#ifndef PINODE_MODAL_STABILISATION_OPTIONS_H_
#define PINODE_MODAL_STABILISATION_OPTIONS_H_

#include <vector>

namespace pinode {

// Limits for what counts as a mode.
struct StabilisationOptions {
  // Tolerances: two poles may be one mode if their frequencies differ by less
  // than this fraction and the MAC of their shapes is larger than
  // `smallest_mac`.
  double frequency_tolerance = 0.01;
  double smallest_mac = 0.9;
  // Smallest share of the orders in which a mode must be found: among the
  // orders from the first one that contains it, and among all orders.
  double smallest_share = 0.5;
  double smallest_share_of_all = 0.3;
  // Largest accepted excess. Under noise the frequency of a mode cannot be
  // known better than to the fraction sqrt(zeta / (2 pi f T)), T the record's
  // length (S. K. Au, Mech. Syst. Signal Process. 48 (2014) 15). A pole that is
  // more uncertain than this bound times the excess is not a mode; poles of
  // noise are fifty times. (The bound of the damping ratio is the same number.
  // With a limit of six times that, one record in a hundred loses a mode that
  // has most of its power.)
  double largest_excess = 6.0;
  double largest_frequency_sigma = 0.02;  // as a fraction, in all
  double largest_damping_ratio = 0.15;
  // Largest accepted uncertainty of a shape that is one at the reference: root
  // mean square of its standard deviations over the channels, each in the
  // channel's own unit. Shapes of two close modes may be as uncertain as those
  // of noise.
  double largest_shape_sigma = 1e300;
  // Frequencies (Hz) of the modes to take. For each, the most certain pole
  // within frequency_tolerance determines the mode, stable or not. No other
  // modes are taken. Empty: the diagram is read as above.
  std::vector<double> pick;
};

}  // namespace pinode

#endif  // PINODE_MODAL_STABILISATION_OPTIONS_H_
