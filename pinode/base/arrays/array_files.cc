#include "pinode/base/arrays/array_files.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "pinode/base/arrays/array_shape.h"
#include "pinode/base/arrays/matlab_file.h"
#include "pinode/base/arrays/numpy_archive.h"
#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/logging.h"
#include "pinode/base/unpacked_size.h"

namespace pinode {
namespace {

constexpr char kBrokenMatlabVariable[] =
    " has fewer data than its size needs; check that the file is complete";

std::string ExtensionOf(const std::string& path) {
  return LowerCase(std::filesystem::path(path).extension().string());
}

void AddNumpyArray(const std::string& name, const NumpyArray& source,
                   const ArrayFilter& wanted, std::vector<NamedArray>* arrays) {
  NamedArray array;
  array.name = name;
  int64_t by_sample = 0;
  int64_t by_column = 0;
  if (!source.is_number()) {
    array.fault = "it is text";
  } else if (ShapeArray(source.shape, !source.fortran_order, &array, &by_sample,
                        &by_column) &&
             wanted(name)) {
    array.values.resize(array.samples, array.columns);
    for (Eigen::Index c = 0; c < array.columns; ++c) {
      for (Eigen::Index k = 0; k < array.samples; ++k) {
        array.values(k, c) = source.NumberAt(k * by_sample + c * by_column);
      }
    }
  }
  arrays->push_back(std::move(array));
}

// Returns the number of elements of a variable, or 0 without dimensions.
size_t CountElements(const matvar_t& variable) {
  size_t count = variable.rank > 0 && variable.dims != nullptr ? 1 : 0;
  for (int d = 0; count > 0 && d < variable.rank; ++d) {
    count *= variable.dims[d];
  }
  return count;
}

// The variables of a MATLAB file, the fields of its structures and its cells.
class MatlabArrays {
 public:
  MatlabArrays(const std::string& path, const ArrayFilter& wanted,
               std::vector<NamedArray>* arrays, std::string* error)
      : path_(path), wanted_(wanted), arrays_(arrays), error_(error) {}

  bool Read() {
    if (!file_.Open(path_, error_)) return false;
    UnpackedSize memory(static_cast<double>(file_.size()));
    while (const MatlabVariable variable = file_.Next()) {
      if (variable->name == nullptr) continue;
      const std::string name = variable->name;
      const bool is_container = IsContainer(*variable);
      if (!is_container && !IsFullOfNumbers(*variable)) continue;
      const double count = CountNumbers(*variable, 0);
      if (!std::isfinite(count)) return Fail(name, kBrokenMatlabVariable);
      const bool is_read = is_container || wanted_(name);
      std::string what;
      // The numbers stand in the order of the file and in ours for a while.
      if (is_read && !memory.Take(2.0 * sizeof(double) * count, &what)) {
        return Fail(name, " " + what);
      }
      if (is_read && !file_.ReadData(variable.get())) {
        return Fail(name, " cannot be read; check that the file is complete");
      }
      if (!Add(name, variable.get(), 0)) return false;
    }
    return true;
  }

 private:
  // Deepest level of structures and cells in each other. Deeper ones are not
  // records.
  static constexpr int kDeepestLevel = 8;

  static bool IsContainer(const matvar_t& variable) {
    return variable.class_type == MAT_C_STRUCT ||
           variable.class_type == MAT_C_CELL;
  }
  static bool IsFullOfNumbers(const matvar_t& variable) {
    return variable.class_type >= MAT_C_DOUBLE &&
           variable.class_type <= MAT_C_UINT64;
  }

  bool Fail(const std::string& name, const std::string& what) {
    *error_ = path_ + ": variable " + Quote(name) + what;
    return false;
  }

