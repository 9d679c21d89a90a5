// What element sets of input decks of CalculiX and Abaqus are made of, and the
// same deck with factors on it.

#ifndef PINODE_STRUCTURE_DECKS_DECK_PROPERTIES_H_
#define PINODE_STRUCTURE_DECKS_DECK_PROPERTIES_H_

#include <string>
#include <vector>

namespace pinode {

// A section with its material, springs or point masses: the numbers that
// stiffness and mass are in proportion to, in the deck's order.
struct DeckProperty {
  std::string set;  // elements that have it
  // Moduli of *ELASTIC (no Poisson's ratios), constants or forces of *SPRING.
  std::vector<double> stiffness;
  // *DENSITY, *MASS, *ROTARY INERTIA, *NONSTRUCTURAL MASS.
  std::vector<double> mass;
};

// By what to multiply what an element set contributes.
struct DeckFactor {
  std::string set;
  bool is_mass = false;  // else stiffness
  double factor = 1.0;
};

// Of *SOLID, *SHELL, *MEMBRANE, *BEAM and *TRUSS SECTION with MATERIAL,
// *SPRING, *MASS, *ROTARY INERTIA and *NONSTRUCTURAL MASS, in the deck's order.
// False, with `file:line: what, and what was expected`.
[[nodiscard]] bool ReadDeckProperties(const std::string& path,
                                      const std::string& content,
                                      std::vector<DeckProperty>* properties,
                                      std::string* error);

// *scaled: the deck, included files in their places, with the properties of
// each set times its factors and everything else as it is. A material that
// other sections share, composites and general ones too, gets a copy. Sets are
// called as in deck_geometry.h; the section of a part is that of all its
// instances. Refused are names that several sets have, sets of which a section,
// spring or mass has elements outside, sets that two factors of a kind would
// change, elements without a property that could be changed (general sections,
// composites, types that pictures do not know; no mass have springs, dashpots,
// gaps and sections of a material without *DENSITY, no stiffness masses and
// dashpots), sections with stiffness or mass in keywords of their own
// (*TRANSVERSE SHEAR STIFFNESS, *BEAM ADDED INERTIA, *REBAR LAYER), materials
// that something else than a section uses, *ELASTIC of other kinds than
// isotropic, engineering constants, orthotropic, lamina and anisotropic, *MASS
// that is not isotropic, and keywords with INPUT.
[[nodiscard]] bool ScaleDeck(const std::string& path,
                             const std::string& content,
                             const std::vector<DeckFactor>& factors,
                             std::string* scaled, std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_DECK_PROPERTIES_H_
