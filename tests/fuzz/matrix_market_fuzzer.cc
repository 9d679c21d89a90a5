// Arbitrary bytes as a Matrix Market file.

#include <cstddef>
#include <cstdint>
#include <string>

#include "pinode/structure/matrices/matrix_market.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string content(reinterpret_cast<const char*>(data), size);
  pinode::SparseMatrix matrix;
  std::string error;
  // Small sizes: it is the parser that is on trial, not the memory.
  if (!pinode::ReadMatrixMarketText("fuzz.mtx", content, 10000, &matrix,
                                    &error) &&
      error.empty()) {
    __builtin_trap();
  }
  return 0;
}
