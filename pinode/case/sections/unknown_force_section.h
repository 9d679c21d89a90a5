// [[unknown_force]]: forces that nobody measured.

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

// The columns that `truth` keys of unknown forces and networks name.
[[nodiscard]] bool ReadForceTruths(const TomlTable& root,
                                   const UnitSystem& units,
                                   const std::vector<RecordSection>& sections,
                                   std::vector<ForceTruth>* truths);

// Networks of time alone whose weights were not given: each unit of the first
// layer has its middle at another time of the training records, evenly spread.
// Drawn at random, all middles would lie within an input's scale of t = 0, and
// a fit does not carry them to the other end of the record.
void SpreadNetworksOfTime(const TomlTable& root,
                          const IdentificationProblem& problem,
                          StructuralDynamics* dynamics);

// What can be said only when the records are read, and what unknown forces ask
// of the options: noise levels that cannot be told from a force, single
// shooting, intervals.
[[nodiscard]] bool CheckUnknownForces(
    const TomlTable& root, const std::vector<RecordSection>& sections,
    const IdentificationProblem& problem, IdentificationOptions* options);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_UNKNOWN_FORCE_SECTION_H_
