// What elements of an input deck are made of: sections with their materials,
// springs and masses, as the blocks of the deck that hold their numbers.

#ifndef PINODE_STRUCTURE_DECKS_DECK_CONTENTS_H_
#define PINODE_STRUCTURE_DECKS_DECK_CONTENTS_H_

#include <map>
#include <string>
#include <vector>

#include "pinode/structure/decks/deck_assembly.h"
#include "pinode/structure/decks/deck_blocks.h"
#include "pinode/structure/decks/deck_numbers.h"

namespace pinode {

// A section (with a material), springs or masses.
struct DeckOwner {
  size_t block = 0;
  std::string set;            // its name as the deck has it
  std::string material;       // key of DeckContents::materials; empty: none
  std::vector<int> elements;  // ascending
  SpringStart spring = SpringStart::kUnknown;
  // Blocks below a section that would keep their part of its stiffness or mass.
  std::vector<size_t> kept_stiffness, kept_mass;

  double stiffness = 1.0, mass = 1.0;  // factors
  bool scaled_stiffness = false, scaled_mass = false;
};

struct DeckMaterial {
  std::string name;           // in upper case, with its quotes
  size_t first = 0, end = 0;  // blocks
  // Those of *ELASTIC and *DENSITY, and what stands in the way of a copy: a
  // keyword that nobody knows, numbers behind the material's end.
  std::vector<size_t> numbers;
  std::vector<size_t> in_the_way;
  // Blocks that use it and have no factor.
  std::vector<size_t> sections, unknown_uses;
};

struct DeckContents {
  std::string path;
  DeckAssembly assembly;
  std::vector<DeckBlock> blocks;
  std::map<std::string, DeckMaterial> materials;  // by DeckKey
  std::vector<DeckOwner> owners;
  // Blocks of keywords that add stiffness or mass to elements, wherever they
  // stand.
  std::vector<size_t> added_stiffness, added_mass;

  // Blocks of an owner's stiffness or mass; none where it has no such part.
  std::vector<size_t> BlocksOf(const DeckOwner& owner, bool mass) const;
};

[[nodiscard]] bool ReadDeckContents(const std::string& path,
                                    const std::string& content,
                                    DeckContents* contents, std::string* error);

// Scales the owners' materials by their factors. Where the sections of a
// material differ, all but those without factors (or else the first) get a
// copy.
[[nodiscard]] bool ScaleDeckMaterials(DeckContents* contents,
                                      std::string* error);

// By factors of stiffness and mass.
[[nodiscard]] bool ScaleDeckBlock(double stiffness, double mass,
                                  SpringStart spring, DeckBlock* block,
                                  std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_DECK_CONTENTS_H_
