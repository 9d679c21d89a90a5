// Runs of lines with the same cells: the rows of a text file.

#ifndef PINODE_RECORD_FILES_TEXT_ROWS_H_
#define PINODE_RECORD_FILES_TEXT_ROWS_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pinode/record/files/text_layout.h"

namespace pinode {

// Rows in a line that make a table, if a file has so many.
constexpr size_t kEnoughRows = 20;

// Line of a text, without its end.
struct TextLine {
  std::string_view text;
  size_t offset = 0;
  int64_t number = 0;
};

// Ends lines by '\n' that end with a carriage return alone, and removes the
// mark of DOS behind the last one.
void NormaliseLines(std::string* text);

// Splits the beginning of a text into at most `most` lines.
std::vector<TextLine> FirstLines(std::string_view text, size_t most);

// A run of rows, under one delimiter and decimal sign.
struct RowRun {
  char delimiter = 0;
  char decimal = '.';
  size_t first = 0;  // line
  size_t rows = 0;
  std::vector<CellKind> kinds;
  // Cells that were quoted and have decimal commas among delimiting ones.
  bool quotes_commas = false;

  size_t Values() const {
    size_t values = 0;
    for (const CellKind kind : kinds) {
      if (kind != CellKind::kText && kind != CellKind::kMissing) ++values;
    }
    return values;
  }
  size_t Score() const { return rows * Values(); }
  bool HasText() const {
    return std::find(kinds.begin(), kinds.end(), CellKind::kText) !=
           kinds.end();
  }
};

// Finds the rows under each delimiter and decimal sign that the format allows:
// the first run of enough rows without text, or else the run with the most
// numbers. Rows of missing values belong to a run of others.
std::vector<RowRun> FindRowRuns(const std::vector<TextLine>& lines,
                                const TextFormat& format);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_TEXT_ROWS_H_
