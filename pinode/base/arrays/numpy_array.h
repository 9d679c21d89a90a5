// NumPy's own array format (numpy.lib.format, NEP 1), one array per file.

#ifndef PINODE_BASE_ARRAYS_NUMPY_ARRAY_H_
#define PINODE_BASE_ARRAYS_NUMPY_ARRAY_H_

#include <cstdint>
#include <string>
#include <vector>

namespace pinode {

// One array: the facts from its header, and its bytes as in the file.
struct NumpyArray {
  char kind = 0;  // 'f', 'i', 'u', 'b' (numbers), 'S' or 'U' (text)
  size_t item_size = 0;
  bool swapped = false;
  bool fortran_order = false;
  std::vector<int64_t> shape;
  std::string data;

  // Number of items. The parser has checked it against the shape.
  int64_t size() const { return static_cast<int64_t>(data.size() / item_size); }
  bool is_number() const {
    return kind == 'f' || kind == 'i' || kind == 'u' || kind == 'b';
  }
  bool is_integer() const { return kind == 'i' || kind == 'u'; }
  // Returns true if the array has one dimension.
  bool is_vector() const { return shape.size() == 1; }

  // Returns number `index` in the order of the file.
  double NumberAt(int64_t index) const;
  // Returns an integer that can serve as an index or a size, or -1 if the item
  // is not such an integer.
  int64_t IndexAt(int64_t index) const;
  // Returns text `index` of an array of texts in UTF-8, without the zeros that
  // pad it.
  std::string TextAt(int64_t index) const;
};

// Result of parsing an array. kOther is an array of a type that is not
// supported here (complex numbers, pickled objects).
enum class NumpyArrayKind { kUsable, kOther, kBroken };

// Parses an array of format version 1 to 3: numbers of any real type and byte
// order, or text. If the array is broken, *what continues the sentence "array
// 'x' ...".
NumpyArrayKind ParseNumpyArray(std::string bytes, NumpyArray* array,
                               std::string* what);

// Bytes at the beginning of a file that hold any usual header.
inline constexpr size_t kNumpyHeaderBytes = 65536;

// Parses the header alone. `bytes` are the first kNumpyHeaderBytes of the file
// or more, or all of it. The array gets no data.
NumpyArrayKind ParseNumpyHeader(const std::string& bytes, NumpyArray* array,
                                std::string* what);

}  // namespace pinode

#endif  // PINODE_BASE_ARRAYS_NUMPY_ARRAY_H_
