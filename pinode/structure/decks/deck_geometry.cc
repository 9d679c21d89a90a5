#include "pinode/structure/decks/deck_geometry.h"

#include <utility>

#include "pinode/base/file.h"
#include "pinode/structure/decks/deck_assembly.h"

namespace pinode {

bool ParseDeckGeometry(const std::string& path, const std::string& content,
                       StructureGeometry* geometry, std::string* error) {
  DeckAssembly deck;
  if (!deck.Read(path, content, error)) return false;
  *geometry = std::move(*deck.mutable_geometry());
  return true;
}

bool ReadDeckGeometry(const std::string& path, StructureGeometry* geometry,
                      std::string* error) {
  std::string content;
  return ReadTextOfAnyEncoding(path, &content, error) &&
         ParseDeckGeometry(path, content, geometry, error);
}

}  // namespace pinode
