// Reads nodes and elements of Nastran's bulk data.

#ifndef PINODE_STRUCTURE_DECKS_BULK_GEOMETRY_H_
#define PINODE_STRUCTURE_DECKS_BULK_GEOMETRY_H_

#include <string>

#include "pinode/structure/model/geometry.h"

namespace pinode {

// Reads GRID cards and elements (CBAR, CBEAM, CROD, CONROD, CTRIA3, CTRIA6,
// CQUAD4, CQUAD8, CQUADR, CTRIAR, CSHEAR, CTETRA, CPYRAM, CPENTA, CHEXA, CELAS2
// between two nodes, CONM2), up to ENDDATA. Fields have 8 or 16 columns, or are
// separated by commas.
//
// - Other cards are skipped. A note counts the skipped cards C... .
// - Nodes are called by their numbers. The elements of a property form a set
//   with its number as name, "PID 12".
// - Only the corners of higher-order elements are used.
// - Refused are grids in another than the basic coordinate system (their own or
//   by GRDSET), INCLUDE, and files without GRID.
//
// Returns false with `file:line: error, expected ...` in *error.
[[nodiscard]] bool ReadBulkGeometry(const std::string& path,
                                    StructureGeometry* geometry,
                                    std::string* error);
[[nodiscard]] bool ParseBulkGeometry(const std::string& path,
                                     const std::string& content,
                                     StructureGeometry* geometry,
                                     std::string* error);

// Returns true if the extension is .bdf, .nas or .dat.
bool IsBulkFile(const std::string& path);

}  // namespace pinode

#endif  // PINODE_STRUCTURE_DECKS_BULK_GEOMETRY_H_
