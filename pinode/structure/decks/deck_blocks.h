// A deck as a list of blocks: each keyword with its lines. Used to rewrite
// decks.

#ifndef PINODE_STRUCTURE_DECKS_DECK_BLOCKS_H_
#define PINODE_STRUCTURE_DECKS_DECK_BLOCKS_H_

#include <string>
#include <vector>

#include "pinode/structure/decks/deck_keyword.h"

namespace pinode {

struct DeckBlock {
  DeckKeyword keyword;             // without a name: lines above the first
  std::vector<std::string> head;   // its lines
  std::vector<std::string> lines;  // below it: data, comments and blank ones
  std::string place;               // "file:line" of the keyword

  // Returns the positions among `lines` of those that hold data.
  std::vector<size_t> DataLines() const;
};

// Reads a deck into blocks. Lines stay unchanged. The content of an included
// file replaces its *INCLUDE.
[[nodiscard]] bool ReadDeckBlocks(const std::string& path,
                                  const std::string& content,
                                  std::vector<DeckBlock>* blocks,
                                  std::string* error);

// Returns "\r" if a line, without its "\n", ends so as on Windows, else an
// empty text. Append it to a replacement of the line.
std::string DeckLineEnd(const std::string& line);

std::string FormatDeckBlocks(const std::vector<DeckBlock>& blocks);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_DECK_BLOCKS_H_
