// For tests only, hence not installed: where the measured data are that the
// project does not hold.

#ifndef TESTS_SUPPORT_MEASURED_DATA_TESTING_H_
#define TESTS_SUPPORT_MEASURED_DATA_TESTING_H_

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include "gtest/gtest.h"

namespace pinode {

// The file or folder `name` among the measured data ("": all of them), which
// are in the folder that the environment variable PINODE_MEASURED_DATA names,
// else in ../shared/data beside the project's root. Empty if there is none.
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

// In a test or in SetUp(): the string `path` of `name`; where there is none the
// test is skipped, and says so.
#define PINODE_FIND_MEASURED_DATA(path, name)                      \
  const std::string path = ::pinode::FindMeasuredData(name);       \
  if (path.empty()) {                                              \
    GTEST_SKIP() << "measured data not found: " << (name)          \
                 << " (set PINODE_MEASURED_DATA to their folder)"; \
  }

#endif  // TESTS_SUPPORT_MEASURED_DATA_TESTING_H_
