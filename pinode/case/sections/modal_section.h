// [modal] and [[mode]]: measured modes of the structure.

#ifndef PINODE_CASE_SECTIONS_MODAL_SECTION_H_
#define PINODE_CASE_SECTIONS_MODAL_SECTION_H_

#include <vector>

#include "pinode/base/units.h"
#include "pinode/case/text/toml_table.h"
#include "pinode/dynamics/linear_dynamics.h"
#include "pinode/problem/measured_mode.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// Adds the covariates of [modal] that are not yet among `inputs`.
[[nodiscard]] bool AddModalCovariates(const TomlTable& root,
                                      std::vector<InputSpec>* inputs);

// Reads valid modes, frequencies in cycles per unit of the model's time.
// `inputs`: those of the dynamics. `beside_records`: there are training
// records; each mode then needs its own sigma or weight.
[[nodiscard]] bool ReadModes(const TomlTable& root, const UnitSystem& units,
                             const StructuralModel& model,
                             const std::vector<InputSpec>& inputs,
                             bool beside_records, ModalData* modal);

}  // namespace pinode

#endif  // PINODE_CASE_SECTIONS_MODAL_SECTION_H_
