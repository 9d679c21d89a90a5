#include "pinode/structure/npz.h"

#include <zip.h>

#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/structure/matrix_from_arrays.h"
#include "pinode/structure/matrix_text.h"
#include "pinode/structure/numpy_array.h"

namespace pinode {
namespace {

// Larger members are refused: a full matrix of 10,000 DOFs has 0.8 GB.
constexpr size_t kLargestMember = size_t{4} << 30;

struct ArchiveCloser {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
struct MemberCloser {
  void operator()(zip_file_t* member) const { zip_fclose(member); }
};

using Arrays = std::map<std::string, NumpyArray>;

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
    NumpyArray array;
    NumpyArrayKind kind = NumpyArrayKind::kBroken;
    if (ReadMember(archive.get(), index, &bytes, &what)) {
      kind = ParseNumpyArray(bytes, &array, &what);
    }
    if (kind == NumpyArrayKind::kBroken) {
      *error = path + ": array " + Quote(name) + " " + what;
      return false;
    }
    if (kind == NumpyArrayKind::kOther) {
      others->insert(name);
    } else if (!arrays->emplace(name, std::move(array)).second) {
      *error = path + ": array " + Quote(name) +
               " is there twice, and each name was expected once";
      return false;
    }
  }
  return true;
}

bool IsDofArray(const std::string& name) {
  const std::string lower = LowerCase(name);
  return lower == "dofs" || lower == "dof_names" || lower == "dof_map";
}

const NumpyArray* Find(const Arrays& arrays, const std::string& name) {
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
  const NumpyArray* format = Find(arrays, prefix + "format");
  if (format == nullptr || format->is_number() || format->size() != 1) {
    return "";
  }
  return format->TextAt(0);
}

enum class ArrayUse { kNone, kBad, kGood };

// The sparse matrix of which "<prefix>data" is a part, if it is one.
ArrayUse FindSparse(const Arrays& arrays, const std::string& prefix,
                    SparseParts* parts, std::string* what) {
  const std::string format = SparseFormat(arrays, prefix);
  const bool complete = FindParts(arrays, prefix, parts);
  if (!complete && format.empty()) return ArrayUse::kNone;
  // SciPy's other formats: BSR has parts of other shapes, DIA offsets.
  if (!complete || (!format.empty() && format != "csr" && format != "csc" &&
                    format != "coo")) {
    *what = "is of the sparse format " + Quote(format) +
            ", and csr, csc or coo was expected";
    return ArrayUse::kBad;
  }
  parts->by_columns = format == "csc";
  return ArrayUse::kGood;
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
      if (!NamesFromArray(array, &result.dof_names, &what)) {
        return fail(name, what);
      }
    } else if (name.size() >= kData.size() &&
               name.substr(name.size() - kData.size()) == kData) {
      const std::string prefix = name.substr(0, name.size() - kData.size());
      SparseParts parts;
      const ArrayUse use = FindSparse(arrays, prefix, &parts, &what);
      if (use == ArrayUse::kNone) continue;
      if (use == ArrayUse::kBad ||
          !MatrixFromParts(parts, &matrix.matrix, &what)) {
        return fail(name, what);
      }
      matrix.name = prefix;
      while (!matrix.name.empty() && matrix.name.back() == '_') {
        matrix.name.pop_back();
      }
      result.matrices.push_back(std::move(matrix));
    } else if (array.is_number() && array.shape.size() == 2) {
      if (!MatrixFromFullArray(array, &matrix.matrix, &what)) {
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
    matrix.fault = "it is not of a real type (complex numbers, objects)";
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
