// One matrix of Nastran's OUTPUT4 files, in text or binary form.

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

// Factor between length and row in the header of a string: 16 bits for the
// length and 16 for the row.
constexpr int64_t kOp4StringUnit = 65536;

// The header of one matrix, and its entries so far. Rows and columns count from
// 0. A function that fails sets *what to the error.
struct Op4Matrix {
  std::string name;
  int64_t rows = 0;
  int64_t columns = 0;
  int64_t form = 0;
  int64_t type = 0;
  bool big = false;
  // Line of the header. 0 in binary files.
  int line = 0;
  std::vector<MatrixEntry> entries;

  bool is_complex() const { return type >= 3; }
  // Returns the numbers per entry: 2 for complex matrices, else 1.
  int64_t parts() const { return is_complex() ? 2 : 1; }
  // Returns true if `numbers` from `row` on lie in the matrix.
  bool Fits(int64_t row, int64_t numbers) const;
  // Returns a sentence for numbers that do not lie in the matrix.
  std::string PlaceText(int64_t row, int64_t column, int64_t numbers) const;

  // Sets the size from the header (negative rows: BIGMAT), and checks it and
  // the type.
  [[nodiscard]] bool SetSize(int64_t columns, int64_t rows, std::string* what);

  // Adds `count` numbers value_at(0), ... (pairs of them for complex matrices)
  // to the rows from `row` on. With `dense`, zeros are padding.
  template <typename ValueAt>
  [[nodiscard]] bool TakeNumbers(int64_t row, int64_t column, int64_t count,
                                 bool dense, int from_line,
                                 const ValueAt& value_at, std::string* what);

  // Adds the whole matrix to the container and moves its entries. On failure
  // *failed_line is the line with the error.
  [[nodiscard]] bool Finish(MatrixContainer* container, int* failed_line,
                            std::string* what);
};

// Returns one of Nastran's names in lower case, without the blanks and zero
// bytes that pad it. Padding is at the end. With 64-bit words, which hold four
// characters each, it is also between them (`MGGE    XT      ` is mggext). No
// name contains a blank.
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
