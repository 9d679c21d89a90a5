// NumPy's own array format (numpy.lib.format, NEP 1), one array a file.

#ifndef PINODE_BASE_ARRAYS_NUMPY_ARRAY_H_
#define PINODE_BASE_ARRAYS_NUMPY_ARRAY_H_

#include <cstdint>
#include <string>
#include <vector>

namespace pinode {

// One array: what its header says of it, and its bytes as they stand.
struct NumpyArray {
  char kind = 0;  // 'f', 'i', 'u', 'b' (numbers), 'S' or 'U' (text)
  size_t item_size = 0;
  bool swapped = false;
  bool fortran_order = false;
  std::vector<int64_t> shape;
  std::string data;

  // Checked against the shape when the array was parsed.
  int64_t size() const { return static_cast<int64_t>(data.size() / item_size); }
  bool is_number() const {
    return kind == 'f' || kind == 'i' || kind == 'u' || kind == 'b';
  }
  bool is_integer() const { return kind == 'i' || kind == 'u'; }
  // Of one dimension.
  bool is_vector() const { return shape.size() == 1; }

  // Number `index` in the order of the file.
  double NumberAt(int64_t index) const;
  // An integer that may serve as an index or a size; -1 if it is none.
  int64_t IndexAt(int64_t index) const;
  // Text `index` of an array of texts in UTF-8, without the zeros that fill it.
  std::string TextAt(int64_t index) const;
};

// What a file is good for: kOther is an array of a type that has no use here
// (complex numbers, pickled objects).
enum class NumpyArrayKind { kUsable, kOther, kBroken };

// Versions 1 to 3 of the format, numbers of any real type and byte order, and
// text. Where it is broken, *what continues the sentence "array 'x' ...".
NumpyArrayKind ParseNumpyArray(const std::string& bytes, NumpyArray* array,
                               std::string* what);

}  // namespace pinode

#endif  // PINODE_BASE_ARRAYS_NUMPY_ARRAY_H_
