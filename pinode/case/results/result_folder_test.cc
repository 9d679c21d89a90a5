#include "pinode/case/results/result_folder.h"

#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

void Write(const std::string& folder, const std::string& name,
           const std::string& text) {
  std::ofstream(fs::path(folder) / name) << text;
}

int CountEntries(const std::string& folder) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    count += !entry.path().empty();
  }
  return count;
}

// The number of a process that has ended.
int DeadProcess() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  return child;
}

TEST(ResultFolderTest, AppearsWhole) {
  TemporaryFolder base;
  const std::string path = base.Path("new/out/");
  ResultFolder folder;
  std::string error;
  ASSERT_TRUE(folder.Open(path, false, false, &error)) << error;
  EXPECT_TRUE(folder.resume_path().empty());
  Write(folder.working_path(), "result.json", "1");
  EXPECT_FALSE(fs::exists(path));
  ASSERT_TRUE(folder.Commit(&error)) << error;
  EXPECT_EQ(base.Read("new/out/result.json"), "1");
  EXPECT_EQ(CountEntries(base.Path("new")), 1);
  EXPECT_EQ(fs::path(folder.final_path()).filename(), "out");
}

TEST(ResultFolderTest, LeavesNothingWithoutCommit) {
  TemporaryFolder base;
  {
    ResultFolder folder;
    std::string error;
    ASSERT_TRUE(folder.Open(base.Path("out"), false, false, &error)) << error;
    Write(folder.working_path(), "result.json", "1");
  }
  EXPECT_EQ(CountEntries(base.Path("")), 0);
}

TEST(ResultFolderTest, ExistingFolders) {
  TemporaryFolder base;
  const std::string path = base.Path("out");
  fs::create_directory(path);
  std::string error;
  EXPECT_TRUE(CheckOutputFolder(path, false, false, &error)) << error;
  Write(path, "letter.txt", "dear");
  EXPECT_FALSE(CheckOutputFolder(path, false, false, &error));
  EXPECT_THAT(error, HasSubstr("exists and is not empty"));
  // Foreign files are not replaced, whatever was requested.
  EXPECT_FALSE(CheckOutputFolder(path, true, false, &error));
  EXPECT_THAT(error, HasSubstr("has no results of pinode"));
  Write(path, "result.json", "old");
  EXPECT_FALSE(CheckOutputFolder(path, false, false, &error));
  EXPECT_TRUE(CheckOutputFolder(path, true, false, &error)) << error;
  EXPECT_TRUE(CheckOutputFolder(path, false, true, &error)) << error;
  EXPECT_FALSE(CheckOutputFolder(path + "/result.json", true, false, &error));
  EXPECT_THAT(error, HasSubstr("is not a folder"));
  EXPECT_FALSE(
      CheckOutputFolder(path + "/result.json/out", true, false, &error));
  EXPECT_THAT(error, HasSubstr("cannot be created"));
  EXPECT_FALSE(CheckOutputFolder("", false, false, &error));

  ResultFolder folder;
  ASSERT_TRUE(folder.Open(path, true, false, &error)) << error;
  Write(folder.working_path(), "result.json", "new");
  EXPECT_EQ(base.Read("out/result.json"), "old");
  ASSERT_TRUE(folder.Commit(&error)) << error;
  EXPECT_EQ(base.Read("out/result.json"), "new");
  EXPECT_FALSE(fs::exists(path + "/letter.txt"));
  EXPECT_EQ(CountEntries(base.Path("")), 1);
}

TEST(ResultFolderTest, ReadOnlyParent) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  TemporaryFolder base;
  fs::permissions(base.Path(""), fs::perms::owner_read | fs::perms::owner_exec);
  std::string error;
  EXPECT_FALSE(CheckOutputFolder(base.Path("out"), false, false, &error));
  EXPECT_THAT(error, HasSubstr("cannot be created"));
  fs::permissions(base.Path(""), fs::perms::owner_all);
}

