// [[frf]]: measured frequency response functions of the structure.

#ifndef PINODE_CASE_SECTIONS_FRF_SECTION_H_
#define PINODE_CASE_SECTIONS_FRF_SECTION_H_

#include <string>
#include <vector>

#include "pinode/base/units.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/record/frf/frequency_responses.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// Files with the frequency response functions of one set-up.
struct FrfFiles {
  std::vector<std::string> files;
  // Places, one for all functions, or one for each in the order of the files;
  // empty: as the files have them.
  std::vector<std::string> responses, references;
  // "acceleration", "velocity", "displacement"; empty: as the files state.
  std::string quantity;
};

// Reads the files and puts their functions together. Fails with one line that
// says what to do.
[[nodiscard]] bool ReadFrfFiles(const FrfFiles& files, FrequencyResponses* all,
                                std::string* error);

// Reads all [[frf]] sections to problem->frfs, and their gains, delays and loss
// factor to problem->sensors. Assumptions about the files become remarks of the
// problem. Call it after ReadSensors.
[[nodiscard]] bool ReadFrfSections(const TomlTable& root,
                                   const UnitSystem& units,
                                   const StructuralModel& model,
                                   IdentificationProblem* problem);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_FRF_SECTION_H_
