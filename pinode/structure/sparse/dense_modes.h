// Lowest modes of a small model, by a dense solver. Not meant for other layers.

#ifndef PINODE_STRUCTURE_SPARSE_DENSE_MODES_H_
#define PINODE_STRUCTURE_SPARSE_DENSE_MODES_H_

#include <string>
#include <vector>

#include "pinode/structure/sparse/checked_modes.h"

namespace pinode {

// Computes the `num_modes` lowest modes, or all if there are fewer, ascending.
// `with_mass` is the number of DOFs that have mass and may move. `model` has a
// shift already; it is moved.
//
// One inverse operator has the modes to a relative error of
//
//   rounding (w^2 - shift)^2 / (|w^2| |shift|),
//
// so a shift serves some six decades of w^2 on either side. Modes farther away
// are computed with a shift of their own size. The number of a mode in its
// order is the same from every shift.
[[nodiscard]] bool DenseModes(ShiftedModel* model, int num_modes, int with_mass,
                              std::vector<CheckedMode>* modes,
                              std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_SPARSE_DENSE_MODES_H_
