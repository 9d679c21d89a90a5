#include "pinode/watch/folder_notice.h"

#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <thread>

namespace pinode {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kBetweenQuestions{200};

}  // namespace

FolderNotice::FolderNotice(const std::string& folder)
    : queue_(inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
  if (queue_ < 0) return;
  if (inotify_add_watch(queue_, folder.c_str(),
                        IN_CLOSE_WRITE | IN_MOVED_TO | IN_ONLYDIR) >= 0) {
    return;
  }
  close(queue_);
  queue_ = -1;
}

FolderNotice::~FolderNotice() {
  if (queue_ >= 0) close(queue_);
}

bool FolderNotice::Hears(milliseconds time) {
  if (!is_listening()) {
    std::this_thread::sleep_for(time);
    return false;
  }
  pollfd wanted = {queue_, POLLIN, 0};
  // A signal ends poll early, which the caller's question notices.
  if (poll(&wanted, 1, static_cast<int>(time.count())) <= 0) return false;
  // Which file it was does not matter: the folder is looked at as a whole.
  std::array<char, 4096> events;
  while (read(queue_, events.data(), events.size()) > 0) {
  }
  return true;
}

void FolderNotice::Wait(milliseconds longest, milliseconds quiet,
                        const std::function<bool()>& interrupted) {
  using Clock = std::chrono::steady_clock;
  auto end = Clock::now() + longest;
  bool has_heard = false;
  while (!interrupted()) {
    const auto left =
        std::chrono::duration_cast<milliseconds>(end - Clock::now());
    if (left <= milliseconds::zero()) return;
    if (Hears(std::min(left, kBetweenQuestions)) && !has_heard) {
      has_heard = true;
      end = std::min(end, Clock::now() + quiet);
    }
  }
}

}  // namespace pinode
