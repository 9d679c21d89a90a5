#include "pinode/structure/mode_comparison.h"

#include "pinode/structure/modal_analysis.h"

namespace pinode {

bool CompareModes(const StructuralModel& initial,
                  const StructuralModel& updated, std::vector<ModePair>* pairs,
                  std::string* error) {
  ModalProperties before, after;
  if (!ComputeModes(initial.mass, initial.damping, initial.stiffness, &before,
                    error) ||
      !ComputeModes(updated.mass, updated.damping, updated.stiffness, &after,
                    error)) {
    return false;
  }
  const std::vector<int> partners =
      PairModes(before.mode_shapes, after.mode_shapes);
  pairs->clear();
  for (int i = 0; i < before.frequency_hz.size(); ++i) {
    ModePair pair;
    pair.initial_frequency = before.frequency_hz[i];
    pair.initial_damping = before.damping_ratio[i];
    pair.initial_shape = before.mode_shapes.col(i);
    const int partner = partners[static_cast<size_t>(i)];
    pair.updated_mode = partner;
    if (partner >= 0) {
      pair.updated_frequency = after.frequency_hz[partner];
      pair.updated_damping = after.damping_ratio[partner];
      pair.updated_shape = after.mode_shapes.col(partner);
      pair.mac = Mac(pair.initial_shape, pair.updated_shape);
    }
    pairs->push_back(std::move(pair));
  }
  return true;
}

}  // namespace pinode
