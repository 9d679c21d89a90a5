#include "pinode/structure/matrices/matrix_from_arrays.h"

#include <cmath>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/structure/matrices/matrix_text.h"
#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode {
namespace {

bool IsIndices(const NumpyArray& array, int64_t size) {
  return array.is_integer() && array.is_vector() && array.size() == size;
}

bool ReadShape(const NumpyArray& shape, int64_t* rows, int64_t* columns,
               std::string* what) {
  if (!IsIndices(shape, 2)) {
    *what = "has a shape that is not two integers";
    return false;
  }
  *rows = shape.IndexAt(0);
  *columns = shape.IndexAt(1);
  if (*rows < 1 || *columns < 1 || *rows > kMaxFiniteElementDofs ||
      *columns > kMaxFiniteElementDofs) {
    *what = "is " + SizeText(*rows, *columns) + ", expected 1 to " +
            std::to_string(kMaxFiniteElementDofs) + " rows and columns";
    return false;
  }
  return true;
}

// outer: number of rows (CSR) or columns (CSC).
bool CheckParts(const SparseParts& parts, int64_t outer, std::string* what) {
  const int64_t count = parts.data->size();
  if (!parts.data->is_number() || !parts.data->is_vector() ||
      !IsIndices(*parts.indices, count) ||
      (parts.columns != nullptr && !IsIndices(*parts.columns, count)) ||
      (parts.pointers != nullptr && !IsIndices(*parts.pointers, outer + 1))) {
    *what =
        "has parts whose types or lengths do not fit each other or its shape";
    return false;
  }
  if (parts.pointers != nullptr && (parts.pointers->IndexAt(0) != 0 ||
                                    parts.pointers->IndexAt(outer) != count)) {
    *what = "has an indptr that does not go from 0 to " +
            std::to_string(count) + " as was expected";
    return false;
  }
  return true;
}

// Iterates over the rows and columns of the entries.
class Places {
 public:
  Places(const SparseParts& parts, int64_t outer)
      : parts_(parts), outer_(outer) {}

  // Finds row and column of entry k, one more than in the call before. Returns
  // false if indptr descends.
  bool Next(int64_t k, int64_t* row, int64_t* column) {
    *row = parts_.indices->IndexAt(k);
    if (parts_.pointers == nullptr) {
      *column = parts_.columns->IndexAt(k);
      return true;
    }
    const NumpyArray& pointers = *parts_.pointers;
    while (line_ < outer_ && pointers.IndexAt(line_ + 1) <= k) ++line_;
    if (line_ == outer_ || pointers.IndexAt(line_) > k) return false;
    *column = line_;
    if (!parts_.by_columns) std::swap(*row, *column);
    return true;
  }

 private:
  const SparseParts& parts_;
  const int64_t outer_;
  int64_t line_ = 0;  // row (CSR) or column (CSC)
};

}  // namespace

bool MatrixFromParts(const SparseParts& parts, SparseMatrix* matrix,
                     std::string* what) {
  int64_t rows = 0;
  int64_t columns = 0;
  if (!ReadShape(*parts.shape, &rows, &columns, what)) return false;
  const int64_t outer = parts.by_columns ? columns : rows;
  if (!CheckParts(parts, outer, what)) return false;
  const int64_t count = parts.data->size();
  std::vector<MatrixEntry> entries;
  entries.reserve(static_cast<size_t>(count));
  Places places(parts, outer);
  for (int64_t k = 0; k < count; ++k) {
    int64_t row = 0;
    int64_t column = 0;
    if (!places.Next(k, &row, &column)) {
      *what = "has an indptr that does not ascend, as was expected";
      return false;
    }
    if (row < 0 || row >= rows || column < 0 || column >= columns) {
      *what = "has an index outside " + SizeText(rows, columns);
      return false;
    }
    MatrixEntry entry;
    entry.row = static_cast<int>(row);
    entry.column = static_cast<int>(column);
    entry.value = parts.data->NumberAt(k);
    if (!std::isfinite(entry.value)) {
      *what = "has the entry " + EntryText(row, column) +
              " that is not a finite number";
      return false;
    }
    entries.push_back(entry);
  }
  MatrixEntry twice;
  if (!AssembleMatrix(static_cast<int>(rows), static_cast<int>(columns),
                      /*mirrored=*/false, &entries, matrix, &twice)) {
    *what = "has the entry " + EntryText(twice.row, twice.column) +
            " twice, expected once (sum_duplicates() in SciPy)";
    return false;
  }
  return true;
}

bool MatrixFromFullArray(const NumpyArray& array, SparseMatrix* matrix,
                         std::string* what) {
  const int64_t rows = array.shape[0];
  const int64_t columns = array.shape[1];
  if (rows < 1 || columns < 1 || rows > kMaxFullDofs ||
      columns > kMaxFullDofs) {
    *what = "is a full array of " + SizeText(rows, columns) + ", and 1 to " +
            std::to_string(kMaxFullDofs) +
            " rows and columns were expected; save larger ones sparse";
    return false;
  }
  std::vector<MatrixEntry> entries;
  for (int64_t k = 0; k < rows * columns; ++k) {
    const double value = array.NumberAt(k);
    if (value == 0.0) continue;
    MatrixEntry entry;
    entry.row = static_cast<int>(array.fortran_order ? k % rows : k / columns);
    entry.column =
        static_cast<int>(array.fortran_order ? k / rows : k % columns);
    entry.value = value;
    if (!std::isfinite(value)) {
      *what = "has the entry " + EntryText(entry.row, entry.column) +
              " that is not a finite number";
      return false;
    }
    entries.push_back(entry);
  }
  MatrixEntry unused;
  return AssembleMatrix(static_cast<int>(rows), static_cast<int>(columns),
                        /*mirrored=*/false, &entries, matrix, &unused);
}

bool NamesFromArray(const NumpyArray& array, std::vector<std::string>* names,
                    std::string* what) {
  if ((array.kind == 'S' || array.kind == 'U') && array.shape.size() == 1) {
    for (int64_t i = 0; i < array.size(); ++i) {
      names->push_back(array.TextAt(i));
      if (names->back().empty() ||
          FirstInvalidUtf8(names->back()) != std::string::npos) {
        *what =
            "has no name for DOF " + std::to_string(i + 1) + ", expected text";
        return false;
      }
    }
    return true;
  }
  if (array.is_integer() && array.shape.size() == 2 && array.shape[1] == 2) {
    const int64_t rows = array.shape[0];
    for (int64_t i = 0; i < rows; ++i) {
      const int64_t node = array.IndexAt(array.fortran_order ? i : 2 * i);
      const int64_t direction =
          array.IndexAt(array.fortran_order ? rows + i : 2 * i + 1);
      if (node < 0 || direction < 0) {
        *what = "has a negative number in row " + std::to_string(i + 1) +
                ", expected node and direction";
        return false;
      }
      names->push_back(std::to_string(node) + "." + std::to_string(direction));
    }
    return true;
  }
  *what =
      "is neither a list of names nor of pairs (node, direction), expected one "
      "of these";
  return false;
}

}  // namespace pinode
