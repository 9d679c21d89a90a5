// Finds where the columns of a text file are: delimiter, decimal sign, names,
// units and first row.

#ifndef PINODE_RECORD_FILES_TEXT_LAYOUT_H_
#define PINODE_RECORD_FILES_TEXT_LAYOUT_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pinode/record/files/clock.h"
#include "pinode/record/files/text_format.h"

namespace pinode {

// Kind of a cell, and of a column by its first rows.
enum class CellKind { kMissing, kNumber, kDate, kTimeOfDay, kDateTime, kText };

// Column of a text file.
struct TextColumn {
  // Name as in the header; `column_3` without one. A name that occurs several
  // times has its number behind it: `a[1]`, `a[2]`.
  std::string name;
  // Name without the unit behind it; the same as `name` if there is none.
  std::string short_name;
  // Unit of the column, by the name or a row of units, as UnitFactor knows it.
  // Empty: none is stated, or none that is known.
  std::string unit;
  CellKind kind = CellKind::kMissing;
};

struct TextLayout {
  char delimiter = ',';  // ' ': blanks; 0: a single column
  char decimal = '.';
  // True if the first rows have no decimal sign: both are possible.
  bool is_decimal_open = false;
  // Place of the first row in the text, and its line (from 1).
  size_t first_row = 0;
  int64_t first_row_line = 1;
  // Lines of the names and units; 0: none.
  int64_t names_line = 0;
  int64_t units_line = 0;
  std::vector<TextColumn> columns;
  // Names of columns whose unit in the name is not that of the row of units.
  // Both may be wrong, so these columns have none.
  std::vector<std::string> doubtful_units;
  // Number whose point may be between thousands, and its line; empty: none.
  std::string doubtful_number;
  int64_t doubtful_line = 0;
  // Cells of a row. Those beyond the columns are empty.
  size_t num_cells = 0;
  // True if the file is what ParseCsvTable reads: a header line of unique
  // names, rows of numbers with a decimal point, nothing else.
  bool is_plain = false;

  // Refuses rows whose numbers can be read in two ways, with the key that
  // decides.
  [[nodiscard]] bool IsClear(const std::string& path, std::string* error) const;

  // Returns the column that `name` means, or -1 with a sentence in *error: a
  // name, a name without its unit, or a repeated name with its number.
  int FindColumn(const std::string& name, std::string* error) const;
};

// Splits a line into its cells, without blanks and quotes around them. A
// delimiter of ' ' splits at blanks; 0 does not split. `storage` holds cells
// whose quotes were doubled. Returns false if a quoted cell does not end.
[[nodiscard]] bool SplitCells(std::string_view line, char delimiter,
                              std::vector<std::string_view>* cells,
                              std::vector<std::string>* storage);

// Parses a number with this decimal sign: '+', '-', blanks behind the sign,
// exponents, separated thousands (see JoinThousands()). NaN for a missing
// value, see IsMissing(). False for other text.
[[nodiscard]] bool ParseCell(std::string_view cell, char decimal,
                             double* value);

// True for a line that is no row: blank, or beginning with '#'.
bool IsNoRow(std::string_view line);

// Finds the layout of `text` (UTF-8, lines that end with '\n' or "\r\n").
// The rows are the first long run of lines whose cells have the same number and
// kinds. Refuses, with `path:line: ...` and the key that helps, a text without
// rows, and one that has several meanings.
[[nodiscard]] bool FindTextLayout(std::string_view text,
                                  const std::string& path,
                                  const TextFormat& format, TextLayout* layout,
                                  std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_FILES_TEXT_LAYOUT_H_
