// Nodes, elements and element sets of input decks of CalculiX and Abaqus.

#ifndef PINODE_STRUCTURE_DECKS_DECK_GEOMETRY_H_
#define PINODE_STRUCTURE_DECKS_DECK_GEOMETRY_H_

#include <string>

#include "pinode/structure/model/geometry.h"

namespace pinode {

// *NODE, *ELEMENT (TYPE, ELSET) and *ELSET (GENERATE, INSTANCE), with *INCLUDE;
// of Abaqus *PART and *INSTANCE, moved and turned as its lines say; all other
// keywords are passed over. Of elements of higher order the corners are taken.
// Elements of types that are not known (springs and masses are) are left out,
// with a note. Sets have the elements of sets that they hold by name, in any
// order. Comments and headings may be in any encoding. *NODE with SYSTEM=C or
// S, *SYSTEM, *NGEN, *NFILL, *ELGEN, and data of nodes, elements and sets in
// files of INPUT are refused.
//
// Nodes are called by their numbers; with several instances those of an
// instance "instance.number". Of a node of the assembly that has the number of
// one in the only instance the name is "ASSEMBLY.number". A part's set is that
// of all its instances by its own name, and that of one as "instance.set".
// Where several parts, or a part and the assembly, have different sets of a
// name, only the long names (of the assembly's "ASSEMBLY.set") are there.
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

#endif  // PINODE_STRUCTURE_DECKS_DECK_GEOMETRY_H_
