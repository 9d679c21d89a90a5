// Nodes and elements of Nastran's bulk data.

#ifndef PINODE_STRUCTURE_DECKS_BULK_GEOMETRY_H_
#define PINODE_STRUCTURE_DECKS_BULK_GEOMETRY_H_

#include <string>

#include "pinode/structure/model/geometry.h"

namespace pinode {

// GRID cards and elements (CBAR, CBEAM, CROD, CONROD, CTRIA3, CTRIA6, CQUAD4,
// CQUAD8, CQUADR, CTRIAR, CSHEAR, CTETRA, CPYRAM, CPENTA, CHEXA, CELAS2 between
// two nodes, CONM2), in fields of 8 or 16 columns or with commas, up to
// ENDDATA; other cards are passed over, cards C... with a count in a note.
// Nodes are called by their numbers; elements of a property are the set of its
// number, "PID 12". Of elements of higher order the corners are taken. Grids in
// another system than the basic one, of their own or by GRDSET, are refused, as
// are INCLUDE and files without GRID.
//
// False, with `file:line: what, and what was expected`.
[[nodiscard]] bool ReadBulkGeometry(const std::string& path,
                                    StructureGeometry* geometry,
                                    std::string* error);
[[nodiscard]] bool ParseBulkGeometry(const std::string& path,
                                     const std::string& content,
                                     StructureGeometry* geometry,
                                     std::string* error);

// By its extension: .bdf, .nas, .dat.
bool IsBulkFile(const std::string& path);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_BULK_GEOMETRY_H_
