// Nodes, elements and element sets of CalculiX and Abaqus input decks, part by
// part, before the parts are placed in the assembly.

#ifndef PINODE_STRUCTURE_DECKS_DECK_PARTS_H_
#define PINODE_STRUCTURE_DECKS_DECK_PARTS_H_

#include <array>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "pinode/structure/decks/deck_elements.h"
#include "pinode/structure/decks/deck_keyword.h"

namespace pinode {

// Largest number of nodes or elements in a deck. Each instance counts.
constexpr size_t kMostDeckItems = 2000000;

// Position of a keyword in a deck: in the k-th *PART or *INSTANCE, or outside
// both. Outside both is the assembly or a deck without parts.
struct DeckPlace {
  enum class Kind { kAssembly, kPart, kInstance };
  Kind kind = Kind::kAssembly;
  int index = 0;
  int num_parts = 0, num_instances = 0;  // up to here

  // Moves past this keyword.
  void Pass(const DeckKeyword& keyword);
};

// A number as in the file, with its instance. The instance is -1 if the number
// belongs to the scope where it is used.
struct DeckReference {
  int number = 0;
  int instance = -1;
};

struct DeckElement {
  const DeckElementType* type = nullptr;
  std::vector<DeckReference> nodes;  // corners, in VTK's order
};

struct DeckSet {
  // Every `step`-th number from first to last, as far as it exists.
  struct Range {
    int first = 0, last = 0, step = 1;
    int instance = -1;
  };
  // An entry that is not a number: a set, "instance.set" or "instance.number".
  struct Name {
    std::string text;
    int instance = -1;
    std::string place;  // "file:line"
  };

  std::string name;
  std::vector<int> own;  // positions among the elements of its scope
  std::vector<Range> ranges;
  std::vector<Name> names;
};

// A part, an instance's own items, or everything outside both.
struct DeckScope {
  std::string name;
  std::vector<int> node_numbers, element_numbers;
  std::vector<std::array<double, 3>> positions;
  std::vector<DeckElement> elements;
  std::vector<DeckSet> sets;
  // Positions by number, and by the name as decks compare it.
  std::unordered_map<int, int> node_index, element_index;
  std::unordered_map<std::string, size_t> set_index;

  // Returns the set of that name. Creates it if there is none.
  DeckSet* SetOf(const std::string& set);
};

struct DeckInstance {
  int part = 0;
  DeckScope own;
  // Placement of an instance: first a translation by `shift`, then a rotation
  // in degrees about the axis from one point to the other.
  std::array<double, 3> shift = {0.0, 0.0, 0.0};
  std::array<double, 7> turn = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
};

struct DeckParts {
  std::vector<DeckScope> parts;
  std::vector<DeckInstance> instances;
  DeckScope assembly;
  // Unknown element types, each with the number of its elements.
  std::vector<std::pair<std::string, int>> unknown_types;
  // Included files that lie outside of the deck's folder.
  std::vector<std::string> outside;
  // Positions by the name as decks compare it.
  std::unordered_map<std::string, int> part_index, instance_index;

  // Returns the position of a part by name; -1: none.
  int FindPart(const std::string& name) const;
  int FindInstance(const std::string& name) const;
};

// Reads the parts. Returns false with `file:line: error, expected ...` in
// *error.
[[nodiscard]] bool ReadDeckParts(const std::string& path,
                                 const std::string& content, DeckParts* parts,
                                 std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_DECK_PARTS_H_
