// Reads MATLAB files with matio: version 5 (compressed or not) and 7.3 (HDF5).

#ifndef PINODE_BASE_ARRAYS_MATLAB_FILE_H_
#define PINODE_BASE_ARRAYS_MATLAB_FILE_H_

#include <matio.h>

#include <cstddef>
#include <memory>
#include <string>

namespace pinode {

struct MatlabVariableFreer {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using MatlabVariable = std::unique_ptr<matvar_t, MatlabVariableFreer>;

// A file whose variables are read one after the other.
class MatlabFile {
 public:
  MatlabFile();
  ~MatlabFile();
  MatlabFile(const MatlabFile&) = delete;
  MatlabFile& operator=(const MatlabFile&) = delete;

  // Opens the file. Returns false, with one line in *error, if the file is
  // neither of the two versions or is incomplete. Version 5 is checked with
  // mat5_structure.h.
  [[nodiscard]] bool Open(const std::string& path, std::string* error);

  // Returns the next variable and its fields, without their data. Returns null
  // after the last one.
  MatlabVariable Next();
  // Reads the data of a variable, including its fields and cells.
  [[nodiscard]] bool ReadData(matvar_t* variable);

  // Size of the file in bytes.
  size_t size() const { return size_; }

 private:
  struct Opened;
  std::unique_ptr<Opened> opened_;
  size_t size_ = 0;
};

// Largest possible ratio of unpacked to packed bytes in zlib, rounded up.
// Variables larger than this ratio times their file are not read.
constexpr size_t kLargestMatlabExpansion = 1100;

// Returns number `index` of `data`, or NaN if `type` is not a real type.
double MatlabNumberAt(const void* data, matio_types type, size_t index);

// Returns the bytes of one number, or 0 if `type` is not a numeric type.
size_t MatlabTypeSize(matio_types type);

}  // namespace pinode

#endif  // PINODE_BASE_ARRAYS_MATLAB_FILE_H_
