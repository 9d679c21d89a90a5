#include "pinode/structure/matrices/mat_file.h"

#include <matio.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "pinode/base/arrays/matlab_file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/base/unpacked_size.h"
#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {
namespace {

bool IsDofVariable(const std::string& name) {
  const std::string lower = LowerCase(name);
  return lower == "dofs" || lower == "dof_names" || lower == "dof_map";
}

bool IsFull(const matvar_t& variable) {
  return variable.class_type >= MAT_C_DOUBLE &&
         variable.class_type <= MAT_C_UINT64;
}

bool AddEntry(size_t row, size_t column, double value,
              std::vector<MatrixEntry>* entries, std::string* what) {
  if (!std::isfinite(value)) {
    *what = "has the entry " +
            EntryText(static_cast<Eigen::Index>(row),
                      static_cast<Eigen::Index>(column)) +
            " that is not a finite number";
    return false;
  }
  MatrixEntry entry;
  entry.row = static_cast<int>(row);
  entry.column = static_cast<int>(column);
  entry.value = value;
  entries->push_back(entry);
  return true;
}

// Returns the entries of a variable whose data have been read. False with a
// sentence in *what that continues "variable 'x' ...".
bool FullEntries(const matvar_t& variable, std::vector<MatrixEntry>* entries,
                 std::string* what) {
  const size_t rows = variable.dims[0];
  const size_t columns = variable.dims[1];
  const size_t size = MatlabTypeSize(variable.data_type);
  if (variable.data == nullptr || size == 0 ||
      variable.nbytes < rows * columns * size) {
    *what =
        "has fewer data than its size needs; check that the file is complete";
    return false;
  }
  for (size_t j = 0; j < columns; ++j) {
    for (size_t i = 0; i < rows; ++i) {
      const double value =
          MatlabNumberAt(variable.data, variable.data_type, j * rows + i);
      if (value != 0.0 && !AddEntry(i, j, value, entries, what)) return false;
    }
  }
  return true;
}

bool SparseEntries(const matvar_t& variable, std::vector<MatrixEntry>* entries,
                   std::string* what) {
  const auto* sparse = static_cast<const mat_sparse_t*>(variable.data);
  const size_t rows = variable.dims[0];
  const size_t columns = variable.dims[1];
  if (sparse == nullptr || sparse->jc == nullptr ||
      sparse->njc != columns + 1 || MatlabTypeSize(variable.data_type) == 0) {
    *what =
        "has no column pointers that fit its size; check that the file is "
        "complete";
    return false;
  }
  const size_t available = std::min<size_t>(sparse->nir, sparse->ndata);
  for (size_t j = 0; j < columns; ++j) {
    const size_t begin = sparse->jc[j];
    const size_t end = sparse->jc[j + 1];
    if ((j == 0 && begin != 0) || end < begin || end > available) {
      *what = "has column pointers that do not ascend from 0 to at most " +
              std::to_string(available) + ", as was expected";
      return false;
    }
    for (size_t k = begin; k < end; ++k) {
      const size_t row = sparse->ir[k];
      if (row >= rows) {
        *what = "has an entry in row " + std::to_string(row + 1) +
                ", expected at most " + std::to_string(rows);
        return false;
      }
      if (!AddEntry(row, j, MatlabNumberAt(sparse->data, variable.data_type, k),
                    entries, what)) {
        return false;
      }
    }
  }
  return true;
}

bool BuildMatrix(const matvar_t& variable, SparseMatrix* matrix,
                 std::string* what) {
  std::vector<MatrixEntry> entries;
  if (!(variable.class_type == MAT_C_SPARSE
            ? SparseEntries(variable, &entries, what)
            : FullEntries(variable, &entries, what))) {
    return false;
  }
  MatrixEntry twice;
  if (!AssembleMatrix(static_cast<int>(variable.dims[0]),
                      static_cast<int>(variable.dims[1]), /*mirrored=*/false,
                      &entries, matrix, &twice)) {
    *what = "has the entry " + EntryText(twice.row, twice.column) +
            " twice, expected once";
    return false;
  }
  return true;
}

// Reads row `row` of a character array. Only ASCII is accepted, as for names of
// DOFs.
bool CharacterRow(const matvar_t& variable, size_t row, std::string* text) {
  const size_t rows = variable.dims[0];
  const size_t columns = variable.dims[1];
  const size_t size = MatlabTypeSize(variable.data_type);
  if (variable.data == nullptr || (size != 1 && size != 2) ||
      variable.nbytes < rows * columns * size) {
    return false;
  }
  for (size_t j = 0; j < columns; ++j) {
    const size_t index = j * rows + row;
    const unsigned code =
        size == 1 ? static_cast<const uint8_t*>(variable.data)[index]
                  : static_cast<const uint16_t*>(variable.data)[index];
    if (code > 126 || (code < 32 && code != 0)) return false;
    text->push_back(code == 0 ? ' ' : static_cast<char>(code));
  }
  *text = std::string(StripBlanks(*text));
  return !text->empty();
}

bool BuildNames(const matvar_t& variable, std::vector<std::string>* names,
                std::string* what) {
  const size_t rows = variable.dims[0];
  const size_t columns = variable.dims[1];
  if (variable.class_type == MAT_C_CELL && variable.data != nullptr) {
    const auto* cells = static_cast<matvar_t* const*>(variable.data);
    const size_t count =
        std::min(rows * columns, variable.nbytes / sizeof(matvar_t*));
    for (size_t i = 0; i < count; ++i) {
      std::string name;
      if (cells[i] == nullptr || cells[i]->class_type != MAT_C_CHAR ||
          cells[i]->rank != 2 || cells[i]->dims[0] != 1 ||
          !CharacterRow(*cells[i], 0, &name)) {
        *what = "has no name in cell " + std::to_string(i + 1) +
                ", expected text in ASCII";
        return false;
      }
      names->push_back(std::move(name));
    }
    return true;
  }
  if (variable.class_type == MAT_C_CHAR) {
    for (size_t i = 0; i < rows; ++i) {
      std::string name;
      if (!CharacterRow(variable, i, &name)) {
        *what = "has no name in row " + std::to_string(i + 1) +
                ", expected text in ASCII";
        return false;
      }
      names->push_back(std::move(name));
    }
    return true;
  }
  if (IsFull(variable) && columns == 2 && variable.data != nullptr &&
      variable.nbytes >= 2 * rows * MatlabTypeSize(variable.data_type)) {
    for (size_t i = 0; i < rows; ++i) {
      std::string name;
      for (const size_t index : {i, rows + i}) {
        const double number =
            MatlabNumberAt(variable.data, variable.data_type, index);
        if (!(number >= 0.0 && number <= 1e15 &&
              number == std::trunc(number))) {
          *what = "has no integer in row " + std::to_string(i + 1) +
                  ", expected node and direction";
          return false;
        }
        name += (name.empty() ? "" : ".") +
                std::to_string(static_cast<int64_t>(number));
      }
      names->push_back(std::move(name));
    }
    return true;
  }
  *what =
      "names no DOFs, expected a cell array of strings, a character array or "
      "pairs (node, direction)";
  return false;
}

// Checks that a variable of this size may be read. Returns false and sets *what
// otherwise.
bool CheckSize(const matvar_t& variable, size_t file_size, std::string* what) {
  const size_t rows = variable.dims[0];
  const size_t columns = variable.dims[1];
  const bool sparse = variable.class_type == MAT_C_SPARSE;
  const size_t largest = sparse || variable.class_type == MAT_C_CELL ||
                                 variable.class_type == MAT_C_CHAR ||
                                 columns == 2
                             ? static_cast<size_t>(kMaxFiniteElementDofs)
                             : static_cast<size_t>(kMaxFullDofs);
  if (rows < 1 || columns < 1 || rows > largest || columns > largest) {
    *what = "is " + std::to_string(rows) + " x " + std::to_string(columns) +
            ", expected 1 to " + std::to_string(largest) + " rows and columns" +
            (sparse ? "" : "; save larger ones sparse");
    return false;
  }
  if (!sparse && rows * columns > kLargestMatlabExpansion * file_size) {
    *what = "is " + std::to_string(rows) + " x " + std::to_string(columns) +
            ", more than the file can hold; check that it is complete";
    return false;
  }
  return true;
}

}  // namespace

