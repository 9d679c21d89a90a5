// For tests only, hence not installed: files in a temporary folder.

#ifndef TESTS_SUPPORT_TEMPORARY_FOLDER_TESTING_H_
#define TESTS_SUPPORT_TEMPORARY_FOLDER_TESTING_H_

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "gtest/gtest.h"

namespace pinode {

// Returns the bytes of a file. Empty if there is none.
inline std::string FileContent(const std::string& path) {
  std::ostringstream content;
  content << std::ifstream(path, std::ios::binary).rdbuf();
  return content.str();
}

// A folder that exists as long as this object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    // Tests of one program may run at the same time.
    static int count = 0;
    path_ =
        std::filesystem::path(::testing::TempDir()) /
        ("pinode_" + std::to_string(getpid()) + "_" + std::to_string(++count));
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string Path(const std::string& name) const {
    return (path_ / name).string();
  }
  std::string Write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return Path(name);
  }
  std::string Read(const std::string& name) const {
    return FileContent(Path(name));
  }
  int NumFiles() const {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) {
      count += entry.exists() ? 1 : 0;
    }
    return count;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace pinode

#endif  // TESTS_SUPPORT_TEMPORARY_FOLDER_TESTING_H_
