#include "pinode/base/file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class FileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = ::testing::TempDir() + "file_test_XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern + "/";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string Write(const std::string& name, const std::string& content) {
    std::ofstream(folder_ + name, std::ios::binary) << content;
    return folder_ + name;
  }
  int NumFiles() const {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
      (void)entry;
      ++count;
    }
    return count;
  }

  std::string folder_;
};

TEST_F(FileTest, ReadsByteForByte) {
  const std::string text("a\r\n\0b\n\xC3\xA9", 8);
  std::string content, error;
  ASSERT_TRUE(ReadTextFile(Write("f", text), &content, &error)) << error;
  EXPECT_EQ(content, text);
  ASSERT_TRUE(ReadTextFile(Write("empty", ""), &content, &error)) << error;
  EXPECT_EQ(content, "");
  const std::string large(1 << 20, 'x');
  ASSERT_TRUE(ReadTextFile(Write("large", large), &content, &error)) << error;
  EXPECT_EQ(content, large);
}

TEST_F(FileTest, UnpacksTextByItsName) {
  // gzip.compress(b"1 1 2.5\n", mtime=0) of Python.
  const unsigned char packed[] = {0x1f, 0x8b, 0x08, 0x00, 0x00, 0x00, 0x00,
                                  0x00, 0x02, 0x03, 0x33, 0x54, 0x30, 0x54,
                                  0x30, 0xd2, 0x33, 0xe5, 0x02, 0x00, 0x72,
                                  0x3e, 0x0a, 0xc7, 0x08, 0x00, 0x00, 0x00};
  const std::string bytes(packed, packed + sizeof(packed));
  std::string content, error;
  ASSERT_TRUE(ReadTextFile(Write("K.sti.gz", bytes), &content, &error))
      << error;
  EXPECT_EQ(content, "1 1 2.5\n");
  ASSERT_TRUE(ReadBinaryFile(folder_ + "K.sti.gz", &content, &error)) << error;
  EXPECT_EQ(content, bytes);
  EXPECT_FALSE(ReadTextFile(Write("text.gz", "1 1 2.5\n"), &content, &error));
  EXPECT_THAT(error, EndsWith("text.gz: the compressed data are damaged or cut "
                              "off, expected a file of gzip"));
  EXPECT_EQ(content, bytes);
  EXPECT_EQ(WithoutGz("a/K.sti.gz"), "a/K.sti");
  EXPECT_EQ(WithoutGz("a/K.sti"), "a/K.sti");
  EXPECT_EQ(WithoutGz(".gz"), ".gz");
}

TEST_F(FileTest, SaysWhatCannotBeRead) {
  std::string content = "kept", error;
  const std::string missing = folder_ + "missing.csv";
  EXPECT_FALSE(ReadTextFile(missing, &content, &error));
  EXPECT_THAT(error, StartsWith(missing + ": "));
  EXPECT_THAT(error, HasSubstr("No such file"));

  EXPECT_FALSE(ReadTextFile(folder_, &content, &error));
  EXPECT_THAT(error, HasSubstr("is a folder"));

  const std::string fifo = folder_ + "pipe";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_FALSE(ReadTextFile(fifo, &content, &error));
  EXPECT_THAT(error, HasSubstr("not a regular file"));

  const std::string latin1 = Write("latin1.csv", "t,a\n0,1\n1,\xE9t\xE9\n");
  std::string bytes;
  EXPECT_TRUE(ReadTextOfAnyEncoding(latin1, &bytes, &error)) << error;
  EXPECT_THAT(bytes, HasSubstr("\xE9t\xE9"));
  EXPECT_FALSE(ReadTextFile(latin1, &content, &error));
  EXPECT_THAT(error, StartsWith(latin1 + ":3: "));
  EXPECT_THAT(error, HasSubstr("0xE9"));
  EXPECT_EQ(content, "kept");
}

