// Properties of the elements of an input deck: sections with their materials,
// springs and masses. They refer to the blocks of the deck that hold their
// numbers.

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
  // Blocks below a section that a factor on its stiffness or mass would not
  // scale.
  std::vector<size_t> kept_stiffness, kept_mass;

  double stiffness = 1.0, mass = 1.0;  // factors
  bool scaled_stiffness = false, scaled_mass = false;
};

struct DeckMaterial {
  std::string name;           // in upper case, with its quotes
  size_t first = 0, end = 0;  // blocks
  // Blocks of *ELASTIC and *DENSITY. `in_the_way`: blocks that prevent a
  // copy: an unknown keyword, or numbers behind the material's end.
  std::vector<size_t> numbers;
  std::vector<size_t> in_the_way;
  // Blocks that use the material and have no factor.
  std::vector<size_t> sections, unknown_uses;
};

struct DeckContents {
  std::string path;
  DeckAssembly assembly;
  std::vector<DeckBlock> blocks;
  std::map<std::string, DeckMaterial> materials;  // by DeckKey
  std::vector<DeckOwner> owners;
  // Blocks of keywords that add stiffness or mass to elements, anywhere in the
  // deck.
  std::vector<size_t> added_stiffness, added_mass;

  // Returns the blocks of an owner's stiffness or mass; empty if it has none.
  std::vector<size_t> BlocksOf(const DeckOwner& owner, bool mass) const;
};

[[nodiscard]] bool ReadDeckContents(const std::string& path,
                                    const std::string& content,
                                    DeckContents* contents, std::string* error);

// Scales the owners' materials by their factors. If the sections of a material
// have different factors, all but those without factors (or else the first) get
// a copy.
[[nodiscard]] bool ScaleDeckMaterials(DeckContents* contents,
                                      std::string* error);

// Scales the numbers of a block by factors of stiffness and mass.
[[nodiscard]] bool ScaleDeckBlock(double stiffness, double mass,
                                  SpringStart spring, DeckBlock* block,
                                  std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_DECK_CONTENTS_H_
