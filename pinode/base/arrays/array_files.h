// Arrays with names, as MATLAB, NumPy and HDF5 files hold them.

#ifndef PINODE_BASE_ARRAYS_ARRAY_FILES_H_
#define PINODE_BASE_ARRAYS_ARRAY_FILES_H_

#include <functional>
#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// An array of at most two dimensions that are longer than one, as a history:
// samples x columns, the samples along the longer dimension (along the first of
// two equal ones). Whether a program writes channels as rows or as columns does
// not matter so.
struct NamedArray {
  // Of a variable; of a field "structure.field"; of an HDF5 data set its path
  // without the first '/'; of the array of an .npy file the file's name without
  // .npy.
  std::string name;
  Eigen::Index samples = 0;
  Eigen::Index columns = 0;
  Matrix values;  // empty where they were not wanted
  // Why it is no history ("it is complex"), else empty.
  std::string fault;
};

// By its extension, in any case: .mat, .npy, .npz, .h5, .hdf5.
bool IsArrayFile(const std::string& path);

// All arrays of numbers of a file, with the values of those whose names are
// `wanted`. MATLAB 5 and 7.3 with structures (one deep or more), NumPy arrays
// of any real type and byte order, HDF5 data sets of any real type, compressed
// or not, with the fields of compound ones as "table.field". Fails with one
// line where the file is broken.
[[nodiscard]] bool ReadArrayFile(
    const std::string& path,
    const std::function<bool(const std::string&)>& wanted,
    std::vector<NamedArray>* arrays, std::string* error);

}  // namespace pinode

#endif  // PINODE_BASE_ARRAYS_ARRAY_FILES_H_
