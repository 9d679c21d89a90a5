// One matrix of Nastran's OUTPUT4 files, whichever form they have.

#ifndef PINODE_STRUCTURE_MATRICES_OP4_MATRIX_H_
#define PINODE_STRUCTURE_MATRICES_OP4_MATRIX_H_

#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/structure/matrices/matrix_container.h"
#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {

// The header of a string in 16 bits for the length and 16 for the row.
constexpr int64_t kOp4StringUnit = 65536;

// What the header of one matrix says, and its entries so far. Rows and columns
// count from 0. Where a function fails, *what says what is wrong.
struct Op4Matrix {
  std::string name;
  int64_t rows = 0;
  int64_t columns = 0;
  int64_t form = 0;
  int64_t type = 0;
  bool big = false;
  // Of the header; 0 in binary files.
  int line = 0;
  std::vector<MatrixEntry> entries;

  bool is_complex() const { return type >= 3; }
  // Numbers per entry.
  int64_t parts() const { return is_complex() ? 2 : 1; }
  // Whether `numbers` from `row` on lie in the matrix.
  bool Fits(int64_t row, int64_t numbers) const;
  // A sentence that they do not.
  std::string PlaceText(int64_t row, int64_t column, int64_t numbers) const;

  // Takes the size as the header has it (negative rows: BIGMAT) and checks it
  // and the type.
  [[nodiscard]] bool SetSize(int64_t columns, int64_t rows, std::string* what);

  // Takes `count` numbers value_at(0), ... (pairs of them for complex matrices)
  // into rows from `row` on; `dense`: zeros are filling.
  template <typename ValueAt>
  [[nodiscard]] bool TakeNumbers(int64_t row, int64_t column, int64_t count,
                                 bool dense, int from_line,
                                 const ValueAt& value_at, std::string* what);

  // Adds the whole matrix to the container. Takes its entries. *failed_line:
  // where it fails.
  [[nodiscard]] bool Finish(MatrixContainer* container, int* failed_line,
                            std::string* what);
};

// Nastran's names, in lower case and without the blanks and zero bytes that
// fill them: at the end, and with 64-bit words, which hold four characters
// each, also between (`MGGE    XT      ` is mggext). No name has a blank of its
// own.
std::string CleanOp4Name(std::string_view text);

template <typename ValueAt>
bool Op4Matrix::TakeNumbers(int64_t row, int64_t column, int64_t count,
                            bool dense, int from_line, const ValueAt& value_at,
                            std::string* what) {
  for (int64_t i = 0; i < count; ++i) {
    const double value = value_at(i);
    if (!std::isfinite(value)) {
      *what = "entry " + EntryText(row + i / parts(), column) + " of " +
              Quote(name) + " is no finite number";
      return false;
    }
    if (is_complex() || (dense && value == 0.0)) continue;
    MatrixEntry entry;
    entry.row = static_cast<int>(row + i);
    entry.column = static_cast<int>(column);
    entry.value = value;
    entry.line = from_line;
    entries.push_back(entry);
  }
  return true;
}

}  // namespace pinode

#endif  // PINODE_STRUCTURE_MATRICES_OP4_MATRIX_H_
