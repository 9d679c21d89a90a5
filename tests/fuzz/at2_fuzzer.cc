// Arbitrary bytes as a ground motion in the format of PEER.

#include <cstddef>
#include <cstdint>
#include <string>

#include "pinode/record/files/at2.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  pinode::At2Motion motion;
  std::string error;
  const bool is_read = pinode::ParseAt2(text, "fuzzed", &motion, &error);
  if (is_read != error.empty()) __builtin_trap();
  if (is_read && !motion.acceleration.allFinite()) __builtin_trap();
  return 0;
}
