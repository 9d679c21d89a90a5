// Nodes, elements and element sets of input decks of CalculiX and Abaqus.

#ifndef PINODE_STRUCTURE_DECKS_DECK_GEOMETRY_H_
#define PINODE_STRUCTURE_DECKS_DECK_GEOMETRY_H_

#include <string>

#include "pinode/structure/model/geometry.h"

namespace pinode {

// Reads *NODE, *ELEMENT (TYPE, ELSET) and *ELSET (GENERATE, INSTANCE), with
// *INCLUDE. Abaqus' *PART and *INSTANCE are read too, moved and rotated as
// their lines say. All other keywords are skipped.
//
// - Only the corners of higher-order elements are used.
// - Elements of unknown types are left out, with a note. Springs and masses are
//   known types.
// - A set that names other sets, in any order, contains their elements.
// - Comments and headings may be in any encoding.
// - Refused are *NODE with SYSTEM=C or S, *SYSTEM, *NGEN, *NFILL, *ELGEN, and
//   data of nodes, elements and sets in files of INPUT.
//
// Names of nodes: their numbers. With several instances, a node of an instance
// is called "instance.number". If a node of the assembly has the number of a
// node in the only instance, its name is "ASSEMBLY.number".
//
// Names of sets: a part's set contains the elements of all its instances under
// its own name, and those of one instance under "instance.set". If several
// parts, or a part and the assembly, have different sets of one name, only the
// long names exist ("ASSEMBLY.set" for the assembly's).
//
// Returns false with `file:line: error, expected ...` in *error.
[[nodiscard]] bool ReadDeckGeometry(const std::string& path,
                                    StructureGeometry* geometry,
                                    std::string* error);

// Does the same with the content of the file `path`. Included files are
// relative to it.
[[nodiscard]] bool ParseDeckGeometry(const std::string& path,
                                     const std::string& content,
                                     StructureGeometry* geometry,
                                     std::string* error);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_DECK_GEOMETRY_H_
