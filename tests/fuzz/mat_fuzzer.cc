// Arbitrary bytes as a MATLAB file. matio reads from paths only, so the bytes
// go through a file in memory.

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "pinode/structure/matrices/mat_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const int descriptor = memfd_create("fuzz", 0);
  if (descriptor < 0) return 0;
  if (write(descriptor, data, size) == static_cast<ssize_t>(size)) {
    pinode::MatrixContainer container;
    std::string error;
    const std::string path = "/proc/self/fd/" + std::to_string(descriptor);
    if (!pinode::ReadMatFile(path, &container, &error) && error.empty()) {
      __builtin_trap();
    }
  }
  close(descriptor);
  return 0;
}
