// Properties of the element sets of CalculiX and Abaqus input decks, and a copy
// of the deck with these properties scaled.

#ifndef PINODE_STRUCTURE_DECKS_DECK_PROPERTIES_H_
#define PINODE_STRUCTURE_DECKS_DECK_PROPERTIES_H_

#include <string>
#include <vector>

namespace pinode {

// A section with its material, springs or point masses. It holds the numbers to
// which stiffness and mass are proportional, in the deck's order.
struct DeckProperty {
  std::string set;  // elements that have it
  // Moduli of *ELASTIC (no Poisson's ratios), constants or forces of *SPRING.
  std::vector<double> stiffness;
  // *DENSITY, *MASS, *ROTARY INERTIA, *NONSTRUCTURAL MASS.
  std::vector<double> mass;
};

// Factor on the stiffness or the mass of an element set.
struct DeckFactor {
  std::string set;
  bool is_mass = false;  // else stiffness
  double factor = 1.0;
};

// Reads the properties of *SOLID, *SHELL, *MEMBRANE, *BEAM and *TRUSS SECTION
// with MATERIAL, *SPRING, *MASS, *ROTARY INERTIA and *NONSTRUCTURAL MASS, in
// the deck's order. Returns false with `file:line: error, expected ...` in
// *error.
[[nodiscard]] bool ReadDeckProperties(const std::string& path,
                                      const std::string& content,
                                      std::vector<DeckProperty>* properties,
                                      std::string* error);

// Writes to *scaled the deck with the properties of each set multiplied by its
// factors. Included files replace their *INCLUDE. Everything else stays
// unchanged. A material shared with other sections, including composites and
// general ones, gets a copy. Sets are called as in deck_geometry.h. The section
// of a part applies to all its instances.
//
// Refused are:
//
// - names that several sets have;
// - sets of which a section, spring or mass has elements outside;
// - sets that two factors of one kind would change;
// - elements without a property that can be changed: general sections,
//   composites, and types that pictures do not know. Springs, dashpots, gaps
//   and sections of a material without *DENSITY have no mass. Masses and
//   dashpots have no stiffness;
// - sections with stiffness or mass in keywords of their own (*TRANSVERSE SHEAR
//   STIFFNESS, *BEAM ADDED INERTIA, *REBAR LAYER);
// - materials used by anything other than a section;
// - *ELASTIC of other kinds than isotropic, engineering constants, orthotropic,
//   lamina and anisotropic;
// - *MASS that is not isotropic;
// - keywords with INPUT.
[[nodiscard]] bool ScaleDeck(const std::string& path,
                             const std::string& content,
                             const std::vector<DeckFactor>& factors,
                             std::string* scaled, std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_DECK_PROPERTIES_H_
