#include "pinode/python/binding/convert.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>

#include "pinode/base/file.h"

namespace pinode::python {
namespace {

namespace py = pybind11;

using Dense = py::array_t<double, py::array::forcecast>;
using InColumns =
    py::array_t<double, py::array::f_style | py::array::forcecast>;

using InOneRow = py::array_t<double, py::array::c_style | py::array::forcecast>;

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

// True if Eigen can use the entries in place.
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

// Returns an array of numbers with so many dimensions. It is the caller's own
// if that has doubles with strides that Eigen accepts.
Dense ToDense(const py::handle& value, int dimensions,
              const std::string& where) {
  const std::string expected = dimensions == 1
                                   ? "a one-dimensional array of numbers"
                                   : "a two-dimensional array of numbers";
  const py::array array = py::array::ensure(Unmasked(value));
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

// Returns an attribute of an object as an array of NumPy; entries of this type
// are not copied.
template <typename Index>
py::array_t<Index> IndicesOf(const py::object& columns, const char* name,
                             const std::string& broken) {
  const auto indices =
      py::array_t<Index, py::array::c_style | py::array::forcecast>::ensure(
          columns.attr(name));
  if (!indices || indices.ndim() != 1) {
    PyErr_Clear();
    throw Error(broken);
  }
  return indices;
}

// Checks the indices. Throws Error(broken) unless the columns begin and end
// within the `size` entries, and all rows are rows of the matrix. Returns true
// if the entries of each column have ascending rows, as Eigen's have.
template <typename Index>
bool IsInOrder(const py::array_t<Index>& rows, const py::array_t<Index>& starts,
               std::int64_t num_rows, std::int64_t size,
               const std::string& broken) {
  const std::int64_t num_columns = starts.size() - 1;
  const Index* start = starts.data();
  const Index* row = rows.data();
  if (start[0] != 0 || start[num_columns] > size) throw Error(broken);
  bool in_order = true;
  for (std::int64_t j = 0; j < num_columns; ++j) {
    if (start[j + 1] < start[j] || start[j + 1] > start[num_columns]) {
      throw Error(broken);
    }
    for (Index k = start[j]; k < start[j + 1]; ++k) {
      if (row[k] < 0 || row[k] >= num_rows) throw Error(broken);
      if (k > start[j] && row[k] <= row[k - 1]) in_order = false;
    }
  }
  return in_order;
}

template <typename Index>
SparseMatrix FromIndices(const py::object& columns, const InOneRow& data,
                         std::int64_t num_rows, std::int64_t num_columns,
                         const std::string& broken) {
  const auto rows = IndicesOf<Index>(columns, "indices", broken);
  const auto starts = IndicesOf<Index>(columns, "indptr", broken);
  if (starts.size() != num_columns + 1) throw Error(broken);
  const std::int64_t size = std::min<std::int64_t>(rows.size(), data.size());
  const bool in_order = IsInOrder(rows, starts, num_rows, size, broken);
  if constexpr (std::is_same_v<Index, int>) {
    if (in_order) {
      return Eigen::Map<const SparseMatrix>(
          num_rows, num_columns, starts.at(num_columns), starts.data(),
          rows.data(), data.data());
    }
  }
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<size_t>(starts.at(num_columns)));
  for (std::int64_t j = 0; j < num_columns; ++j) {
    for (Index k = starts.at(j); k < starts.at(j + 1); ++k) {
      entries.emplace_back(static_cast<int>(rows.at(k)), static_cast<int>(j),
                           data.at(k));
    }
  }
  SparseMatrix matrix(num_rows, num_columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

SparseMatrix FromCompressed(const py::object& columns,
                            const std::string& where) {
  const py::tuple shape = columns.attr("shape");
  const auto num_rows = shape[0].cast<std::int64_t>();
  const auto num_columns = shape[1].cast<std::int64_t>();
  if (num_rows > kMaxFiniteElementDofs || num_columns > kMaxFiniteElementDofs) {
    throw Error(where + " is " + std::to_string(num_rows) + " x " +
                std::to_string(num_columns) + ", expected at most " +
                std::to_string(kMaxFiniteElementDofs) + " rows");
  }
  const std::string broken = where + " is not a consistent sparse matrix";
  const InOneRow data =
      InOneRow::ensure(ToDense(columns.attr("data"), 1, where + ".data"));
  if (!data) {
    PyErr_Clear();
    throw Error(broken);
  }
  const auto is_int = [&](const char* name) {
    return py::isinstance<py::array_t<int>>(columns.attr(name));
  };
  return is_int("indices") && is_int("indptr")
             ? FromIndices<int>(columns, data, num_rows, num_columns, broken)
             : FromIndices<std::int64_t>(columns, data, num_rows, num_columns,
                                         broken);
}

// Keeps `kept` alive while an array uses its data.
template <typename Kept>
py::capsule Keep(Kept* kept) {
  return py::capsule(kept, [](void* old) { delete static_cast<Kept*>(old); });
}

}  // namespace

std::string Error::Readable(std::string sentence) {
  for (size_t at = FirstInvalidUtf8(sentence); at != std::string::npos;
       at = FirstInvalidUtf8(sentence)) {
    sentence[at] = '?';
  }
  // Characters from names or paths of the caller.
  for (const auto& [letter, shown] :
       {std::pair('\0', "\\0"), std::pair('\n', "\\n")}) {
    for (size_t at = sentence.find(letter); at != std::string::npos;
         at = sentence.find(letter, at)) {
      sentence.replace(at, 1, shown);
    }
  }
  return sentence;
}

VectorView::VectorView(const py::handle& value, const std::string& where)
    : array_(ToDense(value, 1, where)) {}

VectorView::Map VectorView::values() const {
  return Map(array_.data(), array_.size(),
             Eigen::InnerStride<>(StrideOf(array_, 0)));
}

Vector ToVector(const py::handle& value, const std::string& where) {
  return VectorView(value, where).values();
}

Matrix ToMatrix(const py::handle& value, const std::string& where) {
  // Largest size; no matrix of the states of an identification is larger.
  constexpr double kMost = 1e8;
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
  const Dense dense = ToDense(value, 2, where);
  return Eigen::Map<const Matrix, 0,
                    Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>(
      dense.data(), dense.shape(0), dense.shape(1),
      Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>(StrideOf(dense, 1),
                                                    StrideOf(dense, 0)));
}

py::object Unmasked(const py::handle& value) {
  if (py::isinstance<py::array>(value) && py::hasattr(value, "filled")) {
    const char kind = py::reinterpret_borrow<py::array>(value).dtype().kind();
    if (kind == 'f' || kind == 'i' || kind == 'u') {
      return value.attr("astype")("float64").attr("filled")(
          std::numeric_limits<double>::quiet_NaN());
    }
  }
  return py::reinterpret_borrow<py::object>(value);
}

bool IsSparse(const py::handle& value) { return py::hasattr(value, "tocsc"); }

SparseMatrix ToSparse(const py::handle& value, const std::string& where) {
  if (!IsSparse(value)) return ToMatrix(value, where).sparseView(0.0, 0.0);
  py::object columns;
  try {
    columns = value.attr("tocsc")();
    // Rejects objects that only resemble a sparse array.
    for (const char* name : {"data", "indices", "indptr", "shape"}) {
      columns.attr(name);
    }
  } catch (const py::error_already_set& failure) {
    throw Error(where +
                " cannot be read as a sparse matrix: " + failure.what());
  }
  return FromCompressed(columns, where);
}

py::array_t<double> FromVector(Vector vector) {
  auto kept = std::make_unique<Vector>(std::move(vector));
  const Vector& values = *kept;
  return py::array_t<double>(values.size(), values.data(),
                             Keep(kept.release()));
}

py::array_t<double> FromMatrix(Matrix matrix) {
  auto kept = std::make_unique<Matrix>(std::move(matrix));
  const Matrix& values = *kept;
  return py::array_t<double>(
      {values.rows(), values.cols()},
      {sizeof(double), sizeof(double) * static_cast<size_t>(values.rows())},
      values.data(), Keep(kept.release()));
}

py::array View(const Matrix& matrix, const py::handle& owner) {
  py::array view(
      py::dtype::of<double>(), {matrix.rows(), matrix.cols()},
      {sizeof(double), sizeof(double) * static_cast<size_t>(matrix.rows())},
      matrix.data(), owner);
  return ReadOnly(std::move(view));
}

py::array View(const Vector& vector, const py::handle& owner) {
  return ReadOnly(py::array(py::dtype::of<double>(), {vector.size()},
                            {sizeof(double)}, vector.data(), owner));
}

py::array ReadOnly(py::array array) {
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

py::tuple FromSparse(const SparseMatrix& matrix) {
  if (!matrix.isCompressed()) {
    SparseMatrix compressed = matrix;
    compressed.makeCompressed();
    return FromSparse(compressed);
  }
  return py::make_tuple(
      py::array_t<double>(matrix.nonZeros(), matrix.valuePtr()),
      py::array_t<int>(matrix.nonZeros(), matrix.innerIndexPtr()),
      py::array_t<int>(matrix.cols() + 1, matrix.outerIndexPtr()));
}

}  // namespace pinode::python
