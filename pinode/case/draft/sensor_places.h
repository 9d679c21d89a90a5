// Places of sensors by the names of their columns.

#ifndef PINODE_CASE_DRAFT_SENSOR_PLACES_H_
#define PINODE_CASE_DRAFT_SENSOR_PLACES_H_

#include <string>
#include <vector>

namespace pinode {

// Place of a sensor on a building: 0 is the base, 1 the lowest floor above it.
inline constexpr int kPlaceUnclear = -1;

struct PlacesByName {
  // Place of each column, or kPlaceUnclear.
  std::vector<int> places;
  // Reason for the first unclear one, such as "'acc_6': the building has 5
  // storeys"; empty if all are clear.
  std::string doubt;
};

// Finds the places that names of columns state: "Boden", "base", "ground" are
// the base; "Dach", "roof" the highest floor; "Etage 2", "3. OG", "2. Stock"
// these floors above the base. Numbers without such a word (`acc_3`) are floors
// only if they are 1 to `storeys` without a gap, and "floor 2" only if there is
// a floor 1: elsewhere the ground is counted as the first floor. Numbers of
// channels (`CH3`, `Kanal 3`, `column_3`) say nothing. Two columns at one place
// are both unclear.
PlacesByName FindPlacesByName(const std::vector<std::string>& names,
                              int storeys);

}  // namespace pinode

#endif  // PINODE_CASE_DRAFT_SENSOR_PLACES_H_
