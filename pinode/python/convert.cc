#include "pinode/python/convert.h"

#include <cmath>
#include <limits>
#include <utility>

#include "pinode/base/file.h"

namespace pinode::python {
namespace {

namespace py = pybind11;

using Dense = py::array_t<double, py::array::forcecast>;
using InColumns =
    py::array_t<double, py::array::f_style | py::array::forcecast>;

std::string TypeName(const py::handle& value) {
  return py::str(py::type::handle_of(value).attr("__name__"));
}

std::string ShapeText(const py::array& array) {
  std::string text;
  for (py::ssize_t i = 0; i < array.ndim(); ++i) {
    text += (i > 0 ? " x " : "") + std::to_string(array.shape(i));
  }
  return array.ndim() == 0 ? "a single number" : text;
}

// Whether Eigen can look at the entries where they are.
bool HasUsualStrides(const Dense& array) {
  for (py::ssize_t i = 0; i < array.ndim(); ++i) {
    const py::ssize_t stride = array.strides(i);
    if (stride < 0 || stride % static_cast<py::ssize_t>(sizeof(double)) != 0) {
      return false;
    }
  }
  return true;
}

Eigen::Index StrideOf(const Dense& array, py::ssize_t dimension) {
  return array.strides(dimension) / static_cast<py::ssize_t>(sizeof(double));
}

// Numbers of as many dimensions as asked for; the caller's own where they are
// doubles with strides that Eigen takes.
Dense ToDense(const py::handle& value, int dimensions,
              const std::string& where) {
  py::object source = py::reinterpret_borrow<py::object>(value);
  const std::string expected = dimensions == 1
                                   ? "a one-dimensional array of numbers"
                                   : "a two-dimensional array of numbers";
  // Of NumPy's masked arrays.
  if (py::hasattr(source, "filled")) {
    source = source.attr("astype")("float64").attr("filled")(
        std::numeric_limits<double>::quiet_NaN());
  }
  const py::array array = py::array::ensure(source);
  if (!array) {
    PyErr_Clear();
    throw Error(where + " is a value of type " + TypeName(value) +
                ", expected " + expected);
  }
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u') {
    throw Error(where + " has entries of type " +
                std::string(py::str(array.dtype())) + ", expected " + expected);
  }
  if (array.ndim() != dimensions) {
    throw Error(where + " is " + ShapeText(array) + ", expected " + expected);
  }
  Dense dense = Dense::ensure(array);
  if (dense && !HasUsualStrides(dense)) dense = InColumns::ensure(array);
  if (!dense) {
    PyErr_Clear();
    throw Error(where + " cannot be read, expected " + expected);
  }
  return dense;
}

SparseMatrix FromCompressed(const py::object& columns,
                            const std::string& where) {
  const Vector data = ToVector(columns.attr("data"), where + ".data");
  const auto rows = py::array_t<std::int64_t, py::array::forcecast>::ensure(
      columns.attr("indices"));
  const auto starts = py::array_t<std::int64_t, py::array::forcecast>::ensure(
      columns.attr("indptr"));
  const py::tuple shape = columns.attr("shape");
  const auto num_rows = shape[0].cast<std::int64_t>();
  const auto num_columns = shape[1].cast<std::int64_t>();
  const std::string broken = where + " is no consistent sparse matrix";
  if (!rows || !starts || rows.ndim() != 1 || starts.ndim() != 1) {
    PyErr_Clear();
    throw Error(broken);
  }
  if (num_rows > kMaxFiniteElementDofs || num_columns > kMaxFiniteElementDofs) {
    throw Error(where + " is " + std::to_string(num_rows) + " x " +
                std::to_string(num_columns) + ", expected at most " +
                std::to_string(kMaxFiniteElementDofs) + " rows");
  }
  if (starts.size() != num_columns + 1 || starts.at(0) != 0 ||
      rows.size() < starts.at(num_columns) ||
      data.size() < starts.at(num_columns)) {
    throw Error(broken);
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (std::int64_t j = 0; j < num_columns; ++j) {
    if (starts.at(j + 1) < starts.at(j) ||
        starts.at(j + 1) > starts.at(num_columns)) {
      throw Error(broken);
    }
    for (std::int64_t k = starts.at(j); k < starts.at(j + 1); ++k) {
      const std::int64_t i = rows.at(k);
      if (i < 0 || i >= num_rows) throw Error(broken);
      entries.emplace_back(static_cast<int>(i), static_cast<int>(j), data[k]);
    }
  }
  SparseMatrix matrix(num_rows, num_columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

std::string Error::Readable(std::string sentence) {
  for (size_t at = FirstInvalidUtf8(sentence); at != std::string::npos;
       at = FirstInvalidUtf8(sentence)) {
    sentence[at] = '?';
  }
  // Of what was passed, in a name or a path.
  for (const auto& [letter, shown] :
       {std::pair('\0', "\\0"), std::pair('\n', "\\n")}) {
    for (size_t at = sentence.find(letter); at != std::string::npos;
         at = sentence.find(letter, at)) {
      sentence.replace(at, 1, shown);
    }
  }
  return sentence;
}

Vector ToVector(const py::handle& value, const std::string& where) {
  const Dense dense = ToDense(value, 1, where);
  return Eigen::Map<const Vector, 0, Eigen::InnerStride<>>(
      dense.data(), dense.size(), Eigen::InnerStride<>(StrideOf(dense, 0)));
}

Matrix ToMatrix(const py::handle& value, const std::string& where) {
  // No matrix of the states of an identification is larger.
  constexpr double kMost = 1e8;
  py::object source = py::reinterpret_borrow<py::object>(value);
  if (IsSparse(value)) {
    const SparseMatrix sparse = ToSparse(value, where);
    if (static_cast<double>(sparse.rows()) *
            static_cast<double>(sparse.cols()) >
        kMost) {
      throw Error(where + " is " + std::to_string(sparse.rows()) + " x " +
                  std::to_string(sparse.cols()) +
                  ", which is too large for a full matrix");
    }
    return sparse;
  }
  const Dense dense = ToDense(source, 2, where);
  return Eigen::Map<const Matrix, 0,
                    Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>(
      dense.data(), dense.shape(0), dense.shape(1),
      Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>(StrideOf(dense, 1),
                                                    StrideOf(dense, 0)));
}

bool IsSparse(const py::handle& value) { return py::hasattr(value, "tocsc"); }

SparseMatrix ToSparse(const py::handle& value, const std::string& where) {
  if (!IsSparse(value)) return ToMatrix(value, where).sparseView(0.0, 0.0);
  py::object columns;
  try {
    columns = value.attr("tocsc")();
    // Of objects that only look like it.
    for (const char* name : {"data", "indices", "indptr", "shape"}) {
      columns.attr(name);
    }
  } catch (const py::error_already_set& failure) {
    throw Error(where +
                " cannot be read as a sparse matrix: " + failure.what());
  }
  return FromCompressed(columns, where);
}

py::array_t<double> FromVector(const Vector& vector) {
  return py::array_t<double>(vector.size(), vector.data());
}

py::array_t<double> FromMatrix(const Matrix& matrix) {
  return py::array_t<double>(
      {matrix.rows(), matrix.cols()},
      {sizeof(double), sizeof(double) * static_cast<size_t>(matrix.rows())},
      matrix.data());
}

py::array View(const Matrix& matrix, const py::handle& owner) {
  py::array view(
      py::dtype::of<double>(), {matrix.rows(), matrix.cols()},
      {sizeof(double), sizeof(double) * static_cast<size_t>(matrix.rows())},
      matrix.data(), owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

py::array View(const Vector& vector, const py::handle& owner) {
  py::array view(py::dtype::of<double>(), {vector.size()}, {sizeof(double)},
                 vector.data(), owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

py::tuple FromSparse(const SparseMatrix& matrix) {
  SparseMatrix compressed = matrix;
  compressed.makeCompressed();
  return py::make_tuple(
      py::array_t<double>(compressed.nonZeros(), compressed.valuePtr()),
      py::array_t<int>(compressed.nonZeros(), compressed.innerIndexPtr()),
      py::array_t<int>(compressed.cols() + 1, compressed.outerIndexPtr()));
}

}  // namespace pinode::python
