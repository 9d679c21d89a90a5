// Modes before and after a change of the structure.

#ifndef PINODE_STRUCTURE_MODEL_MODE_COMPARISON_H_
#define PINODE_STRUCTURE_MODEL_MODE_COMPARISON_H_

#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/types.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// One mode of the first model and its partner in the second. Frequencies are
// in cycles per unit of the models' time; NaN, and an empty shape, where the
// mode has none (see ModalProperties) or no partner.
struct ModePair {
  double initial_frequency = kNaN, updated_frequency = kNaN;
  // Fractions of critical damping.
  double initial_damping = kNaN, updated_damping = kNaN;
  double mac = kNaN;
  int updated_mode = -1;                // index of the partner, -1 without one
  Vector initial_shape, updated_shape;  // num_dofs, mass-normalised
};

// Modes of the model before an identification, beside those of the one found.
struct PriorComparison {
  // Modes of the matrices with their groups, before and after, in cycles per
  // unit of the model's time.
  std::vector<ModePair> modes;
  // Why there are no modes; empty where there are.
  std::string why_no_modes;
};

// Modes of `initial` in ascending order with their partners in `updated` by
// PairModes (largest total MAC), rigid-body modes of `updated` mixed to be like
// those of `initial`. False where the modes of either cannot be
// computed.
[[nodiscard]] bool CompareModes(const StructuralModel& initial,
                                const StructuralModel& updated,
                                std::vector<ModePair>* pairs,
                                std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_MODE_COMPARISON_H_
