// Keywords of input decks of CalculiX and Abaqus.

#ifndef PINODE_STRUCTURE_DECKS_DECK_KEYWORD_H_
#define PINODE_STRUCTURE_DECKS_DECK_KEYWORD_H_

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pinode/base/unpacked_size.h"
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

// The files that one deck includes.
class DeckIncludes {
 public:
  // `main`: the deck. It must outlive this object.
  explicit DeckIncludes(const std::string& main) : main_(main) {}

  // Reads the file that an *INCLUDE in the file `path` names, and its text.
  // Paths are relative to the file that names them, or else to the deck.
  // `depth` is the number of files around it, at most ten. All files together
  // are at most 1000 and as large as unpacked_size.h grants: ten files that
  // include each other ten times ten levels deep never end. Returns false with
  // an error at the reader's line, or with the file's own error.
  [[nodiscard]] bool Read(const LineReader& lines, const DeckKeyword& keyword,
                          const std::string& path, int depth, std::string* file,
                          std::string* content, std::string* error);

  // Included files that lie neither in the deck's folder nor below it.
  const std::vector<std::string>& outside() const { return outside_; }

 private:
  const std::string& main_;
  int count_ = 0;
  UnpackedSize size_{0.0};
  std::vector<std::string> outside_;
};

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_DECK_KEYWORD_H_
