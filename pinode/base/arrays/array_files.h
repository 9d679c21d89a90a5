// Named arrays of MATLAB, NumPy and HDF5 files.

#ifndef PINODE_BASE_ARRAYS_ARRAY_FILES_H_
#define PINODE_BASE_ARRAYS_ARRAY_FILES_H_

#include <functional>
#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// An array with at most two dimensions longer than one, read as a history:
// samples x columns. The samples run along the longer dimension, or along the
// first of two equal ones. It therefore does not matter whether a program
// writes channels as rows or as columns.
struct NamedArray {
  // Name of the variable; "structure.field" for a field, "structure(2).field"
  // if there are several, "cells{2}" for a cell, as MATLAB writes them; the
  // path without its first '/' for an HDF5 data set; the file's name without
  // .npy for an .npy file.
  std::string name;
  Eigen::Index samples = 0;
  Eigen::Index columns = 0;
  Matrix values;  // empty if not wanted
  // Reason why the array is not a history ("it is complex"). Empty if it is
  // one.
  std::string fault;
};

// Returns true if the extension is .mat, .npy, .npz, .h5 or .hdf5, in any case.
bool IsArrayFile(const std::string& path);

// Reads all arrays of numbers of a file. Only the arrays whose names are
// `wanted` get their values. Supported are:
//
// - MATLAB 5 and 7.3 with structures and cells, in each other or not;
// - NumPy arrays of any real type and byte order;
// - HDF5 data sets of any real type, compressed or not. Fields of compound data
//   sets are named "table.field".
//
// Fails with one line in *error if the file is broken.
[[nodiscard]] bool ReadArrayFile(
    const std::string& path,
    const std::function<bool(const std::string&)>& wanted,
    std::vector<NamedArray>* arrays, std::string* error);

}  // namespace pinode

#endif  // PINODE_BASE_ARRAYS_ARRAY_FILES_H_
