// MATLAB files: version 5 (compressed or not) and 7.3 (HDF5), by matio.

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

// A file whose variables are looked at one after the other.
class MatlabFile {
 public:
  MatlabFile();
  ~MatlabFile();
  MatlabFile(const MatlabFile&) = delete;
  MatlabFile& operator=(const MatlabFile&) = delete;

  // False with one line where the file is neither of the versions or not whole
  // (version 5 is walked through: see mat5_structure.h).
  [[nodiscard]] bool Open(const std::string& path, std::string* error);

  // What is said of the next variable (and of its fields), without its data;
  // null behind the last one.
  MatlabVariable Next();
  // Its data, with those of its fields and cells.
  [[nodiscard]] bool ReadData(matvar_t* variable);

  // Bytes of the file.
  size_t size() const { return size_; }

 private:
  struct Opened;
  std::unique_ptr<Opened> opened_;
  size_t size_ = 0;
};

// What zlib can make of a byte at best, rounded up: variables that would be
// larger than so many times their file are not read.
constexpr size_t kLargestMatlabExpansion = 1100;

// Number `index` of `data`; NaN for what is no real type.
double MatlabNumberAt(const void* data, matio_types type, size_t index);

// Bytes of a number; 0 for what is none.
size_t MatlabTypeSize(matio_types type);

}  // namespace pinode

#endif  // PINODE_BASE_ARRAYS_MATLAB_FILE_H_
