// Places the parts of an input deck in its assembly.

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
  // Not copyable: its pieces point into it.
  DeckAssembly(const DeckAssembly&) = delete;
  DeckAssembly& operator=(const DeckAssembly&) = delete;

  // Does what ReadDeckGeometry does. deck_geometry.h describes the names.
  [[nodiscard]] bool Read(const std::string& path, const std::string& content,
                          std::string* error);

  const StructureGeometry& geometry() const { return geometry_; }
  StructureGeometry* mutable_geometry() { return &geometry_; }

  // Returns the type of an element of the geometry.
  const DeckElementType& type(int element) const {
    return *types_[static_cast<size_t>(element)];
  }

  // Finds the elements, ascending, of the set that a keyword at that place
  // calls `name`. In a part these are the elements of all its instances.
  // Returns false if there is no such set or if the assembly contains none of
  // it.
  [[nodiscard]] bool FindSet(const DeckPlace& place, const std::string& name,
                             std::vector<int>* elements) const;

  // Returns the position of a set of the geometry by its name, compared as
  // decks do; -1 if there is none.
  int SetIndex(const std::string& name) const;

  // Returns the reason why the geometry does not have this set.
  std::string WhyNoSet(const std::string& name) const;

 private:
  // An instance of a part, or everything outside instances.
  struct Copy {
    std::string name;  // empty: everything outside instances
    int part = -1;
    int instance = -1;
    // A part, an instance's own items, or everything outside both. Includes the
    // positions in the geometry where its nodes and elements begin.
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
  // Returns the sets of all copies, each once, with the name as in the deck.
  std::vector<std::pair<SetKey, std::string>> SetNames() const;

  // Positions in the geometry by number; -1: none.
  using NumberIndex = std::unordered_map<int, int> DeckScope::*;
  static int Find(const Copy& copy, int number, NumberIndex index,
                  int Copy::Piece::*first);
  static int FindNode(const Copy& copy, int number);
  static int FindElement(const Copy& copy, int number);
  // Returns the copy of an instance. For -1 it returns `from`, the copy that
  // contains the reference.
  static size_t CopyOf(size_t from, int instance);
  bool IsSet(size_t copy, const std::string& key) const;
  // Collects the elements of a set, including the sets that it names.
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
  // Ambiguous names, each with the long names of the sets that have it.
  std::map<std::string, std::vector<std::string>> ambiguous_;
};

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_DECK_ASSEMBLY_H_
