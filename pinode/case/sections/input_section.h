// [[record.ground]], [[record.force]], [[record.motion]] and
// [[record.covariate]]: the inputs of a record.

#ifndef PINODE_CASE_SECTIONS_INPUT_SECTION_H_
#define PINODE_CASE_SECTIONS_INPUT_SECTION_H_

#include <optional>
#include <string>
#include <vector>

#include "pinode/base/units.h"
#include "pinode/case/sections/signal_section.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/dynamics/linear_dynamics.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

struct InputSection {
  SignalSection signal;
  InputSpec spec;
  // Constant value of a covariate that is in no file.
  std::optional<double> value;

  explicit InputSection(const TomlTable& t) : signal(t) {}
};

// Returns the input for the `derivative`-th derivative (0 to 2) of the
// displacement that is prescribed at a DOF: motion_<dof>,
// motion_velocity_<dof>, motion_acceleration_<dof>.
InputSpec PrescribedInput(const StructuralModel& model, int dof,
                          int derivative);

// Reads all inputs of a record, whose table is `record` and whose own file is
// `record_file` (empty: none).
[[nodiscard]] bool ReadInputSections(const TomlTable& record,
                                     const std::string& record_file,
                                     const UnitSystem& units,
                                     const StructuralModel& model,
                                     std::vector<InputSection>* inputs);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_INPUT_SECTION_H_
