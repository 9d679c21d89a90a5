// The picture of a case's structure, where [geometry] says where it is.

#ifndef PINODE_CASE_RESULTS_CASE_PICTURE_H_
#define PINODE_CASE_RESULTS_CASE_PICTURE_H_

#include <optional>
#include <string>

#include "pinode/case/sections/case_file.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/study/damage/damage_analysis.h"
#include "pinode/study/picture/structure_picture.h"

namespace pinode {

// What was found for c.problem, drawn; none where the case has no [geometry].
// `damage`: what changed since a baseline, or nullptr.
std::optional<StructurePicture> PictureOfCase(
    const Case& c, const IdentificationSummary& summary,
    const IdentifiedModel& model, const DamageResult* damage);

// As `folder`/structure.vtu; without a picture nothing is written.
[[nodiscard]] bool WriteVtu(const std::optional<StructurePicture>& picture,
                            const std::string& folder, std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_CASE_PICTURE_H_
