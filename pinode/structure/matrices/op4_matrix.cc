#include "pinode/structure/matrices/op4_matrix.h"

#include <utility>

#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {
namespace {

// Number of rows above which 16 bits for the row in a string header are too
// few. Nastran then writes BIGMAT by itself.
constexpr int64_t kBigMatrixRows = 65536;

}  // namespace

bool Op4Matrix::Fits(int64_t row, int64_t numbers) const {
  return row >= 0 && numbers >= 1 && numbers % parts() == 0 &&
         numbers / parts() <= rows - row;
}

std::string Op4Matrix::PlaceText(int64_t row, int64_t column,
                                 int64_t numbers) const {
  return std::to_string(numbers) + " numbers from row " +
         std::to_string(row + 1) + " of column " + std::to_string(column + 1) +
         " of " + Quote(name) + " do not fit, expected " +
         SizeText(rows, columns);
}

bool Op4Matrix::SetSize(int64_t header_columns, int64_t header_rows,
                        std::string* what) {
  big = header_rows < 0 || header_rows >= kBigMatrixRows;
  columns = header_columns;
  rows = header_rows < 0 ? -header_rows : header_rows;
  if (columns < 1 || rows < 1 || columns > kMaxFiniteElementDofs ||
      rows > kMaxFiniteElementDofs) {
    *what = "matrix " + Quote(name) + " is " + std::to_string(header_rows) +
            " x " + std::to_string(header_columns) + ", expected 1 to " +
            std::to_string(kMaxFiniteElementDofs) + " rows and columns";
    return false;
  }
  if (type < 1 || type > 4) {
    *what = "matrix " + Quote(name) + " has type " + std::to_string(type) +
            ", expected 1 to 4";
    return false;
  }
  return true;
}

bool Op4Matrix::Finish(MatrixContainer* container, int* failed_line,
                       std::string* what) {
  NamedMatrix result;
  result.name = name;
  *failed_line = line;
  if (is_complex()) {
    result.fault = "it is complex";
  } else if (form != 1 && form != 2 && form != 6 && form != 9) {
    result.fault = "its form is " + std::to_string(form) +
                   ", expected 1 (square) or 6 (symmetric)";
  } else {
    MatrixEntry twice;
    if (!AssembleMatrix(static_cast<int>(rows), static_cast<int>(columns),
                        /*mirrored=*/false, &entries, &result.matrix, &twice)) {
      *failed_line = twice.line;
      *what = "entry " + EntryText(twice.row, twice.column) + " of " +
              Quote(name) + " was given before, expected each entry once";
      return false;
    }
  }
  container->matrices.push_back(std::move(result));
  return true;
}

std::string CleanOp4Name(std::string_view text) {
  std::string name;
  for (const char c : text) {
    if (c != ' ' && c != '\0') name += c;
  }
  return LowerCase(name);
}

}  // namespace pinode
