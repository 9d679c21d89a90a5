// Arbitrary bytes as the file of a logger, of the format that the build names:
// read with all channels, with none, and as a table.

#include <cstddef>
#include <cstdint>
#include <string>

#include "pinode/record/files/loggers/logger_table.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using pinode::LoggerFormat;
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  for (const bool all : {false, true}) {
    pinode::LoggedFile file;
    std::string error;
    const auto wanted = [all](const pinode::LoggerChannel&) { return all; };
    const bool is_read = pinode::ParseLoggedFile(
        bytes, "fuzzed", PINODE_FUZZED_FORMAT, "", wanted, &file, &error);
    if (is_read != error.empty()) __builtin_trap();
    if (!is_read || !all) continue;
    pinode::Table table;
    if (pinode::MakeLoggerTable(file, "fuzzed", {}, &table, &error) !=
        error.empty()) {
      __builtin_trap();
    }
  }
  return 0;
}
