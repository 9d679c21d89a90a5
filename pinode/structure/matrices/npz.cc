#include "pinode/structure/matrices/npz.h"

#include <map>
#include <set>
#include <utility>
#include <vector>

#include "pinode/base/arrays/numpy_archive.h"
#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/matrices/matrix_from_arrays.h"
#include "pinode/structure/matrices/matrix_text.h"

namespace pinode {
namespace {

using Arrays = NumpyArrays;

bool IsDofArray(const std::string& name) {
  const std::string lower = LowerCase(name);
  return lower == "dofs" || lower == "dof_names" || lower == "dof_map";
}

const NumpyArray* Find(const Arrays& arrays, const std::string& name) {
  const auto found = arrays.find(name);
  return found == arrays.end() ? nullptr : &found->second;
}

// Finds the parts whose names begin with `prefix`. Returns false if they are
// not complete.
bool FindParts(const Arrays& arrays, const std::string& prefix,
               SparseParts* parts) {
  parts->data = Find(arrays, prefix + "data");
  parts->shape = Find(arrays, prefix + "shape");
  parts->indices = Find(arrays, prefix + "indices");
  parts->pointers = Find(arrays, prefix + "indptr");
  if (parts->pointers == nullptr) {
    parts->indices = Find(arrays, prefix + "row");
    parts->columns = Find(arrays, prefix + "col");
    if (parts->columns == nullptr) return false;
  }
  return parts->data != nullptr && parts->shape != nullptr &&
         parts->indices != nullptr;
}

// Returns the format that scipy.sparse.save_npz states; empty if there is none.
std::string SparseFormat(const Arrays& arrays, const std::string& prefix) {
  const NumpyArray* format = Find(arrays, prefix + "format");
  if (format == nullptr || format->is_number() || format->size() != 1) {
    return "";
  }
  return format->TextAt(0);
}

enum class ArrayUse { kNone, kBad, kGood };

// Finds the sparse matrix of which "<prefix>data" is a part, if it is one.
ArrayUse FindSparse(const Arrays& arrays, const std::string& prefix,
                    SparseParts* parts, std::string* what) {
  const std::string format = SparseFormat(arrays, prefix);
  const bool complete = FindParts(arrays, prefix, parts);
  if (!complete && format.empty()) return ArrayUse::kNone;
  // SciPy's other formats: BSR has parts of other shapes, DIA offsets.
  if (!complete || (!format.empty() && format != "csr" && format != "csc" &&
                    format != "coo")) {
    *what = "is of the sparse format " + Quote(format) +
            ", expected csr, csc or coo";
    return ArrayUse::kBad;
  }
  parts->by_columns = format == "csc";
  return ArrayUse::kGood;
}

}  // namespace

bool ReadNpzContent(const std::string& path, const std::string& content,
                    MatrixContainer* container, std::string* error) {
  CHECK(container != nullptr);
  CHECK(error != nullptr);
  Arrays arrays;
  std::set<std::string> others;
  const auto all = [](const std::string&) { return true; };
  if (!ReadNumpyArchive(path, content, all, &arrays, &others, error)) {
    return false;
  }
  MatrixContainer result;
  const auto fail = [&path, error](const std::string& name,
                                   const std::string& what) {
    *error = path + ": array " + Quote(name) + " " + what;
    return false;
  };
  constexpr std::string_view kData = "data";
  for (const auto& [name, array] : arrays) {
    std::string what;
    NamedMatrix matrix;
    matrix.name = name;
    if (IsDofArray(name)) {
      if (!result.dof_names.empty()) {
        return fail(name, "names the DOFs again, expected once");
      }
      if (!NamesFromArray(array, &result.dof_names, &what)) {
        return fail(name, what);
      }
    } else if (name.size() >= kData.size() &&
               name.substr(name.size() - kData.size()) == kData) {
      const std::string prefix = name.substr(0, name.size() - kData.size());
      SparseParts parts;
      const ArrayUse use = FindSparse(arrays, prefix, &parts, &what);
      if (use == ArrayUse::kNone) continue;
      if (use == ArrayUse::kBad ||
          !MatrixFromParts(parts, &matrix.matrix, &what)) {
        return fail(name, what);
      }
      matrix.name = prefix;
      while (!matrix.name.empty() && matrix.name.back() == '_') {
        matrix.name.pop_back();
      }
      result.matrices.push_back(std::move(matrix));
    } else if (array.is_number() && array.shape.size() == 2) {
      if (!MatrixFromFullArray(array, &matrix.matrix, &what)) {
        if (array.shape[0] != array.shape[1]) continue;  // results, say
        return fail(name, what);
      }
      result.matrices.push_back(std::move(matrix));
    }
  }
  for (const std::string& name : others) {
    if (IsDofArray(name)) {
      return fail(name,
                  "is of a type that only Python reads (objects), expected "
                  "text or integers: numpy.array(names, dtype=str)");
    }
    NamedMatrix matrix;
    matrix.name = name;
    matrix.fault = "it is not of a real type (complex numbers, objects)";
    result.matrices.push_back(std::move(matrix));
  }
  *container = std::move(result);
  return true;
}

bool ReadNpz(const std::string& path, MatrixContainer* container,
             std::string* error) {
  CHECK(error != nullptr);
  std::string content;
  return ReadBinaryFile(path, &content, error) &&
         ReadNpzContent(path, content, container, error);
}

}  // namespace pinode
