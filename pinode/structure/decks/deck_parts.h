// What input decks of CalculiX and Abaqus say of nodes, elements and element
// sets, part by part and before anything is put in its place.

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

// Nodes or elements that a deck may have; instances count each.
constexpr size_t kMostDeckItems = 2000000;

// Where in a deck a keyword stands: in the k-th *PART or *INSTANCE, or in
// neither, which is the assembly or a deck without parts.
struct DeckPlace {
  enum class Kind { kAssembly, kPart, kInstance };
  Kind kind = Kind::kAssembly;
  int index = 0;
  int num_parts = 0, num_instances = 0;  // until here

  // Past this keyword.
  void Pass(const DeckKeyword& keyword);
};

// A number as a file gives it; of another instance than where it stands: -1.
struct DeckReference {
  int number = 0;
  int instance = -1;
};

struct DeckElement {
  const DeckElementType* type = nullptr;
  std::vector<DeckReference> nodes;  // corners, in VTK's order
};

struct DeckSet {
  // Every `step`-th number from first to last, as far as it is there.
  struct Range {
    int first = 0, last = 0, step = 1;
    int instance = -1;
  };
  // What is no number: a set, or "instance.set" or "instance.number".
  struct Name {
    std::string text;
    int instance = -1;
    std::string place;  // "file:line"
  };

  std::string name;
  std::vector<int> own;  // positions among the elements of where it stands
  std::vector<Range> ranges;
  std::vector<Name> names;
};

// A part, what an instance has of its own, or what stands in neither.
struct DeckScope {
  std::string name;
  std::vector<int> node_numbers, element_numbers;
  std::vector<std::array<double, 3>> positions;
  std::vector<DeckElement> elements;
  std::vector<DeckSet> sets;
  // Positions by number, and by the name as decks compare it.
  std::unordered_map<int, int> node_index, element_index;
  std::unordered_map<std::string, size_t> set_index;

  // The set of that name, which is made where there is none.
  DeckSet* SetOf(const std::string& set);
};

struct DeckInstance {
  int part = 0;
  DeckScope own;
  // First along `shift`, then around the axis from one point to the other, by
  // degrees.
  std::array<double, 3> shift = {0.0, 0.0, 0.0};
  std::array<double, 7> turn = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
};

struct DeckParts {
  std::vector<DeckScope> parts;
  std::vector<DeckInstance> instances;
  DeckScope assembly;
  // Types that are not known, and how many elements there are of each.
  std::vector<std::pair<std::string, int>> unknown_types;
  // Positions by the name as decks compare it.
  std::unordered_map<std::string, int> part_index, instance_index;

  // Position by name; -1: none.
  int FindPart(const std::string& name) const;
  int FindInstance(const std::string& name) const;
};

// False, with `file:line: what, and what was expected`.
[[nodiscard]] bool ReadDeckParts(const std::string& path,
                                 const std::string& content, DeckParts* parts,
                                 std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_DECK_PARTS_H_
