#include "pinode/base/arrays/numpy_archive.h"

#include <zip.h>

#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "pinode/base/file_text.h"
#include "pinode/base/unpacked_size.h"

namespace pinode {
namespace {

struct ArchiveCloser {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
struct MemberCloser {
  void operator()(zip_file_t* member) const { zip_fclose(member); }
};

std::string ZipMessage(zip_error_t* problem) {
  std::string message = zip_error_strerror(problem);
  zip_error_fini(problem);
  return message;
}

// Reads one member, whatever size the archive claims: all of it, or the bytes
// that hold its header.
bool ReadMember(zip_t* archive, zip_uint64_t index, bool whole,
                UnpackedSize* memory, std::string* bytes, std::string* what) {
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
    if (!memory->Take(static_cast<double>(count), what)) return false;
    bytes->append(buffer.data(), static_cast<size_t>(count));
    if (!whole && bytes->size() >= kNumpyHeaderBytes) return true;
  }
}

}  // namespace

bool ReadNumpyArchive(const std::string& path, const std::string& content,
                      const std::function<bool(const std::string&)>& wanted,
                      NumpyArrays* arrays, std::set<std::string>* others,
                      std::string* error) {
  UnpackedSize memory(static_cast<double>(content.size()));
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
    *error =
        path + ": " + ZipMessage(&problem) + ", expected a NumPy archive (zip)";
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
    const bool whole = wanted(name);
    if (ReadMember(archive.get(), index, whole, &memory, &bytes, &what)) {
      kind = whole ? ParseNumpyArray(std::move(bytes), &array, &what)
                   : ParseNumpyHeader(bytes, &array, &what);
    }
    if (kind == NumpyArrayKind::kBroken) {
      *error = path + ": array " + Quote(name) + " " + what;
      return false;
    }
    if (kind == NumpyArrayKind::kOther) {
      others->insert(name);
    } else if (!arrays->emplace(name, std::move(array)).second) {
      *error = path + ": array " + Quote(name) +
               " is given twice, expected each name once";
      return false;
    }
  }
  return true;
}

}  // namespace pinode
