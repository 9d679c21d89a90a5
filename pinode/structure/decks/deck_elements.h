// Types of elements in input decks of CalculiX and Abaqus.

#ifndef PINODE_STRUCTURE_DECKS_DECK_ELEMENTS_H_
#define PINODE_STRUCTURE_DECKS_DECK_ELEMENTS_H_

#include <string>

#include "pinode/structure/model/geometry.h"

namespace pinode {

// Kind of an element: the source of its stiffness and mass.
enum class DeckElementKind {
  kOther,               // both, by a section
  kSpringOfItsLength,   // SPRINGA: stiffness
  kSpringOfDirections,  // SPRING1, SPRING2: stiffness
  kGap,                 // stiffness
  kDashpot,             // neither
  kMass,                // mass
};

struct DeckElementType {
  const char* name;  // without the letters of its formulation
  ElementShape shape;
  int num_nodes;
  DeckElementKind kind;

  bool HasStiffness() const;
  bool HasMass() const;
};

// Returns the type with the longest name that `name` begins with, if only
// letters of a formulation follow, as in C3D8I or S9R5. Returns nullptr for an
// unknown type. `name` is in upper case.
const DeckElementType* FindDeckElementType(const std::string& name);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_DECK_ELEMENTS_H_
