// Arbitrary bytes as a file of arrays: what they begin with says of which kind.

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "pinode/base/arrays/array_files.h"

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
// HDF5 1.10 itself reads behind a chunk that unpacks to less than the file
// says; the sanitizer ends the program there. Other builds replay these files.
#define PINODE_WITHOUT_HDF5
#endif
#endif

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string content(reinterpret_cast<const char*>(data), size);
  const std::string extension = content.rfind("\x89HDF", 0) == 0 ? ".h5"
                                : content.rfind("\x93", 0) == 0  ? ".npy"
                                : content.rfind("PK", 0) == 0    ? ".npz"
                                                                 : ".mat";
#ifdef PINODE_WITHOUT_HDF5
  if (extension == ".h5") return 0;
#endif
  // Readers go by the name's extension.
  const std::string path =
      "/dev/shm/pinode_fuzz_" + std::to_string(getpid()) + extension;
  std::ofstream(path, std::ios::binary) << content;
  std::vector<pinode::NamedArray> arrays;
  std::string error;
  if (!pinode::ReadArrayFile(
          path, [](const std::string&) { return true; }, &arrays, &error) &&
      error.empty()) {
    __builtin_trap();
  }
  std::filesystem::remove(path);
  return 0;
}
