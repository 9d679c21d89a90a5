// Comparison of the modes of two models of a structure.

#ifndef PINODE_STRUCTURE_MODEL_MODE_COMPARISON_H_
#define PINODE_STRUCTURE_MODEL_MODE_COMPARISON_H_

#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/types.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// Mode of the initial model and its partner in the updated model. Frequencies
// are in cycles per unit of the models' time. Without a frequency (see
// ModalProperties) or without a partner, values are NaN and the shape is empty.
struct ModePair {
  double initial_frequency = kNaN, updated_frequency = kNaN;
  // Damping ratios, as fractions of critical damping.
  double initial_damping = kNaN, updated_damping = kNaN;
  // Modal assurance criterion of the two shapes, 0 to 1.
  double mac = kNaN;
  int updated_mode = -1;  // index of the partner; -1: none
  // Mode shapes, one entry per DOF, mass-normalised.
  Vector initial_shape, updated_shape;
  // Effective mass of the updated mode, per direction of ground motion, as a
  // fraction of the moving mass; NaN in directions that move nothing.
  Vector updated_mass_shares;
};

// Modes of the initial model with those of the updated one.
struct PriorComparison {
  // Pairs of modes of the matrices with their groups, ascending by initial
  // frequency.
  std::vector<ModePair> modes;
  // Reason why there are no modes. Empty: there are modes.
  std::string why_no_modes;
};

// Pairs the modes of `initial`, in ascending order, with modes of `updated` so
// that the sum of the MACs is largest (PairModes). Before, the rigid-body modes
// of `updated` are combined to match those of `initial`. Returns false, with
// *error, if the modes of one model cannot be computed.
[[nodiscard]] bool CompareModes(const StructuralModel& initial,
                                const StructuralModel& updated,
                                std::vector<ModePair>* pairs,
                                std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MODEL_MODE_COMPARISON_H_
