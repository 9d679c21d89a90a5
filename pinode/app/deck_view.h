// The structure of a deck for the page: nodes to put sensors on.

#ifndef PINODE_APP_DECK_VIEW_H_
#define PINODE_APP_DECK_VIEW_H_

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "pinode/structure/model/geometry.h"

namespace pinode {

// Largest number of nodes that the page draws. Beyond it nodes are typed.
inline constexpr int kMostDrawnNodes = 50000;

// {"names": [...], "positions": [x, y, z, ...], "edges": [a, b, ...]}: nodes,
// and each edge of an element once, as two indices of nodes. Positions are
// relative to the middle of the structure; half its largest extent is 1.
nlohmann::ordered_json DeckView(const StructureGeometry& geometry);

// Reads the deck at `path` for DeckView. False, with *error, if it cannot be
// read or has too many nodes.
[[nodiscard]] bool ReadDeckView(const std::string& path,
                                nlohmann::ordered_json* json,
                                std::string* error);

}  // namespace pinode

#endif  // PINODE_APP_DECK_VIEW_H_
