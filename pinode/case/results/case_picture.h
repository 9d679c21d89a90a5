// Picture of a case's structure, if [geometry] places it.

#ifndef PINODE_CASE_RESULTS_CASE_PICTURE_H_
#define PINODE_CASE_RESULTS_CASE_PICTURE_H_

#include <optional>
#include <string>

#include "pinode/case/sections/case_file.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/study/damage/damage_analysis.h"
#include "pinode/study/picture/structure_picture.h"

namespace pinode {

// Returns the picture of the results for c.problem; none if the case has no
// [geometry]. `damage`: changes since a baseline, or nullptr.
std::optional<StructurePicture> PictureOfCase(
    const Case& c, const IdentificationSummary& summary,
    const IdentifiedModel& model, const DamageResult* damage);

// Writes `folder`/structure.vtu, if there is a picture.
[[nodiscard]] bool WriteVtu(const std::optional<StructurePicture>& picture,
                            const std::string& folder, std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_CASE_PICTURE_H_
