// A deck as its keywords with what stands below each: for what rewrites decks.

#ifndef PINODE_STRUCTURE_DECKS_DECK_BLOCKS_H_
#define PINODE_STRUCTURE_DECKS_DECK_BLOCKS_H_

#include <string>
#include <vector>

#include "pinode/structure/decks/deck_keyword.h"

namespace pinode {

struct DeckBlock {
  DeckKeyword keyword;             // without a name: what is above the first
  std::vector<std::string> head;   // its lines
  std::vector<std::string> lines;  // below it: data, comments and blank ones
  std::string place;               // "file:line" of the keyword

  // Positions among `lines` of those that hold data.
  std::vector<size_t> DataLines() const;
};

// Lines as they are; files of *INCLUDE in its place.
[[nodiscard]] bool ReadDeckBlocks(const std::string& path,
                                  const std::string& content,
                                  std::vector<DeckBlock>* blocks,
                                  std::string* error);

// "\r" where a line, without its "\n", ends so, as on Windows; else empty: for
// what takes the line's place.
std::string DeckLineEnd(const std::string& line);

std::string FormatDeckBlocks(const std::vector<DeckBlock>& blocks);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_DECK_BLOCKS_H_
