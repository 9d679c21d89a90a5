#include "pinode/case/results/folder_lock.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

namespace fs = std::filesystem;

// Locks of open files. Systems without them use those of processes.
#ifdef F_OFD_SETLK
constexpr int kSetLock = F_OFD_SETLK;
constexpr int kGetLock = F_OFD_GETLK;
#else
constexpr int kSetLock = F_SETLK;
constexpr int kGetLock = F_GETLK;
#endif

struct flock WholeFile() {
  struct flock lock = {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

std::string LockPath(const std::string& folder) {
  return (fs::path(folder) / kFolderLock).string();
}

std::string HostName() {
  std::array<char, 256> name = {};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

// Returns what tells containers on one machine apart: they count processes each
// for itself. Empty where the system has no such thing.
std::string ProcessSpace() {
  std::error_code status;
  const fs::path space = fs::read_symlink("/proc/self/ns/pid", status);
  return status ? "" : space.string();
}

// True if a process of this host and container has ended. It stays known until
// its parent asks for its status.
bool HasEnded(int process) {
  if (::kill(process, 0) != 0 && errno != EPERM) return true;
  std::string text, unused;
  if (!ReadTextFile("/proc/" + std::to_string(process) + "/stat", &text,
                    &unused)) {
    return false;
  }
  // The state follows the name, which is in parentheses and may contain more.
  const size_t name_end = text.rfind(')');
  return name_end != std::string::npos && name_end + 2 < text.size() &&
         (text[name_end + 2] == 'Z' || text[name_end + 2] == 'X');
}

bool IsAlive(int process) {
  return process != ::getpid() && process > 0 && !HasEnded(process);
}

// Content of a lock's file, one item a line: "locked" or "unlocked", process,
// host, and process namespace.
struct LockText {
  bool is_lock = false;
  int process = 0;
  std::string host;
  std::string space;
};

bool ReadLockText(const std::string& folder, LockText* text) {
  std::string content, unused;
  if (!ReadTextFile(LockPath(folder), &content, &unused)) return false;
  const std::vector<std::string_view> lines = Split(content, '\n');
  if (lines.size() < 4 || !ParseInt(lines[1], &text->process)) return false;
  text->is_lock = lines[0] == "locked";
  text->host = std::string(lines[2]);
  text->space = std::string(lines[3]);
  return true;
}

}  // namespace

FolderLock::~FolderLock() {
  if (file_ >= 0) ::close(file_);
}

bool FolderLock::Take(const std::string& folder) {
  const int file = ::open(LockPath(folder).c_str(),
                          O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  // A folder that cannot be written to is found out by its first file.
  if (file < 0) return true;
  struct flock lock = WholeFile();
  bool is_lock = true;
  if (::fcntl(file, kSetLock, &lock) != 0) {
    if (errno == EACCES || errno == EAGAIN) {
      ::close(file);
      return false;
    }
    is_lock = false;  // none on this file system
  }
  file_ = file;
  const std::string text = std::string(is_lock ? "locked" : "unlocked") + "\n" +
                           std::to_string(::getpid()) + "\n" + HostName() +
                           "\n" + ProcessSpace() + "\n";
  if (::ftruncate(file, 0) != 0 || ::write(file, text.data(), text.size()) !=
                                       static_cast<ssize_t>(text.size())) {
    // The lock holds without its text.
    return true;
  }
  return true;
}

void FolderLock::Release(const std::string& folder) {
  if (file_ < 0) return;
  ::unlink(LockPath(folder).c_str());
  ::close(file_);
  file_ = -1;
}

FolderHolder HolderOf(const std::string& folder, int process) {
  FolderHolder holder;
  holder.name = "process " + std::to_string(process);
  LockText text;
  const bool has_text = ReadLockText(folder, &text);
  const bool is_here =
      !has_text || (text.host == HostName() && text.space == ProcessSpace());
  if (has_text) {
    process = text.process;
    holder.name = "process " + std::to_string(process);
    if (!is_here) holder.name += " on host " + text.host;
  }
  const int file =
      ::open(LockPath(folder).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (file >= 0) {
    struct flock lock = WholeFile();
    const bool is_known = ::fcntl(file, kGetLock, &lock) == 0;
    ::close(file);
    if (is_known && lock.l_type != F_UNLCK) {
      holder.state = FolderHolder::State::kHeld;
      return holder;
    }
    if (is_known && has_text && text.is_lock) return holder;
  }
  if (!is_here) {
    holder.state = FolderHolder::State::kUnseen;
  } else if (IsAlive(process)) {
    holder.state = FolderHolder::State::kHeld;
  }
  return holder;
}

}  // namespace pinode
