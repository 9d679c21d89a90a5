#include "pinode/base/unpacked_size.h"

#include <fcntl.h>
#include <unistd.h>

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/file.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

TEST(UnpackedSize, GrantsTheLimitOrAMultipleOfTheFile) {
  std::string what;
  UnpackedSize small(1000.0);
  EXPECT_EQ(small.largest(), 2e9);
  EXPECT_TRUE(small.Take(1.5e9, &what));
  EXPECT_FALSE(small.Take(1e9, &what));
  EXPECT_THAT(what, HasSubstr("more than 2 GB"));
  UnpackedSize large(1e9);
  EXPECT_TRUE(large.Take(15e9, &what));
  EXPECT_FALSE(large.Take(2e9, &what));
}

TEST(UnpackedSize, FilesWithHolesAreNotTakenAtTheirWord) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("holes.csv");
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_GE(file, 0);
  ASSERT_EQ(write(file, "t,a\n", 4), 4);
  const bool has_holes = ftruncate(file, off_t{50} << 30) == 0;
  close(file);
  if (!has_holes) GTEST_SKIP() << "the file system has no files with holes";
  std::string content = "kept", error;
  EXPECT_FALSE(ReadBinaryFile(path, &content, &error));
  EXPECT_THAT(error, HasSubstr("holes.csv: the file takes more than 2 GB"));
  EXPECT_EQ(content, "kept");
}

// Text that is all zeros is taken apart at three times its size.
TEST(UnpackedSize, LargeFilesOfZerosAreRefusedUnread) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("zeros.csv");
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_GE(file, 0);
  const bool has_holes = ftruncate(file, off_t{1} << 30) == 0;
  close(file);
  if (!has_holes) GTEST_SKIP() << "the file system has no files with holes";
  std::string content = "kept", error;
  EXPECT_FALSE(ReadBinaryFile(path, &content, &error));
  EXPECT_THAT(error, HasSubstr("zeros.csv: the file begins with 4096 zeros"));
  EXPECT_EQ(content, "kept");
}

}  // namespace
}  // namespace pinode