// A matrix file of another program may hold any byte; a text may not.
TEST_F(FileTest, BinaryFilesMayHoldAnyByte) {
  std::string bytes;
  for (int value = 255; value >= 0; --value) {
    bytes.push_back(static_cast<char>(value));
  }
  const std::string path = Write("bytes.op4", bytes);
  std::string content = "kept", error;
  EXPECT_FALSE(ReadTextFile(path, &content, &error));
  EXPECT_EQ(content, "kept");
  ASSERT_TRUE(ReadBinaryFile(path, &content, &error)) << error;
  EXPECT_EQ(content, bytes);
}

TEST_F(FileTest, SaysWhichBinaryFileCannotBeRead) {
  std::string content = "kept", error;
  const std::string missing = folder_ + "missing.op4";
  EXPECT_FALSE(ReadBinaryFile(missing, &content, &error));
  EXPECT_THAT(error, StartsWith(missing + ": cannot open"));
  EXPECT_FALSE(ReadBinaryFile(folder_, &content, &error));
  EXPECT_THAT(error, HasSubstr("is a folder"));
  const std::string fifo = folder_ + "pipe";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_FALSE(ReadBinaryFile(fifo, &content, &error));
  EXPECT_THAT(error, HasSubstr("not a regular file"));
  EXPECT_EQ(content, "kept");
}

TEST(FirstInvalidUtf8Test, FollowsTheStandard) {
  for (const char* good : {"", "abc", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80",
                           "\xED\x9F\xBF", "\xEE\x80\x80", "\xEF\xBF\xBF",
                           "\xF0\x90\x80\x80", "\xF4\x8F\xBF\xBF"}) {
    EXPECT_EQ(FirstInvalidUtf8(good), std::string::npos) << good;
  }
  for (const char* bad :
       {"\x80", "\xC0\x80", "\xC1\xBF", "\xC2", "\xC2x", "\xE0\x9F\xBF",
        "\xE2\x82", "\xED\xA0\x80", "\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80",
        "\xF5\x80\x80\x80", "\xFF", "\xE2\x82\xC0"}) {
    EXPECT_EQ(FirstInvalidUtf8(std::string("ab") + bad), 2u) << bad;
  }
}

TEST_F(FileTest, WritesAndReplaces) {
  const std::string path = folder_ + "out.csv";
  std::string content, error;
  ASSERT_TRUE(WriteFileAtomically(path, "first", &error)) << error;
  ASSERT_TRUE(WriteFileAtomically(path, "second", &error)) << error;
  ASSERT_TRUE(ReadTextFile(path, &content, &error)) << error;
  EXPECT_EQ(content, "second");
  EXPECT_EQ(NumFiles(), 1);
}

TEST_F(FileTest, NewFilesHaveOrdinaryPermissions) {
  const std::string path = folder_ + "out.csv";
  std::string error;
  const mode_t mask = umask(022);
  const bool written = WriteFileAtomically(path, "x", &error);
  umask(mask);
  ASSERT_TRUE(written) << error;
  struct stat status;
  ASSERT_EQ(stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0644u);
  // A replaced file keeps its own permissions.
  ASSERT_EQ(chmod(path.c_str(), 0600), 0);
  ASSERT_TRUE(WriteFileAtomically(path, "y", &error)) << error;
  ASSERT_EQ(stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
}

TEST_F(FileTest, AFailedWriteLeavesNothing) {
  std::string error;
  EXPECT_FALSE(WriteFileAtomically(folder_ + "no/out.csv", "x", &error));
  EXPECT_THAT(error, StartsWith(folder_ + "no/out.csv: cannot write"));

  std::filesystem::create_directory(folder_ + "taken");
  EXPECT_FALSE(WriteFileAtomically(folder_ + "taken", "x", &error));
  EXPECT_THAT(error, EndsWith("a folder of that name exists"));
  EXPECT_EQ(NumFiles(), 1);

  // Not even root can create a file here.
  EXPECT_FALSE(WriteFileAtomically("/proc/self/out.csv", "x", &error));
}

}  // namespace
}  // namespace pinode
