// [[unknown_force]]: forces that nobody measured.

#ifndef PINODE_CASE_UNKNOWN_FORCE_SECTION_H_
#define PINODE_CASE_UNKNOWN_FORCE_SECTION_H_

#include <string>
#include <vector>

#include "pinode/case/record_section.h"
#include "pinode/case/terms_section.h"
#include "pinode/case/toml_table.h"
#include "pinode/dynamics/structural_dynamics.h"

namespace pinode {

// Name of the input that is one in that record and zero in all others.
std::string RecordSwitchName(const std::string& record);

// Adds the switches that the unknown forces of the case need: none where there
// is one record only. Says which force names no record, or one that is not
// there.
[[nodiscard]] bool AddRecordSwitches(const TomlTable& root,
                                     const std::vector<RecordSection>& sections,
                                     std::vector<InputSpec>* inputs);

// Adds the unknown forces to *dynamics, whose inputs have their switches, and a
// remark for each of which the sensors do not see the static part.
[[nodiscard]] bool ReadUnknownForces(const TomlTable& root,
                                     const TermsContext& context,
                                     const std::vector<RecordSection>& sections,
                                     StructuralDynamics* dynamics);

}  // namespace pinode

#endif  // PINODE_CASE_UNKNOWN_FORCE_SECTION_H_
