#include "pinode/structure/npz.h"

#include <zip.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/matrix_text.h"

namespace pinode {
namespace {

// Larger members are refused: a full matrix of 10,000 DOFs has 0.8 GB.
constexpr size_t kLargestMember = size_t{4} << 30;

// One array: the text of its description and its bytes.
struct Array {
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
};

template <typename T>
T ItemAt(const Array& array, int64_t index) {
  char raw[sizeof(T)];
  std::memcpy(raw, array.data.data() + static_cast<size_t>(index) * sizeof(T),
              sizeof(T));
  if (array.swapped) std::reverse(raw, raw + sizeof(T));
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

// Number `index` in the order of the file.
double NumberAt(const Array& array, int64_t index) {
  switch (array.kind) {
    case 'f':
      return array.item_size == 4 ? ItemAt<float>(array, index)
                                  : ItemAt<double>(array, index);
    case 'i':
      switch (array.item_size) {
        case 1:
          return ItemAt<int8_t>(array, index);
        case 2:
          return ItemAt<int16_t>(array, index);
        case 4:
          return ItemAt<int32_t>(array, index);
        default:
          return static_cast<double>(ItemAt<int64_t>(array, index));
      }
    default:
      switch (array.item_size) {
        case 1:
          return ItemAt<uint8_t>(array, index);
        case 2:
          return ItemAt<uint16_t>(array, index);
        case 4:
          return ItemAt<uint32_t>(array, index);
        default:
          return static_cast<double>(ItemAt<uint64_t>(array, index));
      }
  }
}

// An integer that may serve as an index or a size; -1 if it is none.
int64_t IndexAt(const Array& array, int64_t index) {
  const double value = NumberAt(array, index);
  if (!(value >= 0.0 && value <= 1e15)) return -1;
  return static_cast<int64_t>(value);
}

void AppendUtf8(uint32_t code, std::string* text) {
  const auto byte = [text](uint32_t value) {
    text->push_back(static_cast<char>(value));
  };
  if (code < 0x80) {
    byte(code);
  } else if (code < 0x800) {
    byte(0xC0 | (code >> 6));
    byte(0x80 | (code & 0x3F));
  } else if (code < 0x10000) {
    byte(0xE0 | (code >> 12));
    byte(0x80 | ((code >> 6) & 0x3F));
    byte(0x80 | (code & 0x3F));
  } else {
    byte(0xF0 | (code >> 18));
    byte(0x80 | ((code >> 12) & 0x3F));
    byte(0x80 | ((code >> 6) & 0x3F));
    byte(0x80 | (code & 0x3F));
  }
}

// Text `index` of an array of texts, without the zeros that fill it.
std::string TextAt(const Array& array, int64_t index) {
  std::string text;
  if (array.kind == 'S') {
    text = array.data.substr(static_cast<size_t>(index) * array.item_size,
                             array.item_size);
  } else {
    const int64_t letters = static_cast<int64_t>(array.item_size) / 4;
    for (int64_t i = 0; i < letters; ++i) {
      const auto code = ItemAt<uint32_t>(array, index * letters + i);
      if (code > 0x10FFFF) return "";
      if (code == 0) break;
      AppendUtf8(code, &text);
    }
  }
  const size_t end = text.find_last_not_of('\0');
  text.resize(end == std::string::npos ? 0 : end + 1);
  return text;
}

// The header is a Python dictionary: {'descr': '<f8', 'fortran_order': False,
// 'shape': (3, 3), }. The text behind `'key':`, empty if there is none.
std::string_view ValueOf(std::string_view header, const std::string& key) {
  size_t at = header.find("'" + key + "'");
  if (at == std::string_view::npos) return {};
  at = header.find(':', at);
  if (at == std::string_view::npos) return {};
  return StripBlanks(header.substr(at + 1));
}

bool ParseType(std::string_view descr, Array* array) {
  if (descr.size() < 5 || descr[0] != '\'') return false;
  const size_t end = descr.find('\'', 1);
  if (end == std::string_view::npos) return false;
  descr = descr.substr(1, end - 1);
  if (descr.size() < 3) return false;
  const char order = descr[0];
  if (order != '<' && order != '>' && order != '|' && order != '=') {
    return false;
  }
  array->swapped = order == '>';
  array->kind = descr[1];
  int size = 0;
  if (!ParseInt(descr.substr(2), &size) || size < 1 || size > 100000) {
    return false;
  }
  array->item_size = static_cast<size_t>(size);
  switch (array->kind) {
    case 'f':
      return size == 4 || size == 8;
    case 'i':
    case 'u':
      return size == 1 || size == 2 || size == 4 || size == 8;
    case 'b':
      return size == 1;
    case 'S':
      return true;
    case 'U':
      array->item_size *= 4;
      return true;
    default:
      return false;
  }
}

bool ParseShape(std::string_view text, std::vector<int64_t>* shape) {
  if (text.empty() || text[0] != '(') return false;
  const size_t end = text.find(')');
  if (end == std::string_view::npos) return false;
  for (const std::string_view part : Split(text.substr(1, end - 1), ',')) {
    if (part.empty()) continue;  // (3,) and ()
    int length = 0;
    if (!ParseInt(part, &length) || length < 0) return false;
    shape->push_back(length);
  }
  return shape->size() <= 8;
}

// What a member of the archive is good for.
enum class ArrayKind { kUsable, kOther, kBroken };

// `what` says what is broken.
ArrayKind ParseArray(const std::string& bytes, Array* array,
                     std::string* what) {
  constexpr std::string_view kMagic = "\x93NUMPY";
  const std::string_view view = bytes;
  if (view.size() < 10 || view.substr(0, kMagic.size()) != kMagic) {
    *what = "is no NumPy array, and its first bytes were expected to say so";
    return ArrayKind::kBroken;
  }
  const auto byte_at = [&view](size_t i) {
    return static_cast<size_t>(static_cast<unsigned char>(view[i]));
  };
  const size_t version = byte_at(6);
  size_t begin = 10;
  size_t length = byte_at(8) + 256 * byte_at(9);
  if (version == 2 || version == 3) {
    if (view.size() < 12) {
      *what = "ends inside its header";
      return ArrayKind::kBroken;
    }
    begin = 12;
    length += 65536 * byte_at(10) + 16777216 * byte_at(11);
  } else if (version != 1) {
    *what = "has format version " + std::to_string(version) +
            ", and 1 to 3 was expected";
    return ArrayKind::kBroken;
  }
  if (length > view.size() - begin) {
    *what = "ends inside its header of " + std::to_string(length) + " bytes";
    return ArrayKind::kBroken;
  }
  const std::string_view header = view.substr(begin, length);
  const std::string_view order = ValueOf(header, "fortran_order");
  if (!ParseType(ValueOf(header, "descr"), array)) return ArrayKind::kOther;
  if ((order.substr(0, 4) != "True" && order.substr(0, 5) != "False") ||
      !ParseShape(ValueOf(header, "shape"), &array->shape)) {
    *what = "has the header " + Quote(header) +
            ", and descr, fortran_order and shape were expected";
    return ArrayKind::kBroken;
  }
  array->fortran_order = order[0] == 'T';
  const size_t available = view.size() - begin - length;
  // The product may be absurd; as a double it does not overflow.
  double expected = static_cast<double>(array->item_size);
  for (const int64_t size : array->shape) expected *= static_cast<double>(size);
  if (expected != static_cast<double>(available)) {
    *what = "has " + std::to_string(available) + " bytes of data, and " +
            FormatNumber(expected, 15) + " were expected by its header";
    return ArrayKind::kBroken;
  }
  array->data = bytes.substr(begin + length);
  return ArrayKind::kUsable;
}

struct ArchiveCloser {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
struct MemberCloser {
  void operator()(zip_file_t* member) const { zip_fclose(member); }
};

using Arrays = std::map<std::string, Array>;

std::string ZipMessage(zip_error_t* problem) {
  std::string message = zip_error_strerror(problem);
  zip_error_fini(problem);
  return message;
}

// Reads one member whole, whatever size the archive claims.
bool ReadMember(zip_t* archive, zip_uint64_t index, std::string* bytes,
                std::string* what) {
  const std::unique_ptr<zip_file_t, MemberCloser> member(
      zip_fopen_index(archive, index, 0));
  if (member == nullptr) {
    *what = std::string("cannot be unpacked: ") + zip_strerror(archive);
    return false;
  }
  std::vector<char> buffer(65536);
  for (;;) {
    const zip_int64_t count =
        zip_fread(member.get(), buffer.data(), buffer.size());
    if (count < 0) {
      *what =
          std::string("cannot be unpacked: ") + zip_file_strerror(member.get());
      return false;
    }
    if (count == 0) return true;
    bytes->append(buffer.data(), static_cast<size_t>(count));
    if (bytes->size() > kLargestMember) {
      *what = "is larger than the " + std::to_string(kLargestMember) +
              " bytes that were expected at most";
      return false;
    }
  }
}

bool ReadArrays(const std::string& path, const std::string& content,
                Arrays* arrays, std::set<std::string>* others,
                std::string* error) {
  zip_error_t problem;
  zip_error_init(&problem);
  zip_source_t* source = zip_source_buffer_create(
      content.data(), content.size(), /*freep=*/0, &problem);
  if (source == nullptr) {
    *error = path + ": " + ZipMessage(&problem);
    return false;
  }
  const std::unique_ptr<zip_t, ArchiveCloser> archive(
      zip_open_from_source(source, ZIP_RDONLY, &problem));
  if (archive == nullptr) {
    zip_source_free(source);
    *error = path + ": " + ZipMessage(&problem) +
             ", and a NumPy archive (zip) was expected";
    return false;
  }
  zip_error_fini(&problem);
  const zip_int64_t count = zip_get_num_entries(archive.get(), 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    const auto index = static_cast<zip_uint64_t>(i);
    const char* raw_name = zip_get_name(archive.get(), index, 0);
    std::string name = raw_name == nullptr ? "" : raw_name;
    constexpr std::string_view kExtension = ".npy";
    if (name.size() <= kExtension.size() ||
        name.substr(name.size() - kExtension.size()) != kExtension) {
      continue;
    }
    name.resize(name.size() - kExtension.size());
    std::string bytes;
    std::string what;
    Array array;
    ArrayKind kind = ArrayKind::kBroken;
    if (ReadMember(archive.get(), index, &bytes, &what)) {
      kind = ParseArray(bytes, &array, &what);
    }
    if (kind == ArrayKind::kBroken) {
      *error = path + ": array " + Quote(name) + " " + what;
      return false;
    }
    if (kind == ArrayKind::kOther) {
      others->insert(name);
    } else if (!arrays->emplace(name, std::move(array)).second) {
      *error = path + ": array " + Quote(name) +
               " is there twice, and each name was expected once";
      return false;
    }
  }
  return true;
}

// Parts of a sparse matrix, found by the names of its arrays.
struct SparseParts {
  const Array* data = nullptr;
  const Array* indices = nullptr;
  const Array* pointers = nullptr;  // null for COO
  const Array* columns = nullptr;   // COO only
  const Array* shape = nullptr;
  bool by_columns = false;  // CSC
};

bool IsVector(const Array* array, int64_t size) {
  return array->shape.size() == 1 && (size < 0 || array->size() == size);
}

// False with a sentence in *what that continues "array 'x' ...".
bool BuildSparse(const SparseParts& parts, SparseMatrix* matrix,
                 std::string* what) {
  if (!parts.shape->is_integer() || !IsVector(parts.shape, 2)) {
    *what = "has a shape that is not two integers";
    return false;
  }
  const int64_t rows = IndexAt(*parts.shape, 0);
  const int64_t columns = IndexAt(*parts.shape, 1);
  if (rows < 1 || columns < 1 || rows > kMaxFiniteElementDofs ||
      columns > kMaxFiniteElementDofs) {
    *what = "is " + SizeText(rows, columns) + ", and 1 to " +
            std::to_string(kMaxFiniteElementDofs) +
            " rows and columns were expected";
    return false;
  }
  const int64_t count = parts.data->size();
  const int64_t outer = parts.by_columns ? columns : rows;
  if (!parts.data->is_number() || !IsVector(parts.data, -1) ||
      !parts.indices->is_integer() || !IsVector(parts.indices, count) ||
      (parts.columns != nullptr &&
       (!parts.columns->is_integer() || !IsVector(parts.columns, count))) ||
      (parts.pointers != nullptr && (!parts.pointers->is_integer() ||
                                     !IsVector(parts.pointers, outer + 1)))) {
    *what =
        "has parts whose types or lengths do not fit each other or its shape";
    return false;
  }
  if (parts.pointers != nullptr && (IndexAt(*parts.pointers, 0) != 0 ||
                                    IndexAt(*parts.pointers, outer) != count)) {
    *what = "has an indptr that does not go from 0 to " +
            std::to_string(count) + " as was expected";
    return false;
  }
  std::vector<MatrixEntry> entries;
  entries.reserve(static_cast<size_t>(count));
  int64_t line = 0;  // row (CSR) or column (CSC) of entry k
  for (int64_t k = 0; k < count; ++k) {
    int64_t row = IndexAt(*parts.indices, k);
    int64_t column = 0;
    if (parts.pointers == nullptr) {
      column = IndexAt(*parts.columns, k);
    } else {
      while (line < outer && IndexAt(*parts.pointers, line + 1) <= k) ++line;
      if (line == outer || IndexAt(*parts.pointers, line) > k) {
        *what = "has an indptr that does not ascend, as was expected";
        return false;
      }
      column = line;
      if (!parts.by_columns) std::swap(row, column);
    }
    if (row < 0 || row >= rows || column < 0 || column >= columns) {
      *what = "has an index outside " + SizeText(rows, columns);
      return false;
    }
    MatrixEntry entry;
    entry.row = static_cast<int>(row);
    entry.column = static_cast<int>(column);
    entry.value = NumberAt(*parts.data, k);
    if (!std::isfinite(entry.value)) {
      *what = "has the entry " + EntryText(row, column) +
              " that is no finite number";
      return false;
    }
    entries.push_back(entry);
  }
  MatrixEntry twice;
  if (!AssembleMatrix(static_cast<int>(rows), static_cast<int>(columns),
                      /*mirrored=*/false, &entries, matrix, &twice)) {
    *what = "has the entry " + EntryText(twice.row, twice.column) +
            " twice, and once was expected (sum_duplicates() in SciPy)";
    return false;
  }
  return true;
}

bool BuildFull(const Array& array, SparseMatrix* matrix, std::string* what) {
  const int64_t rows = array.shape[0];
  const int64_t columns = array.shape[1];
  if (rows < 1 || columns < 1 || rows > kMaxFullDofs ||
      columns > kMaxFullDofs) {
    *what = "is a full array of " + SizeText(rows, columns) + ", and 1 to " +
            std::to_string(kMaxFullDofs) +
            " rows and columns were expected; save larger ones sparse";
    return false;
  }
  std::vector<MatrixEntry> entries;
  for (int64_t k = 0; k < rows * columns; ++k) {
    const double value = NumberAt(array, k);
    if (value == 0.0) continue;
    MatrixEntry entry;
    entry.row = static_cast<int>(array.fortran_order ? k % rows : k / columns);
    entry.column =
        static_cast<int>(array.fortran_order ? k / rows : k % columns);
    entry.value = value;
    if (!std::isfinite(value)) {
      *what = "has the entry " + EntryText(entry.row, entry.column) +
              " that is no finite number";
      return false;
    }
    entries.push_back(entry);
  }
  MatrixEntry unused;
  return AssembleMatrix(static_cast<int>(rows), static_cast<int>(columns),
                        /*mirrored=*/false, &entries, matrix, &unused);
}

bool BuildNames(const Array& array, std::vector<std::string>* names,
                std::string* what) {
  if ((array.kind == 'S' || array.kind == 'U') && array.shape.size() == 1) {
    for (int64_t i = 0; i < array.size(); ++i) {
      names->push_back(TextAt(array, i));
      if (names->back().empty() ||
          FirstInvalidUtf8(names->back()) != std::string::npos) {
        *what = "has no name for DOF " + std::to_string(i + 1) +
                ", and text was expected";
        return false;
      }
    }
    return true;
  }
  if (array.is_integer() && array.shape.size() == 2 && array.shape[1] == 2) {
    const int64_t rows = array.shape[0];
    for (int64_t i = 0; i < rows; ++i) {
      const int64_t node = IndexAt(array, array.fortran_order ? i : 2 * i);
      const int64_t direction =
          IndexAt(array, array.fortran_order ? rows + i : 2 * i + 1);
      if (node < 0 || direction < 0) {
        *what = "has a negative number in row " + std::to_string(i + 1) +
                ", and node and direction were expected";
        return false;
      }
      names->push_back(std::to_string(node) + "." + std::to_string(direction));
    }
    return true;
  }
  *what =
      "is neither a list of names nor of pairs (node, direction), and one of "
      "these was expected";
  return false;
}

bool IsDofArray(const std::string& name) {
  const std::string lower = LowerCase(name);
  return lower == "dofs" || lower == "dof_names" || lower == "dof_map";
}

const Array* Find(const Arrays& arrays, const std::string& name) {
  const auto found = arrays.find(name);
  return found == arrays.end() ? nullptr : &found->second;
}

// The parts whose names begin with `prefix`; false if they are not complete.
bool FindParts(const Arrays& arrays, const std::string& prefix,
               SparseParts* parts) {
  parts->data = Find(arrays, prefix + "data");
  parts->shape = Find(arrays, prefix + "shape");
  parts->indices = Find(arrays, prefix + "indices");
  parts->pointers = Find(arrays, prefix + "indptr");
  if (parts->pointers == nullptr) {
    parts->indices = Find(arrays, prefix + "row");
    parts->columns = Find(arrays, prefix + "col");
    if (parts->columns == nullptr) return false;
  }
  return parts->data != nullptr && parts->shape != nullptr &&
         parts->indices != nullptr;
}

// The format that scipy.sparse.save_npz states; empty without one.
std::string SparseFormat(const Arrays& arrays, const std::string& prefix) {
  const Array* format = Find(arrays, prefix + "format");
  if (format == nullptr || format->is_number() || format->size() != 1) {
    return "";
  }
  return TextAt(*format, 0);
}

}  // namespace

bool ReadNpzContent(const std::string& path, const std::string& content,
                    MatrixContainer* container, std::string* error) {
  CHECK(container != nullptr);
  CHECK(error != nullptr);
  Arrays arrays;
  std::set<std::string> others;
  if (!ReadArrays(path, content, &arrays, &others, error)) return false;
  MatrixContainer result;
  const auto fail = [&path, error](const std::string& name,
                                   const std::string& what) {
    *error = path + ": array " + Quote(name) + " " + what;
    return false;
  };
  constexpr std::string_view kData = "data";
  for (const auto& [name, array] : arrays) {
    std::string what;
    NamedMatrix matrix;
    matrix.name = name;
    if (IsDofArray(name)) {
      if (!result.dof_names.empty()) {
        return fail(name, "names the DOFs again, and once was expected");
      }
      if (!BuildNames(array, &result.dof_names, &what)) {
        return fail(name, what);
      }
    } else if (name.size() >= kData.size() &&
               name.substr(name.size() - kData.size()) == kData) {
      const std::string prefix = name.substr(0, name.size() - kData.size());
      const std::string format = SparseFormat(arrays, prefix);
      SparseParts parts;
      if (!FindParts(arrays, prefix, &parts)) {
        // SciPy's other formats (BSR has parts of other shapes, DIA offsets).
        if (format.empty()) continue;
        return fail(name, "is of the sparse format " + Quote(format) +
                              ", and csr, csc or coo was expected");
      }
      if (!format.empty() && format != "csr" && format != "csc" &&
          format != "coo") {
        return fail(name, "is of the sparse format " + Quote(format) +
                              ", and csr, csc or coo was expected");
      }
      parts.by_columns = format == "csc";
      if (!BuildSparse(parts, &matrix.matrix, &what)) return fail(name, what);
      matrix.name = prefix;
      while (!matrix.name.empty() && matrix.name.back() == '_') {
        matrix.name.pop_back();
      }
      result.matrices.push_back(std::move(matrix));
    } else if (array.is_number() && array.shape.size() == 2) {
      if (!BuildFull(array, &matrix.matrix, &what)) {
        if (array.shape[0] != array.shape[1]) continue;  // results, say
        return fail(name, what);
      }
      result.matrices.push_back(std::move(matrix));
    }
  }
  for (const std::string& name : others) {
    if (IsDofArray(name)) {
      return fail(name,
                  "is of a type that only Python reads (objects), and text or "
                  "integers were expected: numpy.array(names, dtype=str)");
    }
    NamedMatrix matrix;
    matrix.name = name;
    matrix.problem = "it is not of a real type (complex numbers, objects)";
    result.matrices.push_back(std::move(matrix));
  }
  *container = std::move(result);
  return true;
}

bool ReadNpz(const std::string& path, MatrixContainer* container,
             std::string* error) {
  CHECK(error != nullptr);
  std::string content;
  return ReadBinaryFile(path, &content, error) &&
         ReadNpzContent(path, content, container, error);
}

}  // namespace pinode
