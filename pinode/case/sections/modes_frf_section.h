// [modes.frf]: how pinode_modes estimates frequency response functions.

#ifndef PINODE_CASE_SECTIONS_MODES_FRF_SECTION_H_
#define PINODE_CASE_SECTIONS_MODES_FRF_SECTION_H_

#include "pinode/case/text/toml_table.h"
#include "pinode/record/frf/frf_estimate.h"

namespace pinode {

// [modes.frf]. Blocks are in s, because records may differ in their steps.
struct ModesFrfSection {
  FrfEstimateOptions options;  // all but block_samples
  double block = 0.0;          // s; 0: chosen
  bool has_overlap = false;    // true: it is given, not the default
};

// Reads the table.
[[nodiscard]] bool ReadModesFrfSection(const TomlTable& table,
                                       ModesFrfSection* section);

// Reads the names of an estimator ("h1", "h2", "hv") and of an excitation
// ("automatic", "blows", "random", "periodic"). Returns false for others.
[[nodiscard]] bool ParseFrfEstimator(const std::string& name,
                                     FrfEstimator* estimator);
[[nodiscard]] bool ParseFrfExcitation(const std::string& name,
                                      FrfExcitation* excitation);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_MODES_FRF_SECTION_H_
