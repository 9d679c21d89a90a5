// Cells of the header of a text in an unknown encoding.

#ifndef PINODE_BASE_HEADER_CELLS_H_
#define PINODE_BASE_HEADER_CELLS_H_

#include <string>
#include <string_view>
#include <vector>

namespace pinode {

// Returns the cells with bytes beyond ASCII, in lines as in the text: at most
// 8 KiB out of the first 256 KiB.
std::string CellsBeyondAscii(const std::string& text);

// Units beyond ASCII in cells of UTF-8, each as CanonicalUnit() returns it: in
// brackets, behind ", " or in a row of nothing but units. "" stands for a piece
// in the place of a unit that is none.
std::vector<std::string> UnitsOfCells(std::string_view text);

}  // namespace pinode

#endif  // PINODE_BASE_HEADER_CELLS_H_
