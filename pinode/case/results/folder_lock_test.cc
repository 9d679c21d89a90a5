#include "pinode/case/results/folder_lock.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/case/results/result_folder.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// A process that holds the lock of a folder until it is killed.
class Holder {
 public:
  explicit Holder(const std::string& folder) {
    int ready[2];
    EXPECT_EQ(::pipe(ready), 0);
    process_ = ::fork();
    if (process_ == 0) {
      FolderLock lock;
      const char taken = lock.Take(folder) ? 'y' : 'n';
      (void)!::write(ready[1], &taken, 1);
      for (;;) ::pause();
    }
    char taken = 0;
    EXPECT_EQ(::read(ready[0], &taken, 1), 1);
    EXPECT_EQ(taken, 'y');
    ::close(ready[0]);
    ::close(ready[1]);
  }
  ~Holder() { Kill(); }
  Holder(const Holder&) = delete;
  Holder& operator=(const Holder&) = delete;

  int process() const { return process_; }
  void Kill() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = 0;
  }

 private:
  pid_t process_ = 0;
};

int EndedProcess() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  return child;
}

TEST(FolderLock, IsSeenWithoutTheProcess) {
  TemporaryFolder base;
  const std::string folder = base.Path("out.partial-1");
  fs::create_directory(folder);
  Holder holder(folder);
  // Another container counts its processes for itself: the number in the name
  // is that of a dead one here.
  const FolderHolder held = HolderOf(folder, EndedProcess());
  EXPECT_EQ(held.state, FolderHolder::State::kHeld);
  EXPECT_EQ(held.name, "process " + std::to_string(holder.process()));
  FolderLock second;
  EXPECT_FALSE(second.Take(folder));
  holder.Kill();
  EXPECT_EQ(HolderOf(folder, 1).state, FolderHolder::State::kNone);
  EXPECT_TRUE(second.Take(folder));
  EXPECT_EQ(HolderOf(folder, 1).state, FolderHolder::State::kHeld);
  second.Release(folder);
  EXPECT_TRUE(fs::is_empty(folder));
}

// A file system without locks, and a process of another host.
TEST(FolderLock, OtherHostsCannotBeAsked) {
  TemporaryFolder base;
  const std::string path = base.Path("out");
  const std::string folder = path + ".partial-7";
  fs::create_directory(folder);
  base.Write("out.partial-7/lock", "unlocked\n7\nnode12\npid:[1]\n");
  const FolderHolder holder = HolderOf(folder, 7);
  EXPECT_EQ(holder.state, FolderHolder::State::kUnseen);
  EXPECT_EQ(holder.name, "process 7 on host node12");
  ResultFolder result;
  std::string error;
  EXPECT_FALSE(result.Open(path, false, true, &error));
  EXPECT_THAT(error, HasSubstr("process 7 on host node12 has begun"));
  EXPECT_THAT(error, HasSubstr("delete " + folder + "/lock"));
  // The end of a process that had a lock is known.
  base.Write("out.partial-7/lock", "locked\n7\nnode12\npid:[1]\n");
  EXPECT_EQ(HolderOf(folder, 7).state, FolderHolder::State::kNone);
}

// Two containers write to one folder; each has its own numbers of processes.
TEST(FolderLock, AFolderInUseIsNotDeleted) {
  TemporaryFolder base;
  const std::string path = base.Path("out");
  for (const int process : {EndedProcess(), static_cast<int>(::getpid())}) {
    const std::string folder = path + ".partial-" + std::to_string(process);
    fs::create_directory(folder);
    base.Write("out.partial-" + std::to_string(process) + "/checkpoint.json",
               "there");
    Holder holder(folder);
    for (const bool resume : {false, true}) {
      ResultFolder result;
      std::string error;
      EXPECT_FALSE(result.Open(path, false, resume, &error));
      EXPECT_THAT(error, HasSubstr("is writing to this folder"));
    }
    EXPECT_TRUE(fs::exists(folder + "/checkpoint.json"));
    holder.Kill();
    ResultFolder result;
    std::string error;
    ASSERT_TRUE(result.Open(path, false, true, &error)) << error;
    EXPECT_EQ(result.resume_path(), result.checkpoint_path());
    fs::remove(result.checkpoint_path());
  }
}

}  // namespace
}  // namespace pinode
