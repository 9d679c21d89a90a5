// Keywords of input decks of CalculiX and Abaqus.

#ifndef PINODE_STRUCTURE_DECK_KEYWORD_H_
#define PINODE_STRUCTURE_DECK_KEYWORD_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pinode {

// "*ELEMENT, TYPE=B31, ELSET=columns".
struct DeckKeyword {
  std::string name;  // in upper case: "*ELEMENT"
  // In their order; keys in upper case, values as they are, "" without one.
  std::vector<std::pair<std::string, std::string>> parameters;

  // nullptr: there is none of that key.
  const std::string* Find(const std::string& key) const;
};

DeckKeyword ParseDeckKeyword(const std::string& line);

// A name as decks compare it.
std::string DeckUpperCase(std::string_view text);

// The file that *INCLUDE names, beside the deck that has it.
std::string DeckIncludePath(const std::string& deck, const std::string& input);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECK_KEYWORD_H_
