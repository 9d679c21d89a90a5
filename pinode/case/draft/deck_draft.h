// The model of a case from a deck and the matrices that were exported from it.

#ifndef PINODE_CASE_DRAFT_DECK_DRAFT_H_
#define PINODE_CASE_DRAFT_DECK_DRAFT_H_

#include <string>
#include <unordered_map>
#include <vector>

namespace pinode {

// An unknown: the stiffness or the mass of an element set.
struct DeckGroup {
  std::string name;
  std::string set;
  bool is_mass = false;
  std::string file;  // matrix with the set's property changed
};

struct DeckModel {
  std::string deck;
  std::string mass;
  std::string stiffness;
  std::vector<DeckGroup> groups;
  // Nodes of the deck, by name.
  std::unordered_map<std::string, int> nodes;
  // Exports that belong to no element set.
  std::vector<std::string> left_out;

  // True for a translation "node.direction" of one of the nodes.
  bool HasTranslation(const std::string& dof) const;
};

// Finds the exports of CalculiX that belong to the deck frame.inp: frame.sti
// and frame.mas beside it, or model.sti and model.mas in frame_export, where
// pinode.calculix.export puts them; both also compressed (.gz). Exports with
// one set changed lie beside them and are called like the set: columns_1.sti,
// beams_1.mas or mass_beams_1.mas.
[[nodiscard]] bool FindDeckModel(const std::string& deck, DeckModel* model,
                                 std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_DRAFT_DECK_DRAFT_H_
