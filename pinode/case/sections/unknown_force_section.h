// [[unknown_force]]: forces that were not measured.

#ifndef PINODE_CASE_SECTIONS_UNKNOWN_FORCE_SECTION_H_
#define PINODE_CASE_SECTIONS_UNKNOWN_FORCE_SECTION_H_

#include <string>
#include <vector>

#include "pinode/case/sections/record_section.h"
#include "pinode/case/sections/terms_section.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"

namespace pinode {

// Returns the name of the input that is one in that record and zero in all
// others.
std::string RecordSwitchName(const std::string& record);

// Adds the switches that the unknown forces of the case need: none if there is
// only one record. Reports a force that names no record, or an unknown one.
[[nodiscard]] bool AddRecordSwitches(const TomlTable& root,
                                     const std::vector<RecordSection>& sections,
                                     std::vector<InputSpec>* inputs);

// Adds the unknown forces to *dynamics, whose inputs include their switches.
// Adds a remark for each force whose static part the sensors do not observe.
[[nodiscard]] bool ReadUnknownForces(const TomlTable& root,
                                     const TermsContext& context,
                                     const std::vector<RecordSection>& sections,
                                     StructuralDynamics* dynamics);

// Reads the columns that `truth` keys of unknown forces and networks name.
[[nodiscard]] bool ReadForceTruths(const TomlTable& root,
                                   const UnitSystem& units,
                                   const std::vector<RecordSection>& sections,
                                   std::vector<ForceTruth>* truths);

// Spreads networks of time alone whose weights were not given: the units of the
// first layer are centred at evenly spaced times of the training records. Drawn
// at random, all centres would lie within an input's scale of t = 0, and a fit
// does not move them to the other end of the record.
void SpreadNetworksOfTime(const TomlTable& root,
                          const IdentificationProblem& problem,
                          StructuralDynamics* dynamics);

// Checks conditions that need the records, and requirements of unknown forces
// on the options: noise levels that cannot be distinguished from a force,
// single shooting, intervals.
[[nodiscard]] bool CheckUnknownForces(
    const TomlTable& root, const std::vector<RecordSection>& sections,
    const IdentificationProblem& problem, IdentificationOptions* options);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_UNKNOWN_FORCE_SECTION_H_
