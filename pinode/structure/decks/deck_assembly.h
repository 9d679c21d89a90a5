// Parts of an input deck put where the assembly has them.

#ifndef PINODE_STRUCTURE_DECKS_DECK_ASSEMBLY_H_
#define PINODE_STRUCTURE_DECKS_DECK_ASSEMBLY_H_

#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "pinode/structure/decks/deck_parts.h"
#include "pinode/structure/model/geometry.h"

namespace pinode {

class DeckAssembly {
 public:
  DeckAssembly() = default;
  // Its pieces point into it.
  DeckAssembly(const DeckAssembly&) = delete;
  DeckAssembly& operator=(const DeckAssembly&) = delete;

  // As ReadDeckGeometry in deck_geometry.h, which says how things are called.
  [[nodiscard]] bool Read(const std::string& path, const std::string& content,
                          std::string* error);

  const StructureGeometry& geometry() const { return geometry_; }
  StructureGeometry* mutable_geometry() { return &geometry_; }

  // Of an element of the geometry.
  const DeckElementType& type(int element) const {
    return *types_[static_cast<size_t>(element)];
  }

  // The elements, ascending, of the set that a keyword at that place means by
  // `name`: in a part those of all its instances. False: there is no such set,
  // or nothing of it is in the assembly.
  [[nodiscard]] bool FindSet(const DeckPlace& place, const std::string& name,
                             std::vector<int>* elements) const;

  // Position among those of the geometry by name, as decks compare it; -1:
  // none.
  int SetIndex(const std::string& name) const;

  // What is wrong with a set that the geometry does not have.
  std::string WhyNoSet(const std::string& name) const;

 private:
  // An instance of a part, or what stands in none.
  struct Copy {
    std::string name;  // empty: what stands in none
    int part = -1;
    int instance = -1;
    // A part, what an instance has of its own, or what stands in neither, and
    // where their nodes and elements begin in the geometry.
    struct Piece {
      const DeckScope* scope = nullptr;
      int first_node = 0, first_element = 0;
    };
    std::vector<Piece> pieces;
  };
  using SetKey = std::pair<size_t, std::string>;  // copy, name

  bool MakeCopies(const std::string& path, std::string* error);
  bool AddNodes(const std::string& path, std::string* error);
  bool AddElements(const std::string& path, std::string* error);
  bool AddSets(std::string* error);
  void NameSets();
  // Of all copies, each once, with the name as the deck has it.
  std::vector<std::pair<SetKey, std::string>> SetNames() const;

  // Positions in the geometry; -1: none.
  using NumberIndex = std::unordered_map<int, int> DeckScope::*;
  static int Find(const Copy& copy, int number, NumberIndex index,
                  int Copy::Piece::*first);
  static int FindNode(const Copy& copy, int number);
  static int FindElement(const Copy& copy, int number);
  // Of an instance, or the one where that stands itself (-1).
  static size_t CopyOf(size_t from, int instance);
  bool IsSet(size_t copy, const std::string& key) const;
  // A set with all that it names.
  bool Collect(const SetKey& wanted, std::vector<int>* elements,
               std::string* error) const;
  bool AddNamed(size_t copy, const DeckSet& set, const DeckSet::Name& name,
                std::vector<SetKey>* further, std::vector<int>* elements,
                std::string* error) const;
  void AddRange(const Copy& copy, const DeckSet::Range& range,
                std::vector<int>* elements) const;
  bool AddRanges(size_t copy, const DeckSet& set, std::vector<int>* elements,
                 std::string* error) const;

  std::string path_;
  DeckParts parts_;
  // Instances in their order, then the assembly.
  std::vector<Copy> copies_;
  StructureGeometry geometry_;
  std::vector<const DeckElementType*> types_;
  std::map<SetKey, std::vector<int>> sets_;
  // Names of several sets: what each of them is called.
  std::map<std::string, std::vector<std::string>> ambiguous_;
};

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_DECK_ASSEMBLY_H_
