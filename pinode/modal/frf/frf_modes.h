// Modes of frequency response functions, with intervals.

#ifndef PINODE_MODAL_FRF_FRF_MODES_H_
#define PINODE_MODAL_FRF_FRF_MODES_H_

#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/types.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/record/frf/frequency_responses.h"

namespace pinode {

// Residues and scale of a mode.
struct FrfModeScale {
  // Residues of receptance, responses x references (unit of the FRF times s),
  // and standard deviations of their real and imaginary parts.
  ComplexMatrix residues;
  Matrix sigma_real, sigma_imaginary;
  // Modal A of the shape whose largest entry is 1 (the residue at the driving
  // point is the square of the shape there over A), and the modal mass A / (2 i
  // times the damped angular frequency), with its standard deviation. NaN
  // without a driving point: the mode is not scaled.
  std::complex<double> modal_a = {kNaN, kNaN};
  double modal_mass = kNaN;
  double modal_mass_sigma = kNaN;
};

struct FrfModesOptions {
  // Band, highest order, limits and threads; other fields are not used.
  ModeIdentificationOptions identification;
  // True: each file has poles of its own, because the structure drifted between
  // the files. Intervals of frequency and damping hold the drift.
  bool poles_per_file = false;
};

struct ModesOfFrfs {
  ModesOfRecord record;
  // Places of the shapes' entries: the responses or, if there are more, the
  // references (reciprocity).
  std::vector<std::string> places;
  std::vector<FrfModeScale> scales;  // of each mode
  // Lines in the band, and the model's FRFs there: lines x pairs.
  Vector frequencies_hz;
  ComplexMatrix measured, synthesised;
  std::vector<std::string> pair_names;  // "response/reference"
  // Coherence of the measured ones, lines x pairs; no rows: not known.
  Matrix coherence;
  Eigen::Index num_responses = 0;
  // For each pair, the norm of the error of synthesis as a part of that of the
  // FRF.
  Vector errors;
};

// Finds the modes: poles by poly-reference least squares over many orders, from
// which stable ones are taken (FindClusters), then a modal model by maximum
// likelihood (FitFrfModes). A mode must explain what noise near its frequency
// does not. An exponential window of the functions is taken off the damping.
// Fails with a sentence if there are too few lines.
[[nodiscard]] bool FindFrfModes(const FrequencyResponses& responses,
                                const FrfModesOptions& options,
                                ModesOfFrfs* result, std::string* error);

}  // namespace pinode

#endif  // PINODE_MODAL_FRF_FRF_MODES_H_
