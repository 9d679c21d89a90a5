// Arbitrary bytes as a universal file: functions, geometry and shapes.

#include <cstddef>
#include <cstdint>
#include <string>

#include "pinode/record/files/universal_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  pinode::UniversalFile file;
  std::string error;
  const bool is_read =
      pinode::ParseUniversalFile(bytes, "fuzzed", &file, &error);
  if (is_read != error.empty()) __builtin_trap();
  return 0;
}
