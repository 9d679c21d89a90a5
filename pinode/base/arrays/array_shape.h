// Functions shared by the readers of arrays. Not meant for other layers.

#ifndef PINODE_BASE_ARRAYS_ARRAY_SHAPE_H_
#define PINODE_BASE_ARRAYS_ARRAY_SHAPE_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pinode/base/arrays/array_files.h"

namespace pinode {

using ArrayFilter = std::function<bool(const std::string&)>;

// Sets samples and columns from the array's dimensions, or sets its fault.
// Number (sample, column) is at sample * *sample_stride + column *
// *column_stride of the array's numbers. `by_rows` is true if the last
// dimension changes fastest.
bool ShapeArray(const std::vector<int64_t>& dimensions, bool by_rows,
                NamedArray* array, int64_t* sample_stride,
                int64_t* column_stride);

// Each function does what ReadArrayFile does, for one format.
[[nodiscard]] bool ReadNumpyArrays(const std::string& path,
                                   const ArrayFilter& wanted,
                                   std::vector<NamedArray>* arrays,
                                   std::string* error);
[[nodiscard]] bool ReadMatlabArrays(const std::string& path,
                                    const ArrayFilter& wanted,
                                    std::vector<NamedArray>* arrays,
                                    std::string* error);
[[nodiscard]] bool ReadHdf5Arrays(const std::string& path,
                                  const ArrayFilter& wanted,
                                  std::vector<NamedArray>* arrays,
                                  std::string* error);

}  // namespace pinode

#endif  // PINODE_BASE_ARRAYS_ARRAY_SHAPE_H_
