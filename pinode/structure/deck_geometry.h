// Nodes, elements and element sets of input decks of CalculiX and Abaqus.

#ifndef PINODE_STRUCTURE_DECK_GEOMETRY_H_
#define PINODE_STRUCTURE_DECK_GEOMETRY_H_

#include <string>

#include "pinode/structure/geometry.h"

namespace pinode {

// *NODE, *ELEMENT (TYPE, ELSET) and *ELSET (GENERATE), with *INCLUDE, in the
// order of the deck; all other keywords are passed over. Nodes are called by
// their numbers. Of elements of higher order the corners are taken. Elements of
// types that are not known (springs and masses are) are left out, with a note;
// so are nodes that no coordinates are given for. Positions are those of the
// deck: *NODE with SYSTEM=C or S, *SYSTEM, *NGEN, *NFILL, *ELGEN, data of
// nodes, elements and sets in files of INPUT, and parts that an assembly moves
// are refused. An element set that holds another set by name has its elements.
//
// False, with `file:line: what, and what was expected`.
[[nodiscard]] bool ReadDeckGeometry(const std::string& path,
                                    StructureGeometry* geometry,
                                    std::string* error);

// The same from the content of the file `path`, which includes are beside.
[[nodiscard]] bool ParseDeckGeometry(const std::string& path,
                                     const std::string& content,
                                     StructureGeometry* geometry,
                                     std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECK_GEOMETRY_H_
