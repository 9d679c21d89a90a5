// Result of pinode_modes: the modes of each record, and of all together.

#ifndef PINODE_CASE_RUN_FIND_MODES_H_
#define PINODE_CASE_RUN_FIND_MODES_H_

#include <optional>
#include <string>
#include <vector>

#include "pinode/case/results/modes_files.h"
#include "pinode/case/sections/modes_section.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/study/picture/structure_picture.h"

namespace pinode {

struct FoundModes {
  std::vector<ModesOfRecord> by_record;
  // Merged, at DOFs where sensors determine them, with the remarks of all.
  ModesResult result;
  // Set if the case has a geometry.
  std::optional<StructurePicture> picture;
};

// False with one line that names the file and, where the case is one, the line
// of what is at fault: the record, or the option of [modes].
[[nodiscard]] bool FindModes(const ModesCase& c, FoundModes* found,
                             std::string* error);

// Gives the merged modes their DOFs, and the picture of a case with a geometry.
void PlaceModes(const ModesCase& c, FoundModes* found);

}  // namespace pinode

#endif  // PINODE_CASE_RUN_FIND_MODES_H_
