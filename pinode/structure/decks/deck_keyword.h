// Keywords of input decks of CalculiX and Abaqus.

#ifndef PINODE_STRUCTURE_DECKS_DECK_KEYWORD_H_
#define PINODE_STRUCTURE_DECKS_DECK_KEYWORD_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {

// "*ELEMENT, TYPE=B31, ELSET=columns".
struct DeckKeyword {
  std::string name;  // in upper case: "*ELEMENT"
  // In their order; keys in upper case, values as they are, "" without one.
  std::vector<std::pair<std::string, std::string>> parameters;

  // Whether it is `other`, "*SOLID SECTION": solvers read past blanks.
  bool Is(std::string_view other) const;
  // nullptr: there is none of that key.
  const std::string* Find(const std::string& key) const;
};

DeckKeyword ParseDeckKeyword(const std::string& line);

std::string DeckUpperCase(std::string_view text);

// A name as it is compared: in upper case, without blanks and quotes. Names
// that Abaqus tells apart by these are taken as one.
std::string DeckKey(std::string_view name);

std::string WithoutDeckQuotes(const std::string& name);

// What an *INCLUDE in the file `path` stands for: the file and its text. Paths
// are relative to the file that names them or else to the deck `main`. `depth`:
// how many files are around it; at most ten. False with an error at the
// reader's line, or the file's own.
[[nodiscard]] bool ReadDeckInclude(const LineReader& lines,
                                   const DeckKeyword& keyword,
                                   const std::string& path,
                                   const std::string& main, int depth,
                                   std::string* file, std::string* content,
                                   std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_DECK_KEYWORD_H_
