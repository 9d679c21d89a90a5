// scale = {...} of [[record.force]]: measured forces whose scale is unknown.

#ifndef PINODE_CASE_SECTIONS_FORCE_SCALE_SECTION_H_
#define PINODE_CASE_SECTIONS_FORCE_SCALE_SECTION_H_

#include <string>
#include <vector>

#include "pinode/case/sections/record_section.h"
#include "pinode/case/sections/terms_section.h"
#include "pinode/case/text/toml_value.h"
#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// Returns the name of the unknown for `scale = {...}` of a force:
// "scale.<name>" by the key `name` of the scale, else "scale.force_<dof>".
// Empty if `scale` is a number or not given.
std::string ForceScaleName(const TomlValue& force);

// Adds the record switches that are needed if a force has several scales.
// `scale.<name>` is one unknown for all forces of that name, at any DOF and in
// any record. A force without `scale` has the one named after its DOF, if
// another record gives it; a remark says so. A number is a known scale.
void AddScaleSwitches(const std::vector<RecordSection>& sections,
                      std::vector<InputSpec>* inputs);

// Adds the unknown scales to *dynamics, whose inputs include their switches.
[[nodiscard]] bool ReadForceScales(const std::vector<RecordSection>& sections,
                                   const TermsContext& context,
                                   StructuralDynamics* dynamics);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_FORCE_SCALE_SECTION_H_
