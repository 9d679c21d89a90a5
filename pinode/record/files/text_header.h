// The names and units above the rows of a text file.

#ifndef PINODE_RECORD_FILES_TEXT_HEADER_H_
#define PINODE_RECORD_FILES_TEXT_HEADER_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "pinode/record/files/text_rows.h"

namespace pinode {

// Names above the rows of a run. Lines are places in the vector of lines.
struct TextHeader {
  bool found = false;
  size_t names = 0;  // line
  // First row: that of the run, or of broken rows above it.
  size_t first_row = 0;
  size_t units = 0;
  bool has_units = false;
  bool in_comment = false;
  std::vector<std::string> cells;
  std::vector<std::string> unit_cells;
  // Line above the rows that has text and is no header.
  bool is_odd = false;
  size_t odd = 0;
  size_t odd_cells = 0;
};

// Finds the names and units of a run's columns: in the line above the rows, or
// above a row of units, or in the last comment.
TextHeader FindTextHeader(const std::vector<TextLine>& lines,
                          const TextFormat& format, const RowRun& run);

// Returns the unit that a cell of a row of units states, or "".
std::string UnitOfCell(std::string_view cell);

// True for a line of hyphens and the like.
bool IsSeparatorLine(std::string_view line);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_TEXT_HEADER_H_
