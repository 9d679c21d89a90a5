// Masses of floors and stiffnesses of storeys, as engineers write them.

#ifndef PINODE_CASE_DRAFT_FLOOR_WEIGHTS_H_
#define PINODE_CASE_DRAFT_FLOOR_WEIGHTS_H_

#include <string>
#include <vector>

#include "pinode/base/units.h"

namespace pinode {

struct FloorMasses {
  // Units that go with the weights: N, m for N, kgf and kg; kN, m for kN, MN
  // and t; kip, in for kip and lbf.
  UnitSystem units;
  // Masses from the lowest floor up, in these units.
  std::vector<double> masses;
  // Sentence on where they come from, such as "900 kN / 9.80665 m/s^2".
  std::string origin;
};

// Reads "900 kN", "900, 900, 700 kN" or "2000 kg, 1800 kg" as the masses of
// `storeys` floors. One value serves all floors, and a unit all values before
// it that have none. Forces are weights; kg and t are masses, and so is lb,
// whose weight is 1 lbf. Refuses a value without unit, a ton (of 1000 kg, 2000
// lb or 2240 lb?), and values that are not positive or too few.
[[nodiscard]] bool ParseFloorWeights(const std::string& text, int storeys,
                                     FloorMasses* masses, std::string* error);

// Reads "150000 kN/m" or one value a storey, from the lowest up, as stiffnesses
// in `units`. Units are a force over a length.
[[nodiscard]] bool ParseStoreyStiffnesses(const std::string& text, int storeys,
                                          const UnitSystem& units,
                                          std::vector<double>* stiffnesses,
                                          std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_DRAFT_FLOOR_WEIGHTS_H_
