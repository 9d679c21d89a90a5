// Arbitrary bytes as a NumPy archive.

#include <cstddef>
#include <cstdint>
#include <string>

#include "pinode/structure/matrices/npz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string content(reinterpret_cast<const char*>(data), size);
  pinode::MatrixContainer container;
  std::string error;
  if (!pinode::ReadNpzContent("fuzz.npz", content, &container, &error) &&
      error.empty()) {
    __builtin_trap();
  }
  return 0;
}