  // Returns the numbers that a variable, its fields and cells announce, or
  // infinity if the file cannot hold them.
  double CountNumbers(const matvar_t& variable, int depth) const {
    constexpr double kTooMany = std::numeric_limits<double>::infinity();
    if (variable.dims == nullptr) return kTooMany;
    double count = 1.0;
    for (int d = 0; d < variable.rank; ++d) {
      count *= static_cast<double>(variable.dims[d]);
    }
    if (count > static_cast<double>(kLargestMatlabExpansion) *
                    static_cast<double>(file_.size())) {
      return kTooMany;
    }
    if (!IsContainer(variable) || variable.data == nullptr) return count;
    if (depth > kDeepestLevel) return kTooMany;
    const auto* fields = static_cast<matvar_t* const*>(variable.data);
    for (size_t i = 0; i < variable.nbytes / sizeof(matvar_t*); ++i) {
      if (fields[i] != nullptr) count += CountNumbers(*fields[i], depth + 1);
    }
    return count;
  }

  bool Add(const std::string& name, matvar_t* variable, int depth) {
    if (variable->class_type == MAT_C_STRUCT) {
      return depth >= kDeepestLevel || AddFields(name, variable, depth);
    }
    if (variable->class_type == MAT_C_CELL) {
      return depth >= kDeepestLevel || AddCells(name, variable, depth);
    }
    return !IsFullOfNumbers(*variable) || AddNumbers(name, *variable);
  }

  // Adds the fields of a structure, "data.acc", or of each of several
  // structures, "data(2).acc".
  bool AddFields(const std::string& name, matvar_t* variable, int depth) {
    const size_t count = CountElements(*variable);
    const unsigned num_fields = Mat_VarGetNumberOfFields(variable);
    char* const* names = Mat_VarGetStructFieldnames(variable);
    if (names == nullptr || variable->data == nullptr) return true;
    for (size_t i = 0; i < count; ++i) {
      const std::string element =
          count == 1 ? name : name + "(" + std::to_string(i + 1) + ")";
      for (unsigned f = 0; f < num_fields; ++f) {
        matvar_t* field = Mat_VarGetStructFieldByIndex(variable, f, i);
        if (field == nullptr || names[f] == nullptr) continue;
        if (!Add(element + "." + names[f], field, depth + 1)) return false;
      }
    }
    return true;
  }

  // Adds the cells of an array of cells, "data{2}".
  bool AddCells(const std::string& name, matvar_t* variable, int depth) {
    if (variable->data == nullptr) return true;
    const size_t count = std::min(CountElements(*variable),
                                  variable->nbytes / sizeof(matvar_t*));
    auto* const* cells = static_cast<matvar_t* const*>(variable->data);
    for (size_t i = 0; i < count; ++i) {
      if (cells[i] != nullptr &&
          !Add(name + "{" + std::to_string(i + 1) + "}", cells[i], depth + 1)) {
        return false;
      }
    }
    return true;
  }

  bool AddNumbers(const std::string& name, const matvar_t& variable) {
    NamedArray array;
    array.name = name;
    const std::vector<int64_t> dimensions(variable.dims,
                                          variable.dims + variable.rank);
    int64_t by_sample = 0;
    int64_t by_column = 0;
    if (ShapeArray(dimensions, /*by_rows=*/false, &array, &by_sample,
                   &by_column)) {
      if (variable.isComplex) {
        array.fault = "it is complex";
      } else if (wanted_(name)) {
        const size_t size = MatlabTypeSize(variable.data_type);
        if (variable.data == nullptr || size == 0 ||
            variable.nbytes < static_cast<size_t>(array.samples) *
                                  static_cast<size_t>(array.columns) * size) {
          return Fail(name, kBrokenMatlabVariable);
        }
        array.values.resize(array.samples, array.columns);
        for (Eigen::Index c = 0; c < array.columns; ++c) {
          for (Eigen::Index k = 0; k < array.samples; ++k) {
            array.values(k, c) = MatlabNumberAt(
                variable.data, variable.data_type,
                static_cast<size_t>(k * by_sample + c * by_column));
          }
        }
      }
    }
    arrays_->push_back(std::move(array));
    return true;
  }

