// Modes of files with frequency response functions.

#ifndef PINODE_CASE_RUN_FIND_FRF_MODES_H_
#define PINODE_CASE_RUN_FIND_FRF_MODES_H_

#include <string>
#include <vector>

#include "pinode/case/run/estimate_frfs.h"
#include "pinode/case/run/find_modes.h"
#include "pinode/case/sections/frf_section.h"
#include "pinode/modal/frf/frf_modes.h"

namespace pinode {

// Files of one set-up, and how their modes are found.
struct FrfSetup : FrfFiles {
  FrfModesOptions options;
};

// Reads the files and finds their modes. *frfs has what the report shows beside
// *found. Fails with one line that says what to do.
[[nodiscard]] bool FindModesOfFrfFiles(const FrfSetup& setup, ModesOfFrfs* frfs,
                                       FoundModes* found, std::string* error);

// Estimates the functions of a case with [modes.frf], and finds their modes.
[[nodiscard]] bool FindModesOfEstimatedFrfs(const ModesCase& c,
                                            EstimatedFrfs* estimated,
                                            ModesOfFrfs* frfs,
                                            FoundModes* found,
                                            std::string* error);

// Writes residues.csv to `folder`, a row for each mode: modal mass, modal A,
// and the residues of receptance with the deviations of their parts.
[[nodiscard]] bool WriteFrfFiles(const ModesOfFrfs& frfs,
                                 const std::string& folder, std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RUN_FIND_FRF_MODES_H_
