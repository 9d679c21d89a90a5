// Identifies the modes of a structure from sensor records, without a model. The
// loads may be unmeasured, measured, or absent (free decay).

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

// One identified mode.
struct IdentifiedMode {
  double frequency_hz = 0.0;  // |s| / (2 pi)
  double damping_ratio = 0.0;
  // Shape as displacements at the channels' places, in the units of the
  // channels, whatever quantity was measured there. A mode's velocities are s
  // times, its accelerations s^2 times as large. The largest entry is 1.
  Eigen::VectorXcd shape;
  // Standard deviations of frequency, damping ratio, and the real and imaginary
  // part of each entry of the shape.
  double frequency_sigma = 0.0;
  double damping_sigma = 0.0;
  Vector shape_sigma_real;
  Vector shape_sigma_imaginary;
  // Covariance of frequency (Hz), damping ratio, real parts, imaginary parts.
  Matrix covariance;
  // Degrees of freedom of these standard deviations, for Student's t, and the
  // 95 % intervals.
  double degrees_of_freedom = 0.0;
  double frequency_lower95 = 0.0, frequency_upper95 = 0.0;
  double damping_lower95 = 0.0, damping_upper95 = 0.0;
  // Statistics over model orders: number of orders that contain the mode,
  // number of orders that could, and standard deviations between the orders in
  // the mean.
  int orders_seen = 0, orders_possible = 0;
  double frequency_spread = 0.0;  // Hz
  double damping_spread = 0.0;
  // Mean phase collinearity of the shape: 1 if all points move in phase (J. N.
  // Juang, R. S. Pappa 1986).
  double phase_collinearity = 0.0;
  // True for a harmonic of a machine: its damping interval holds zero, and it
  // has the constant amplitude and the kurtosis of a sine.
  bool is_harmonic = false;
  // Sampling step at which the mode was found.
  double sampling_step = 0.0;
  // Estimates of the data-driven identification, as a check of a
  // covariance-driven one. NaN: it did not find the mode, or was not run.
  double check_frequency_hz = kNaN;
  double check_damping_ratio = kNaN;
};

// A pole of the stabilisation diagram.
struct DiagramPole {
  int order = 0;
  double frequency_hz = 0.0;
  double frequency_sigma = 0.0;
  double damping_ratio = 0.0;
  int mode = -1;  // in ModesOfRecord::modes; -1: no mode
};

// The record at one sampling rate, analysed in a band of frequencies.
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
  // Method chosen by the record: kRingDown for a free decay, kInputOutput for a
  // record with inputs, else kCovarianceDriven.
  kAutomatic,
  kCovarianceDriven,  // with the data-driven one as a check
  kDataDriven,
  kInputOutput,
  kRingDown,
};
// Returns "covariance_driven" and so on.
const char* ModalMethodName(ModalMethod method);

struct ModeIdentificationOptions {
  ModalMethod method = ModalMethod::kAutomatic;
  // Frequency range of the search, Hz. Default (0): from 50 cycles in the
  // record to 0.95 of half the sampling rate.
  double lowest_hz = 0.0;
  double highest_hz = 0.0;
  // Number of block rows of the Hankel matrix. Default (0): 12 to 40 blocks,
  // about 600 rows. For a ring-down, at most a third of its samples.
  int block_rows = 0;
  // Highest model order, even. Default (0): 60, or as many as the channels
  // allow.
  int max_order = 0;
  // Names of the reference channels of the correlations. Default: all. Not used
  // for a ring-down.
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

// Identifies the modes of a record.
//
// A structure's modes spread over decades. A Hankel matrix covers only
// frequencies of which a few periods fit its lags. The record is therefore
// analysed at its own rate and at successive halves of it. Each analysis covers
// 0.2 to 0.8 of half the rate (the lowest one down to lowest_hz). If two rates
// find the same mode, the more certain estimate is used.
//
// Returns false with a sentence if the record is too short, or if options do
// not fit it: a method that needs inputs, or samples without gaps. *option (may
// be null) is then the name of the given option at fault, or empty if no option
// is.
[[nodiscard]] bool IdentifyModes(const ResponseRecord& record,
                                 const ModeIdentificationOptions& options,
                                 ModesOfRecord* result, std::string* error,
                                 std::string* option = nullptr);

}  // namespace pinode

#endif  // PINODE_MODAL_IDENTIFY_MODES_H_
