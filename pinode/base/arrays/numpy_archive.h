// NumPy archives (.npz): arrays in NumPy's own format in a zip file
// (numpy.lib.format, NEP 1).

#ifndef PINODE_BASE_ARRAYS_NUMPY_ARCHIVE_H_
#define PINODE_BASE_ARRAYS_NUMPY_ARCHIVE_H_

#include <functional>
#include <map>
#include <set>
#include <string>

#include "pinode/base/arrays/numpy_array.h"

namespace pinode {

using NumpyArrays = std::map<std::string, NumpyArray>;

// Reads the arrays in `content`, the whole content of the file `path`. Arrays
// are called by their names without .npy. *others receives the names of arrays
// whose type is not supported (NumpyArrayKind::kOther). Only the arrays whose
// names are `wanted` get their data; nothing of the others is unpacked but the
// header. Fails with one line in *error if the archive or one of its arrays is
// broken, or if a name occurs twice.
[[nodiscard]] bool ReadNumpyArchive(
    const std::string& path, const std::string& content,
    const std::function<bool(const std::string&)>& wanted, NumpyArrays* arrays,
    std::set<std::string>* others, std::string* error);

}  // namespace pinode

#endif  // PINODE_BASE_ARRAYS_NUMPY_ARCHIVE_H_
