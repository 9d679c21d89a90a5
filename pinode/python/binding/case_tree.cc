#include "pinode/python/binding/case_tree.h"

#include <cstdint>
#include <memory>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pinode/python/binding/convert.h"

namespace pinode::python {
namespace {

namespace py = pybind11;

// Largest depth, more than any case has; it detects objects that contain
// themselves.
constexpr int kDeepest = 32;

std::string TextOf(const py::handle& value, const std::string& where) {
  const py::object text = py::reinterpret_steal<py::object>(
      PyUnicode_AsEncodedString(value.ptr(), "utf-8", "strict"));
  if (!text) {
    PyErr_Clear();
    throw Error(where + " is a text that has no UTF-8, expected another one");
  }
  std::string result = text.cast<std::string>();
  if (result.find('\0') != std::string::npos) {
    throw Error(where + " is a text with a zero byte, expected another one");
  }
  return result;
}

std::int64_t IntegerOf(const py::handle& value, const std::string& where) {
  const py::object number =
      py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  const long long result = number ? PyLong_AsLongLong(number.ptr()) : -1;
  if (result == -1 && PyErr_Occurred() != nullptr) {
    PyErr_Clear();
    throw Error(where +
                " is a whole number beyond 64 bits, expected a smaller "
                "one");
  }
  return result;
}

bool IsArray(const py::handle& value) {
  return py::isinstance<py::array>(value);
}

// Converts a dictionary in place of a record's file.
Table TableOf(const py::dict& columns, const std::string& where,
              const std::string& name) {
  if (columns.empty()) {
    throw Error(where + " has no columns, expected {name: values, ...}");
  }
  Table table;
  table.path = name;
  for (const auto& [key, column] : columns) {
    if (!py::isinstance<py::str>(key)) {
      throw Error(where + " has a column whose name is not text");
    }
    table.columns.push_back(TextOf(key, where));
    const VectorView view(column,
                          where + ", column '" + table.columns.back() + "',");
    const VectorView::Map values = view.values();
    if (table.columns.size() == 1) {
      table.values.resize(values.size(),
                          static_cast<Eigen::Index>(columns.size()));
    }
    if (values.size() != table.values.rows()) {
      throw Error(where + ": column '" + table.columns.back() + "' has " +
                  std::to_string(values.size()) + " values, expected " +
                  std::to_string(table.values.rows()) + " as '" +
                  table.columns.front() + "' has");
    }
    table.values.col(static_cast<Eigen::Index>(table.columns.size()) - 1) =
        values;
  }
  if (table.values.rows() == 0) {
    throw Error(where + " has no rows, expected a time history");
  }
  table.line_numbers.resize(static_cast<size_t>(table.values.rows()));
  std::iota(table.line_numbers.begin(), table.line_numbers.end(), int64_t{1});
  return table;
}

class TreeReader {
 public:
  explicit TreeReader(CaseData* data) : data_(data) {}

  TomlValue Read(const py::handle& value, const std::string& where,
                 const std::string& parent, const std::string& key, int depth) {
    if (depth > kDeepest) {
      throw Error(where + " is nested too deeply, expected what a case has");
    }
    if (py::isinstance<py::bool_>(value)) {
      return TomlValue::Boolean(value.ptr() == Py_True);
    }
    if (py::isinstance<py::str>(value)) {
      return TomlValue::String(TextOf(value, where));
    }
    // Some of SciPy's sparse arrays are dictionaries too.
    if (py::isinstance<py::dict>(value) && !IsSparse(value)) {
      const auto dict = py::reinterpret_borrow<py::dict>(value);
      return key == "file" ? ReadFile(dict, where)
                           : ReadTable(dict, where, key, depth);
    }
    if (IsMatrix(value, key)) return ReadMatrix(value, where, parent, key);
    if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
      return ReadSequence(value, where, parent, key, depth);
    }
    if (py::isinstance<py::float_>(value)) {
      return TomlValue::Float(PyFloat_AsDouble(value.ptr()));
    }
    if (IsArray(value) || py::hasattr(value, "dtype")) {
      return ReadArray(value, where, parent, key, depth);
    }
    if (PyIndex_Check(value.ptr()) != 0) {
      return TomlValue::Integer(IntegerOf(value, where));
    }
    if (py::hasattr(value, "__fspath__")) {
      const py::object path =
          py::reinterpret_steal<py::object>(PyOS_FSPath(value.ptr()));
      if (path && py::isinstance<py::str>(path)) {
        return TomlValue::String(TextOf(path, where));
      }
      PyErr_Clear();
    }
    throw Error(where + " is a value of type " + TypeName(value) +
                ", expected a number, a text, a list, a dictionary or an "
                "array");
  }

 private:
  static std::string TypeName(const py::handle& value) {
    return py::str(py::type::handle_of(value).attr("__name__"));
  }

  // True if the value takes the place of a matrix file.
  static bool IsMatrix(const py::handle& value, const std::string& key) {
    static const std::set<std::string>& keys = *new std::set<std::string>{
        "mass",       "stiffness",      "damping",         "matrix",
        "set_export", "changed_export", "shape_covariance"};
    // Rows in a list are read as in a case file.
    return IsSparse(value) || (IsArray(value) && keys.count(key) > 0);
  }

