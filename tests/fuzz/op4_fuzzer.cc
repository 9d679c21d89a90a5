// Arbitrary bytes as an OP4 file, ASCII or binary.

#include <cstddef>
#include <cstdint>
#include <string>

#include "pinode/structure/matrices/op4.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string content(reinterpret_cast<const char*>(data), size);
  pinode::MatrixContainer container;
  std::string error;
  if (!pinode::ReadOp4Content("fuzz.op4", content, &container, &error) &&
      error.empty()) {
    __builtin_trap();
  }
  return 0;
}
