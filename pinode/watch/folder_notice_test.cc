#include "pinode/watch/folder_notice.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using std::chrono::milliseconds;

// Long enough that no test waits for it.
constexpr milliseconds kLong{600000};
constexpr milliseconds kShort{1};

bool Never() { return false; }

// Waits, and returns true if a notice ended it, and not 300 questions (a
// minute).
bool IsNoticed(FolderNotice* notice) {
  int questions = 0;
  notice->Wait(kLong, kShort, [&questions] { return ++questions > 300; });
  return questions <= 300;
}

TEST(FolderNotice, FilesThatAreWrittenOrMovedInEndTheWait) {
  TemporaryFolder folder, other;
  FolderNotice notice(folder.Path(""));
  ASSERT_TRUE(notice.is_listening());
  folder.Write("a.csv", "1\n");
  EXPECT_TRUE(IsNoticed(&notice));
  other.Write("b.csv", "1\n");
  std::filesystem::rename(other.Path("b.csv"), folder.Path("b.csv"));
  EXPECT_TRUE(IsNoticed(&notice));
}

TEST(FolderNotice, OldFilesGiveNoNotice) {
  TemporaryFolder folder;
  folder.Write("a.csv", "1\n");
  FolderNotice notice(folder.Path(""));
  int questions = 0;
  notice.Wait(kLong, kShort, [&questions] { return ++questions > 3; });
  EXPECT_EQ(questions, 4);
}

TEST(FolderNotice, AFolderThatIsNotThereIsWaitedFor) {
  TemporaryFolder folder;
  FolderNotice notice(folder.Path("none"));
  EXPECT_FALSE(notice.is_listening());
  notice.Wait(milliseconds(5), kShort, Never);
  int questions = 0;
  notice.Wait(kLong, kShort, [&questions] { return ++questions > 1; });
  EXPECT_EQ(questions, 2);
}

}  // namespace
}  // namespace pinode