bool ReadMatFile(const std::string& path, MatrixContainer* container,
                 std::string* error) {
  CHECK(container != nullptr);
  CHECK(error != nullptr);
  MatlabFile file;
  if (!file.Open(path, error)) return false;
  UnpackedSize memory(static_cast<double>(file.size()));
  std::string what;
  MatrixContainer result;
  while (const MatlabVariable variable = file.Next()) {
    const std::string name = variable->name == nullptr ? "" : variable->name;
    const bool is_names = IsDofVariable(name);
    const bool is_matrix =
        IsFull(*variable) || variable->class_type == MAT_C_SPARSE;
    if (variable->rank != 2 || variable->dims == nullptr ||
        (!is_names && (!is_matrix || variable->dims[0] != variable->dims[1]))) {
      continue;
    }
    NamedMatrix matrix;
    matrix.name = name;
    bool good = CheckSize(*variable, file.size(), &what) &&
                (variable->class_type == MAT_C_SPARSE ||
                 memory.Take(static_cast<double>(sizeof(double)) *
                                 static_cast<double>(variable->dims[0]) *
                                 static_cast<double>(variable->dims[1]),
                             &what));
    if (good && is_matrix && variable->isComplex) {
      matrix.fault = "it is complex";
      result.matrices.push_back(std::move(matrix));
      continue;
    }
    if (good && !file.ReadData(variable.get())) {
      what = "cannot be read; check that the file is complete";
      good = false;
    }
    if (good) {
      good = is_names ? BuildNames(*variable, &result.dof_names, &what)
                      : BuildMatrix(*variable, &matrix.matrix, &what);
    }
    if (!good) {
      *error = path + ": variable " + Quote(name) + " " + what;
      return false;
    }
    if (!is_names) result.matrices.push_back(std::move(matrix));
  }
  *container = std::move(result);
  return true;
}

}  // namespace pinode