  TomlValue ReadMatrix(const py::handle& value, const std::string& where,
                       const std::string& parent, const std::string& key) {
    const std::string name = "<" + where + ">";
    if (parent == "finite_element" || key == "set_export" ||
        key == "changed_export") {
      data_->sparse_matrices[name] =
          std::make_shared<const SparseMatrix>(ToSparse(value, where));
    } else {
      data_->matrices[name] = ToMatrix(value, where);
    }
    return TomlValue::String(name);
  }

  TomlValue ReadFile(const py::dict& columns, const std::string& where) {
    const std::string name = "<" + where + ">";
    data_->tables[name] = TableOf(columns, where, name);
    return TomlValue::String(name);
  }

  TomlValue ReadTable(const py::dict& dict, const std::string& where,
                      const std::string& key, int depth) {
    TomlValue table = TomlValue::Table();
    for (const auto& [name, entry] : dict) {
      if (!py::isinstance<py::str>(name)) {
        throw Error((where.empty() ? "the case" : where) +
                    " has a key of type " + TypeName(name) +
                    ", expected texts");
      }
      if (entry.is_none()) continue;
      const std::string text =
          TextOf(name, where.empty() ? "a key of the case" : where);
      table.Set(text, Read(entry, where.empty() ? text : where + "." + text,
                           key, text, depth + 1));
    }
    return table;
  }

  TomlValue ReadSequence(const py::handle& value, const std::string& where,
                         const std::string& parent, const std::string& key,
                         int depth) {
    std::vector<TomlValue> elements;
    for (const py::handle& element : value) {
      const std::string place =
          where + "[" + std::to_string(elements.size()) + "]";
      if (element.is_none()) {
        throw Error(place + " is None, expected a value");
      }
      elements.push_back(Read(element, place, parent, key, depth + 1));
    }
    return TomlValue::Array(std::move(elements));
  }

  // Reads NumPy's numbers and arrays of them.
  TomlValue ReadArray(const py::handle& value, const std::string& where,
                      const std::string& parent, const std::string& key,
                      int depth) {
    const py::array array = py::array::ensure(Unmasked(value));
    if (!array) {
      PyErr_Clear();
      throw Error(where + " cannot be read, expected an array of numbers");
    }
    const char kind = array.dtype().kind();
    if (std::string("biufUS").find(kind) == std::string::npos) {
      throw Error(where + " has entries of type " +
                  std::string(py::str(array.dtype())) +
                  ", expected numbers or texts");
    }
    const py::object plain = array.attr("tolist")();
    return Read(plain, where, parent, key, depth + 1);
  }

  CaseData* data_;
};

class TreeWriter {
 public:
  explicit TreeWriter(const CaseData& data) : data_(data) {}

  py::object Write(const TomlValue& value) const {
    switch (value.type) {
      case TomlValue::Type::kString:
        return WriteText(value.text);
      case TomlValue::Type::kInteger:
        return py::int_(value.integer);
      case TomlValue::Type::kFloat:
        return py::float_(value.number);
      case TomlValue::Type::kBoolean:
        return py::bool_(value.boolean);
      case TomlValue::Type::kArray: {
        py::list list;
        for (const TomlValue& element : value.elements) {
          list.append(Write(element));
        }
        return std::move(list);
      }
      case TomlValue::Type::kTable:
      case TomlValue::Type::kDate:
        break;
    }
    py::dict dict;
    for (const auto& [key, entry] : value.entries) {
      dict[py::str(key)] = Write(entry);
    }
    return std::move(dict);
  }

 private:
  py::object WriteText(const std::string& text) const {
    const auto table = data_.tables.find(text);
    if (table != data_.tables.end()) {
      py::dict columns;
      for (size_t i = 0; i < table->second.columns.size(); ++i) {
        columns[py::str(table->second.columns[i])] =
            FromVector(table->second.values.col(static_cast<Eigen::Index>(i)));
      }
      return std::move(columns);
    }
    const auto matrix = data_.matrices.find(text);
    if (matrix != data_.matrices.end()) return FromMatrix(matrix->second);
    const auto sparse = data_.sparse_matrices.find(text);
    if (sparse != data_.sparse_matrices.end()) {
      const SparseMatrix& array = *sparse->second;
      return py::module_::import("scipy.sparse")
          .attr("csc_matrix")(
              FromSparse(array),
              py::arg("shape") = py::make_tuple(array.rows(), array.cols()));
    }
    return py::str(text);
  }

  const CaseData& data_;
};

}  // namespace

TomlValue TreeFromPython(const py::handle& tree, CaseData* data) {
  if (!py::isinstance<py::dict>(tree)) {
    throw Error(
        "the case is not a dictionary, expected one with the keys of a case "
        "file");
  }
  return TreeReader(data).Read(tree, "", "", "", 0);
}

py::object TreeToPython(const TomlValue& tree, const CaseData& data) {
  return TreeWriter(data).Write(tree);
}

}  // namespace pinode::python
