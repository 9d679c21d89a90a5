// Waits until a folder changes.

#ifndef PINODE_WATCH_FOLDER_NOTICE_H_
#define PINODE_WATCH_FOLDER_NOTICE_H_

#include <chrono>
#include <functional>
#include <string>

namespace pinode {

// Notice that the kernel (inotify) gives of new files. Folders of another
// machine change without it, so the caller looks at them from time to time as
// well.
class FolderNotice {
 public:
  // Begins to listen. A folder that cannot be listened to gives no notice.
  explicit FolderNotice(const std::string& folder);
  ~FolderNotice();
  FolderNotice(const FolderNotice&) = delete;
  FolderNotice& operator=(const FolderNotice&) = delete;

  // False: there will be no notice.
  bool is_listening() const { return queue_ >= 0; }

  // Waits for `longest`, or until `interrupted` returns true, which is asked
  // five times a second. Once a file was written or moved into the folder,
  // waits at most for `quiet` more, so that its neighbours arrive too.
  void Wait(std::chrono::milliseconds longest, std::chrono::milliseconds quiet,
            const std::function<bool()>& interrupted);

 private:
  // Returns true if there was a notice within `time`.
  bool Hears(std::chrono::milliseconds time);

  int queue_ = -1;
};

}  // namespace pinode

#endif  // PINODE_WATCH_FOLDER_NOTICE_H_
