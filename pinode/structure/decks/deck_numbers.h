// Numbers of CalculiX and Abaqus input decks to which stiffness and mass are
// proportional.

#ifndef PINODE_STRUCTURE_DECKS_DECK_NUMBERS_H_
#define PINODE_STRUCTURE_DECKS_DECK_NUMBERS_H_

#include <string>
#include <vector>

#include "pinode/structure/decks/deck_blocks.h"

namespace pinode {

// Position of a number in a block: the index in `lines`, and the field in that
// line.
struct DeckNumber {
  size_t line = 0;
  size_t field = 0;
};

// Meaning of the first data line of a *SPRING, by the type of its elements.
enum class SpringStart {
  kUnknown,     // the type is not known
  kConstants,   // SPRINGA
  kDirections,  // SPRING1, SPRING2
};

// Finds the moduli of *ELASTIC, the constants or forces of *SPRING, and the
// numbers of *DENSITY, *MASS, *ROTARY INERTIA and *NONSTRUCTURAL MASS. Returns
// false with `file:line:` and the error for unknown kinds and for data that are
// not numbers. Also refuses springs of an unknown type whose first line is
// ambiguous.
[[nodiscard]] bool FindDeckNumbers(const DeckBlock& block, SpringStart start,
                                   std::vector<DeckNumber>* numbers,
                                   std::string* error);

void ScaleDeckNumbers(const std::vector<DeckNumber>& numbers, double factor,
                      DeckBlock* block);

std::vector<double> DeckValues(const std::vector<DeckNumber>& numbers,
                               const DeckBlock& block);

// Sets *error to `place: what` and returns false.
bool FailInDeckBlock(const DeckBlock& block, const std::string& what,
                     std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_DECK_NUMBERS_H_
