// The numbers of input decks of CalculiX and Abaqus that stiffness and mass are
// in proportion to.

#ifndef PINODE_STRUCTURE_DECKS_DECK_NUMBERS_H_
#define PINODE_STRUCTURE_DECKS_DECK_NUMBERS_H_

#include <string>
#include <vector>

#include "pinode/structure/decks/deck_blocks.h"

namespace pinode {

// A number of a block: of `lines`, and of the fields of that line.
struct DeckNumber {
  size_t line = 0;
  size_t field = 0;
};

// What the first data line of a *SPRING is, by the type of its elements.
enum class SpringStart {
  kUnknown,     // the type is not known
  kConstants,   // SPRINGA
  kDirections,  // SPRING1, SPRING2
};

// Moduli of *ELASTIC, constants or forces of *SPRING, *DENSITY, *MASS,
// *ROTARY INERTIA and *NONSTRUCTURAL MASS. False with `file:line: what` for
// kinds that are not known, for data that are no numbers, and for springs of an
// unknown type whose first line may be either.
[[nodiscard]] bool FindDeckNumbers(const DeckBlock& block, SpringStart start,
                                   std::vector<DeckNumber>* numbers,
                                   std::string* error);

void ScaleDeckNumbers(const std::vector<DeckNumber>& numbers, double factor,
                      DeckBlock* block);

std::vector<double> DeckValues(const std::vector<DeckNumber>& numbers,
                               const DeckBlock& block);

// `place: what`; returns false.
bool FailInDeckBlock(const DeckBlock& block, const std::string& what,
                     std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_DECK_NUMBERS_H_
