// Arbitrary bytes as a Harwell-Boeing matrix, and as the list of its rows.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pinode/structure/matrices/harwell_boeing.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string content(reinterpret_cast<const char*>(data), size);
  pinode::SparseMatrix matrix;
  std::string error;
  if (!pinode::ReadHarwellBoeingText("fuzz.hb", content, 1000, &matrix,
                                     &error) &&
      error.empty()) {
    __builtin_trap();
  }
  std::vector<std::string> names;
  error.clear();
  if (!pinode::ReadRowMappingText("fuzz.mapping", content, &names, &error) &&
      error.empty()) {
    __builtin_trap();
  }
  return 0;
}
