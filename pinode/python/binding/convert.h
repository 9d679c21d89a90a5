// Conversion between Python's values and those of the library.

#ifndef PINODE_PYTHON_BINDING_CONVERT_H_
#define PINODE_PYTHON_BINDING_CONVERT_H_

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <stdexcept>
#include <string>

#include "pinode/base/types.h"
#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode::python {

// pinode.Error of Python, a ValueError with one sentence.
class Error : public std::runtime_error {
 public:
  // Makes the sentence readable. Text from Python may have zero bytes, which
  // would end the sentence, or may not be UTF-8, which would lose all of it.
  explicit Error(const std::string& sentence)
      : std::runtime_error(Readable(sentence)) {}

 private:
  static std::string Readable(std::string sentence);
};

// Throws *error if a function of the library has failed.
inline void Require(bool ok, const std::string& error) {
  if (!ok) throw Error(error);
}

// Converts a value; throws Error if it is not a T.
template <typename T>
T Cast(const pybind11::handle& value, const std::string& where,
       const std::string& expected) {
  try {
    return value.cast<T>();
  } catch (const pybind11::cast_error&) {
    throw Error(where + " is a value of type " +
                std::string(pybind11::str(
                    pybind11::type::handle_of(value).attr("__name__"))) +
                ", expected " + expected);
  }
}

// Convert arrays of NumPy with real numbers; `where` names the value in
// messages. Masked entries become NaN.
Vector ToVector(const pybind11::handle& value, const std::string& where);
// View of the values that ToVector would copy.
class VectorView {
 public:
  using Map = Eigen::Map<const Vector, 0, Eigen::InnerStride<>>;

  VectorView(const pybind11::handle& value, const std::string& where);
  Map values() const;

 private:
  pybind11::array_t<double, pybind11::array::forcecast> array_;
};
Matrix ToMatrix(const pybind11::handle& value, const std::string& where);
// Converts a full array, or a sparse one of SciPy.
SparseMatrix ToSparse(const pybind11::handle& value, const std::string& where);
bool IsSparse(const pybind11::handle& value);
// Returns a masked array of real numbers with NaN in place of masked entries,
// and any other value unchanged.
pybind11::object Unmasked(const pybind11::handle& value);

// Return arrays of NumPy that own the numbers: those of a temporary are not
// copied.
pybind11::array_t<double> FromVector(Vector vector);
pybind11::array_t<double> FromMatrix(Matrix matrix);
// Return read-only views of the numbers of `matrix` or `vector`, valid while
// `owner` lives.
pybind11::array View(const Matrix& matrix, const pybind11::handle& owner);
pybind11::array View(const Vector& vector, const pybind11::handle& owner);
// Returns a read-only array.
pybind11::array ReadOnly(pybind11::array array);
// Returns (data, row indices, column pointers), as scipy.sparse.csc_array takes
// them.
pybind11::tuple FromSparse(const SparseMatrix& matrix);

}  // namespace pinode::python

#endif  // PINODE_PYTHON_BINDING_CONVERT_H_
