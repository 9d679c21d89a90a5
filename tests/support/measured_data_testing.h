// For tests only, hence not installed: finds measured data that are not part of
// the project.

#ifndef TESTS_SUPPORT_MEASURED_DATA_TESTING_H_
#define TESTS_SUPPORT_MEASURED_DATA_TESTING_H_

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include "gtest/gtest.h"

namespace pinode {

// Returns the path of the file or folder `name` among the measured data ("":
// all of them). The environment variable PINODE_MEASURED_DATA names their
// folder; by default it is ../shared/data beside the project's root. Empty if
// it does not exist.
inline std::string FindMeasuredData(const std::string& name) {
  namespace fs = std::filesystem;
  const char* folder = std::getenv("PINODE_MEASURED_DATA");
  const fs::path all = folder != nullptr ? fs::path(folder)
                                         : fs::path(PINODE_SOURCE_DIR) / ".." /
                                               "shared" / "data";
  const fs::path path = name.empty() ? all : all / name;
  std::error_code status;
  return fs::exists(path, status) ? path.string() : std::string();
}

}  // namespace pinode

// Defines, in a test or in SetUp(), the string `path` of `name`. If the file
// does not exist, skips the test with a message.
#define PINODE_FIND_MEASURED_DATA(path, name)                      \
  const std::string path = ::pinode::FindMeasuredData(name);       \
  if (path.empty()) {                                              \
    GTEST_SKIP() << "measured data not found: " << (name)          \
                 << " (set PINODE_MEASURED_DATA to their folder)"; \
  }

#endif  // TESTS_SUPPORT_MEASURED_DATA_TESTING_H_
