// [[record]] with excitation = "ambient", and its [record.ambient].

#ifndef PINODE_CASE_SECTIONS_AMBIENT_SECTION_H_
#define PINODE_CASE_SECTIONS_AMBIENT_SECTION_H_

#include <vector>

#include "pinode/base/units.h"
#include "pinode/case/sections/record_section.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Reads the numbers of the ambient records among `sections` and appends them to
// problem->ambient.
[[nodiscard]] bool ReadAmbientRecords(
    const std::vector<RecordSection>& sections, const UnitSystem& units,
    const StructuralDynamics& dynamics, IdentificationProblem* problem);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_AMBIENT_SECTION_H_
