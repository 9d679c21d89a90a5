// Between Python's values and those of the library.

#ifndef PINODE_PYTHON_BINDING_CONVERT_H_
#define PINODE_PYTHON_BINDING_CONVERT_H_

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <stdexcept>
#include <string>

#include "pinode/base/types.h"
#include "pinode/structure/sparse/finite_element_model.h"

namespace pinode::python {

// pinode.Error of Python, a ValueError: one sentence.
class Error : public std::runtime_error {
 public:
  // What Python passes may have zero bytes, at which the sentence would end,
  // and what is not UTF-8 would leave nothing of it.
  explicit Error(const std::string& sentence)
      : std::runtime_error(Readable(sentence)) {}

 private:
  static std::string Readable(std::string sentence);
};

// Throws *error where a function of the library has failed.
inline void Require(bool ok, const std::string& error) {
  if (!ok) throw Error(error);
}

// A value that cannot be a T is an Error.
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

// Arrays of NumPy with numbers; `where` is what messages call the value. Real
// numbers only; masked entries become NaN.
Vector ToVector(const pybind11::handle& value, const std::string& where);
// What ToVector copies, where it is.
class VectorView {
 public:
  using Map = Eigen::Map<const Vector, 0, Eigen::InnerStride<>>;

  VectorView(const pybind11::handle& value, const std::string& where);
  Map values() const;

 private:
  pybind11::array_t<double, pybind11::array::forcecast> array_;
};
Matrix ToMatrix(const pybind11::handle& value, const std::string& where);
// Of a full array, or of one of SciPy's sparse ones.
SparseMatrix ToSparse(const pybind11::handle& value, const std::string& where);
bool IsSparse(const pybind11::handle& value);
// A masked array as one with NaN in place of what is masked, where its entries
// are real numbers; any other value as it is.
pybind11::object Unmasked(const pybind11::handle& value);

// Arrays of NumPy that own the numbers: those of a temporary are not copied.
pybind11::array_t<double> FromVector(Vector vector);
pybind11::array_t<double> FromMatrix(Matrix matrix);
// One that looks at the numbers of `matrix`, for as long as `owner` lives, and
// cannot be written to.
pybind11::array View(const Matrix& matrix, const pybind11::handle& owner);
pybind11::array View(const Vector& vector, const pybind11::handle& owner);
// An array that cannot be written to either.
pybind11::array ReadOnly(pybind11::array array);
// (data, row indices, column pointers), as scipy.sparse.csc_array takes them.
pybind11::tuple FromSparse(const SparseMatrix& matrix);

}  // namespace pinode::python

#endif  // PINODE_PYTHON_BINDING_CONVERT_H_