TEST(ResultFolderTest, ResumesAfterAKill) {
  TemporaryFolder base;
  const std::string path = base.Path("out");
  const std::string partial =
      path + ".partial-" + std::to_string(DeadProcess());
  fs::create_directory(partial);
  Write(partial, "checkpoint.json", "there");
  Write(partial, "result.json", "half");
  std::string error;
  ResultFolder folder;
  ASSERT_TRUE(folder.Open(path, false, true, &error)) << error;
  EXPECT_EQ(folder.resume_path(), folder.checkpoint_path());
  std::ifstream file(folder.resume_path());
  std::string text;
  file >> text;
  EXPECT_EQ(text, "there");
  // Beside the checkpoint there is the lock.
  EXPECT_EQ(CountEntries(folder.working_path()), 2);
  EXPECT_FALSE(fs::exists(folder.working_path() + "/result.json"));
  EXPECT_FALSE(fs::exists(partial));
  ASSERT_TRUE(folder.Commit(&error)) << error;
  EXPECT_EQ(CountEntries(base.Path("")), 1);

  // From a folder that is complete.
  ResultFolder again;
  ASSERT_TRUE(again.Open(path, false, true, &error)) << error;
  EXPECT_EQ(again.resume_path(), fs::path(path) / "checkpoint.json");
}

TEST(ResultFolderTest, KeepsACheckpointWithoutCommit) {
  TemporaryFolder base;
  std::string error, partial;
  {
    ResultFolder folder;
    ASSERT_TRUE(folder.Open(base.Path("out"), false, false, &error)) << error;
    Write(folder.working_path(), "checkpoint.json", "there");
    Write(folder.working_path(), "result.json", "half");
    partial = folder.working_path();
  }
  EXPECT_EQ(CountEntries(base.Path("")), 1);
  EXPECT_EQ(CountEntries(partial), 1);
  // A new start does not care, and clears up behind itself.
  const std::string stale =
      base.Path("out.partial-" + std::to_string(DeadProcess()));
  fs::create_directory(stale);
  ResultFolder folder;
  ASSERT_TRUE(folder.Open(base.Path("out"), false, false, &error)) << error;
  EXPECT_TRUE(folder.resume_path().empty());
  ASSERT_TRUE(folder.Commit(&error)) << error;
  EXPECT_FALSE(fs::exists(stale));
}

TEST(ResultFolderTest, WhatCannotBePutInPlaceStays) {
  TemporaryFolder base;
  std::string error, partial;
  {
    ResultFolder folder;
    ASSERT_TRUE(folder.Open(base.Path("out"), false, false, &error)) << error;
    Write(folder.working_path(), "result.json", "1");
    partial = folder.working_path();
    // Somebody else was there first.
    Write(base.Path(""), "out", "");
    EXPECT_FALSE(folder.Commit(&error));
  }
  EXPECT_THAT(error, HasSubstr("the results are in " + partial));
  EXPECT_TRUE(fs::is_regular_file(base.Path("out")));
  EXPECT_EQ(CountEntries(partial), 1);
}

// Found out before the fit, not after it.
TEST(ResultFolderTest, LinksToNothing) {
  TemporaryFolder base;
  fs::create_symlink("nothing", base.Path("out"));
  for (const char* name : {"out", "out/", "out/below/it"}) {
    std::string error;
    EXPECT_FALSE(CheckOutputFolder(base.Path(name), true, false, &error));
    EXPECT_THAT(error, HasSubstr("out is a link to something that does not"));
  }
  // A link to a folder is as good as the folder.
  fs::create_directory(base.Path("nothing"));
  std::string error;
  EXPECT_TRUE(CheckOutputFolder(base.Path("out"), false, false, &error))
      << error;
}

TEST(ResultFolderTest, AnotherProcessIsWriting) {
  TemporaryFolder base;
  // The parent process lives as long as this one.
  const std::string partial =
      base.Path("out.partial-" + std::to_string(::getppid()));
  fs::create_directory(partial);
  ResultFolder folder;
  std::string error;
  EXPECT_FALSE(folder.Open(base.Path("out"), false, true, &error));
  EXPECT_THAT(error, HasSubstr("is writing to this folder"));
}

}  // namespace
}  // namespace pinode
