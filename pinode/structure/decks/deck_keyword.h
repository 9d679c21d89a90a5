// Keywords of input decks of CalculiX and Abaqus.

#ifndef PINODE_STRUCTURE_DECKS_DECK_KEYWORD_H_
#define PINODE_STRUCTURE_DECKS_DECK_KEYWORD_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {

// A keyword line such as "*ELEMENT, TYPE=B31, ELSET=columns".
struct DeckKeyword {
  std::string name;  // in upper case: "*ELEMENT"
  // Parameters in their order. Keys are in upper case. Values are unchanged, or
  // "" if there is none.
  std::vector<std::pair<std::string, std::string>> parameters;

  // Returns true if the keyword is `other`, such as "*SOLID SECTION". Blanks
  // are ignored, as in the solvers.
  bool Is(std::string_view other) const;
  // Returns the value of a key, or nullptr if there is no such key.
  const std::string* Find(const std::string& key) const;
};

DeckKeyword ParseDeckKeyword(const std::string& line);

std::string DeckUpperCase(std::string_view text);

// Returns a name in the form used for comparison: upper case, without blanks
// and quotes. Names that Abaqus distinguishes only by these are taken as one.
std::string DeckKey(std::string_view name);

std::string WithoutDeckQuotes(const std::string& name);

// Reads the file that an *INCLUDE in the file `path` names, and its text. Paths
// are relative to the file that names them, or else to the deck `main`. `depth`
// is the number of files around it, at most ten. Returns false with an error at
// the reader's line, or with the file's own error.
[[nodiscard]] bool ReadDeckInclude(const LineReader& lines,
                                   const DeckKeyword& keyword,
                                   const std::string& path,
                                   const std::string& main, int depth,
                                   std::string* file, std::string* content,
                                   std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_DECK_KEYWORD_H_
