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

// Name of the unknown that `scale = {...}` of a force makes: "scale.<name>" by
// the key `name` of the scale, else "scale.force_<dof>". Empty where `scale` is
// a number or not given.
std::string ForceScaleName(const TomlValue& force);

// `scale.<name>` is one unknown for all forces that have that name, whatever
// their DOF or record. A force that says nothing of its scale has the one that
// goes by its DOF, where another record gives it; a remark says so. A number is
// a known scale.
//
// Adds the record switches that are needed where a force has several scales.
void AddScaleSwitches(const std::vector<RecordSection>& sections,
                      std::vector<InputSpec>* inputs);

// Adds the unknown scales to *dynamics, whose inputs have their switches.
[[nodiscard]] bool ReadForceScales(const std::vector<RecordSection>& sections,
                                   const TermsContext& context,
                                   StructuralDynamics* dynamics);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_FORCE_SCALE_SECTION_H_
