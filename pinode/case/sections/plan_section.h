// [plan]: possible sensors to choose from.

#ifndef PINODE_CASE_SECTIONS_PLAN_SECTION_H_
#define PINODE_CASE_SECTIONS_PLAN_SECTION_H_

#include <string>
#include <vector>

#include "pinode/base/units.h"
#include "pinode/case/sections/record_section.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/case/text/toml_value.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/study/reduction/reduced_structure.h"
#include "pinode/study/sensors/sensor_plan.h"

namespace pinode {

// Reads the section. `problem` is complete, except that its responses may be
// missing. `structure`: the finite-element model of which its model is a
// reduction, or nullptr. Without [[plan.candidate]] the candidates are sensors
// for the absolute acceleration at every translational DOF that moves freely.
// With a finite-element model these are the DOFs of the whole model, observed
// by x = T r.
[[nodiscard]] bool ReadPlan(const TomlTable& root, const UnitSystem& units,
                            const ReducedStructure* structure,
                            const std::vector<RecordSection>& sections,
                            const IdentificationProblem& problem,
                            SensorRequest* request);

// Moves the first [[record.force]] of each record of the case `tree` to the DOF
// `force_dof` and removes all others and [[record.ground]]. Does nothing if
// `force_dof` is empty. Returns false, with one line in *error, if a record has
// no force.
[[nodiscard]] bool MoveForces(const std::string& path,
                              const std::string& force_dof, TomlValue* tree,
                              std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_PLAN_SECTION_H_
