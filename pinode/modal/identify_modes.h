// Modes of a structure from what sensors recorded of it, without a model: under
// loads that nobody measured, under measured ones, left to itself.

#ifndef PINODE_MODAL_IDENTIFY_MODES_H_
#define PINODE_MODAL_IDENTIFY_MODES_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/types.h"
#include "pinode/modal/response_record.h"
#include "pinode/modal/stabilisation_options.h"

namespace pinode {

// A mode that was identified.
struct IdentifiedMode {
  double frequency_hz = 0.0;  // |s| / (2 pi)
  double damping_ratio = 0.0;
  // Displacements at the channels' places, whatever was measured there (a
  // mode's velocities are s times, its accelerations s^2 times as large), in
  // the units of the channels; the largest entry is 1.
  Eigen::VectorXcd shape;
  // Standard deviations; of the real and the imaginary part of each entry.
  double frequency_sigma = 0.0;
  double damping_sigma = 0.0;
  Vector shape_sigma_real;
  Vector shape_sigma_imaginary;
  // Frequency (Hz), damping ratio, real parts, imaginary parts.
  Matrix covariance;
  // Of these, for Student's t, and the 95 % intervals that follow.
  double degrees_of_freedom = 0.0;
  double frequency_lower95 = 0.0, frequency_upper95 = 0.0;
  double damping_lower95 = 0.0, damping_upper95 = 0.0;
  // Over model orders: how many see the mode, of how many that could; standard
  // deviations between those that the estimate is the mean of.
  int orders_seen = 0, orders_possible = 0;
  double frequency_spread = 0.0;  // Hz
  double damping_spread = 0.0;
  // How far the shape is from one that all points move in phase: 1 for none
  // (mean phase collinearity; J. N. Juang, R. S. Pappa 1986).
  double phase_collinearity = 0.0;
  // At which sampling step it was found.
  double sampling_step = 0.0;
  // What data-driven identification makes of it beside a covariance-driven one;
  // NaN: it does not see it, or was not asked.
  double check_frequency_hz = kNaN;
  double check_damping_ratio = kNaN;
};

// A pole of the stabilisation diagram.
struct DiagramPole {
  int order = 0;
  double frequency_hz = 0.0;
  double frequency_sigma = 0.0;
  double damping_ratio = 0.0;
  int mode = -1;  // in ModesOfRecord::modes; -1: of none
};

// The record at one rate, looked at in a band of frequencies.
struct AnalysedBand {
  double sampling_step = 0.0;  // s
  double lowest_hz = 0.0;
  double highest_hz = 0.0;
  int block_rows = 0;
  int max_order = 0;
  int num_windows = 0;
  std::vector<DiagramPole> poles;
};

enum class ModalMethod {
  // By what the record is: kRingDown of a free decay, kInputOutput of one with
  // inputs, else kCovarianceDriven.
  kAutomatic,
  kCovarianceDriven,  // with the data-driven one as a check
  kDataDriven,
  kInputOutput,
  kRingDown,
};
// "covariance_driven" and so on.
const char* ModalMethodName(ModalMethod method);

struct ModeIdentificationOptions {
  ModalMethod method = ModalMethod::kAutomatic;
  // What is looked for, Hz. Default (0): from 50 cycles in the record to 0.95
  // of half the sampling rate.
  double lowest_hz = 0.0;
  double highest_hz = 0.0;
  // Block rows of the Hankel matrix; default (0): 600 rows of it, 12 to 40
  // blocks, of a ring-down to a third of its samples.
  int block_rows = 0;
  // Highest model order, even; default (0): 60, or what the channels allow.
  int max_order = 0;
  // Channels against which correlations are taken, by name; default: all. A
  // ring-down has none.
  std::vector<std::string> references;
  StabilisationOptions stabilisation;
  int num_threads = 1;
};

struct ModesOfRecord {
  ModalMethod method = ModalMethod::kCovarianceDriven;
  std::vector<IdentifiedMode> modes;  // by frequency
  std::vector<AnalysedBand> bands;    // from the highest
  std::vector<std::string> remarks;
};

// The modes of a record.
//
// A structure's modes spread over decades, a Hankel matrix over a few of the
// periods that its lags reach: the record is analysed at its own rate and at
// halves of it, each from 0.2 to 0.8 of half the rate (the lowest down to
// lowest_hz). A mode that two rates see is taken from that which is more
// certain of it.
//
// False with a sentence where the record is too short, or options do not fit
// it: a method that needs inputs, or samples without gaps. *option (may be
// null) is then the name of the one that was given and is at fault, empty where
// none is.
[[nodiscard]] bool IdentifyModes(const ResponseRecord& record,
                                 const ModeIdentificationOptions& options,
                                 ModesOfRecord* result, std::string* error,
                                 std::string* option = nullptr);

}  // namespace pinode

#endif  // PINODE_MODAL_IDENTIFY_MODES_H_
