// Modal identification from sensor records, without a model. The loads may be
// unmeasured, measured, or absent (free decay).

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

// Identified mode with its uncertainty.
struct IdentifiedMode {
  // Frequency |s| / (2 pi) and damping ratio -Re(s) / |s| of the pole s. The
  // ratio is a fraction of critical: 0.02 is 2 %.
  double frequency_hz = 0.0;
  double damping_ratio = 0.0;
  // Mode shape, one entry per channel. Entries are displacements, in the unit
  // of length of each channel, also if velocities (s times as large) or
  // accelerations (s^2 times) were measured. The entry of largest magnitude is
  // 1.
  Eigen::VectorXcd shape;
  // Standard deviations of the frequency (Hz), of the damping ratio, and of the
  // real and imaginary part of each entry of the shape.
  double frequency_sigma = 0.0;
  double damping_sigma = 0.0;
  Vector shape_sigma_real;
  Vector shape_sigma_imaginary;
  // Covariance of frequency (Hz), damping ratio, real parts and imaginary parts
  // of the shape, in this order. Square, 2 + 2 * channels rows.
  Matrix covariance;
  // Degrees of freedom of these standard deviations for Student's t
  // distribution, and the 95 % intervals that follow.
  double degrees_of_freedom = 0.0;
  double frequency_lower95 = 0.0, frequency_upper95 = 0.0;
  double damping_lower95 = 0.0, damping_upper95 = 0.0;
  // Numbers of model orders that contain the mode, and that could contain it.
  int orders_seen = 0, orders_possible = 0;
  // Standard deviations of the estimates between these orders.
  double frequency_spread = 0.0;  // Hz
  double damping_spread = 0.0;
  // Modal phase collinearity of the shape, 0 to 1 (J. N. Juang, R. S. Pappa
  // 1986). It is 1 if all points move in phase or in opposite phase.
  double phase_collinearity = 0.0;
  // True for the vibration of a machine. Its damping interval contains zero,
  // its amplitude is constant, and its kurtosis is that of a sine, 1.5.
  bool is_harmonic = false;
  // Sampling step in s of the analysis that found the mode, see AnalysedBand.
  double sampling_step = 0.0;
  // Estimates of the data-driven method, as a check of the covariance-driven
  // one. NaN: this method did not find the mode, or was not run.
  double check_frequency_hz = kNaN;
  double check_damping_ratio = kNaN;
};

// Pole of the stabilisation diagram.
struct DiagramPole {
  // Model order (number of states).
  int order = 0;
  double frequency_hz = 0.0;
  double frequency_sigma = 0.0;
  double damping_ratio = 0.0;
  int mode = -1;  // index in ModesOfRecord::modes; -1: no mode
};

// Analysis of the record at one sampling rate, in one band of frequencies.
struct AnalysedBand {
  double sampling_step = 0.0;  // s
  double lowest_hz = 0.0;
  double highest_hz = 0.0;
  int block_rows = 0;
  int max_order = 0;
  // Number of parts of the record. The scatter of their correlations gives the
  // standard deviations.
  int num_windows = 0;
  std::vector<DiagramPole> poles;
};

// Method of modal identification. Sources: B. Peeters and G. De Roeck 1999
// (covariance-driven); P. Van Overschee and B. De Moor 1996 (data-driven); M.
// Verhaegen 1994 (input-output); J. N. Juang and R. S. Pappa 1985 (ring-down).
enum class ModalMethod {
  // Method chosen by the record: kRingDown for a free decay, kInputOutput for a
  // record with inputs, else kCovarianceDriven.
  kAutomatic,
  kCovarianceDriven,  // with the data-driven one as a check
  kDataDriven,
  kInputOutput,
  kRingDown,
};
// Returns "covariance_driven", "input_output" and so on.
const char* ModalMethodName(ModalMethod method);

// Options of IdentifyModes.
struct ModeIdentificationOptions {
  // Method of identification.
  ModalMethod method = ModalMethod::kAutomatic;
  // Frequency range of the search in Hz. Default (0): the lower limit is 50 /
  // duration, or 5 / duration for a free decay. The upper limit is 0.475 times
  // the sampling rate, or 0.425 times with measured loads.
  double lowest_hz = 0.0;
  double highest_hz = 0.0;
  // Number of block rows of the Hankel matrix. Default (0): chosen between 12
  // and 40 so that the matrix has about 600 rows. For a ring-down, at most a
  // third of its samples.
  int block_rows = 0;
  // Highest model order, even. Default (0): 60, or as many as the channels
  // allow.
  int max_order = 0;
  // Names of the channels that correlations are computed with (references).
  // Empty: all channels. A ring-down does not use them.
  std::vector<std::string> references;
  // Limits for poles that count as modes.
  StabilisationOptions stabilisation;
  int num_threads = 1;
};

// Result of IdentifyModes.
struct ModesOfRecord {
  // Method that was used; never kAutomatic.
  ModalMethod method = ModalMethod::kCovarianceDriven;
  std::vector<IdentifiedMode> modes;  // ascending frequency
  std::vector<AnalysedBand> bands;    // highest band first
  // Remarks for the user, one sentence each.
  std::vector<std::string> remarks;
};

// Identifies the modes of a record.
//
// The modes of a structure may spread over decades of frequency. A Hankel
// matrix covers only frequencies that have a few periods within its lags. The
// record is therefore analysed at its own sampling rate, at half of it, and so
// on. Each analysis covers 0.2 to 0.8 of half its rate. The first one extends
// to highest_hz, the last one to lowest_hz. If two rates find the same mode,
// the more certain estimate is used.
//
// Returns false, with a sentence in *error, if the record is not valid or too
// short. Also returns false if options do not fit the record, such as a method
// that needs inputs or samples without gaps. *option is then the name of the
// option at fault, or empty if no option is. `option` may be null.
[[nodiscard]] bool IdentifyModes(const ResponseRecord& record,
                                 const ModeIdentificationOptions& options,
                                 ModesOfRecord* result, std::string* error,
                                 std::string* option = nullptr);

}  // namespace pinode

#endif  // PINODE_MODAL_IDENTIFY_MODES_H_