  const std::string& path_;
  const ArrayFilter& wanted_;
  std::vector<NamedArray>* const arrays_;
  std::string* const error_;
  MatlabFile file_;
};

}  // namespace

bool ShapeArray(const std::vector<int64_t>& dimensions, bool by_rows,
                NamedArray* array, int64_t* sample_stride,
                int64_t* column_stride) {
  // Dimensions longer than one, and the strides of their numbers.
  std::vector<int64_t> lengths;
  std::vector<int64_t> strides;
  int64_t stride = 1;
  bool empty = false;
  const size_t rank = dimensions.size();
  for (size_t i = 0; i < rank; ++i) {
    const int64_t length = dimensions[by_rows ? rank - 1 - i : i];
    empty = empty || length == 0;
    if (length > 1) {
      lengths.push_back(length);
      strides.push_back(stride);
    }
    stride *= length;
  }
  if (lengths.size() > 2) {
    array->fault = "it has " + std::to_string(lengths.size()) + " dimensions";
    return false;
  }
  if (empty) {
    array->fault = "it is empty";
    return false;
  }
  // Innermost dimension first: for a matrix by rows, the columns.
  while (lengths.size() < 2) {
    lengths.push_back(1);
    strides.push_back(0);
  }
  const size_t first = by_rows ? 1 : 0;
  const size_t samples =
      lengths[first] >= lengths[1 - first] ? first : 1 - first;
  array->samples = lengths[samples];
  array->columns = lengths[1 - samples];
  *sample_stride = strides[samples];
  *column_stride = strides[1 - samples];
  return true;
}

bool ReadNumpyArrays(const std::string& path, const ArrayFilter& wanted,
                     std::vector<NamedArray>* arrays, std::string* error) {
  std::string content;
  if (!ReadBinaryFile(path, &content, error)) return false;
  NumpyArrays found;
  std::set<std::string> others;
  if (ExtensionOf(path) == ".npz") {
    if (!ReadNumpyArchive(path, content, wanted, &found, &others, error)) {
      return false;
    }
    if (found.empty() && others.empty()) {
      *error = path + ": holds no array, expected a NumPy archive";
      return false;
    }
  } else {
    const std::string name = std::filesystem::path(path).stem().string();
    NumpyArray array;
    std::string what;
    switch (ParseNumpyArray(std::move(content), &array, &what)) {
      case NumpyArrayKind::kBroken:
        *error = path + ": the file " + what;
        return false;
      case NumpyArrayKind::kOther:
        others.insert(name);
        break;
      case NumpyArrayKind::kUsable:
        found.emplace(name, std::move(array));
    }
  }
  for (const auto& [name, array] : found) {
    AddNumpyArray(name, array, wanted, arrays);
  }
  for (const std::string& name : others) {
    NamedArray array;
    array.name = name;
    array.fault =
        "it is not of a real type (complex numbers, records, objects)";
    arrays->push_back(std::move(array));
  }
  return true;
}

bool ReadMatlabArrays(const std::string& path, const ArrayFilter& wanted,
                      std::vector<NamedArray>* arrays, std::string* error) {
  return MatlabArrays(path, wanted, arrays, error).Read();
}

bool IsArrayFile(const std::string& path) {
  const std::string extension = ExtensionOf(path);
  for (const char* known : {".mat", ".npy", ".npz", ".h5", ".hdf5"}) {
    if (extension == known) return true;
  }
  return false;
}

bool ReadArrayFile(const std::string& path, const ArrayFilter& wanted,
                   std::vector<NamedArray>* arrays, std::string* error) {
  CHECK(arrays != nullptr);
  CHECK(error != nullptr);
  const std::string extension = ExtensionOf(path);
  std::vector<NamedArray> found;
  const auto read = extension == ".mat"   ? ReadMatlabArrays
                    : extension == ".npy" ? ReadNumpyArrays
                    : extension == ".npz" ? ReadNumpyArrays
                                          : ReadHdf5Arrays;
  if (!read(path, wanted, &found, error)) return false;
  *arrays = std::move(found);
  return true;
}

}  // namespace pinode
