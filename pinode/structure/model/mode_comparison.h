// Compares the modes of a structure before and after a change.

#ifndef PINODE_STRUCTURE_MODEL_MODE_COMPARISON_H_
#define PINODE_STRUCTURE_MODEL_MODE_COMPARISON_H_

#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/types.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// One mode of the first model and its partner in the second. Frequencies are in
// cycles per unit of the models' time. They are NaN, and the shape is empty, if
// the mode has none (see ModalProperties) or no partner.
struct ModePair {
  double initial_frequency = kNaN, updated_frequency = kNaN;
  // Damping ratios, as fractions of critical damping.
  double initial_damping = kNaN, updated_damping = kNaN;
  double mac = kNaN;
  int updated_mode = -1;                // index of the partner, -1 without one
  Vector initial_shape, updated_shape;  // num_dofs, mass-normalised
};

// Modes of the initial model beside those of the updated one.
struct PriorComparison {
  // Modes of the matrices with their groups, before and after, in cycles per
  // unit of the model's time.
  std::vector<ModePair> modes;
  // Reason why there are no modes. Empty: there are some.
  std::string why_no_modes;
};

// Pairs the modes of `initial`, in ascending order, with modes of `updated` by
// PairModes (largest total MAC). The rigid-body modes of `updated` are first
// combined to match those of `initial`. Returns false if the modes of either
// cannot be computed.
[[nodiscard]] bool CompareModes(const StructuralModel& initial,
                                const StructuralModel& updated,
                                std::vector<ModePair>* pairs,
                                std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_MODE_COMPARISON_H_
