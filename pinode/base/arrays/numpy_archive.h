// NumPy archives (.npz): arrays in NumPy's own format in a zip file
// (numpy.lib.format, NEP 1).

#ifndef PINODE_BASE_ARRAYS_NUMPY_ARCHIVE_H_
#define PINODE_BASE_ARRAYS_NUMPY_ARCHIVE_H_

#include <map>
#include <set>
#include <string>

#include "pinode/base/arrays/numpy_array.h"

namespace pinode {

using NumpyArrays = std::map<std::string, NumpyArray>;

// The arrays of `content`, the whole of the file `path`, by name without .npy.
// *others: names of those that are of a type without use here
// (NumpyArrayKind::kOther). Fails with one line in *error where the archive or
// an array of it is broken, or a name is there twice.
[[nodiscard]] bool ReadNumpyArchive(const std::string& path,
                                    const std::string& content,
                                    NumpyArrays* arrays,
                                    std::set<std::string>* others,
                                    std::string* error);

}  // namespace pinode

#endif  // PINODE_BASE_ARRAYS_NUMPY_ARCHIVE_H_
