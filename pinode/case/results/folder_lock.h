// Lock that says which process writes to a folder.

#ifndef PINODE_CASE_RESULTS_FOLDER_LOCK_H_
#define PINODE_CASE_RESULTS_FOLDER_LOCK_H_

#include <string>

namespace pinode {

// Name of the file in the folder that is locked.
inline constexpr char kFolderLock[] = "lock";

// A lock on a folder, held until Release or destruction. The system releases it
// when the process ends, however it ends. It is one of the file system (an open
// file description lock), so that other containers and, on network file
// systems, other hosts see it. Process numbers mean nothing there. The file
// names host and process for file systems without locks, and for messages.
class FolderLock {
 public:
  FolderLock() = default;
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  // Locks `folder`, which exists. Returns false if another process holds it.
  // True where the file system has no locks: the file says so.
  [[nodiscard]] bool Take(const std::string& folder);

  // Removes the file, which now lies in `folder`, and the lock.
  void Release(const std::string& folder);

 private:
  int file_ = -1;
};

// Says who holds a folder.
struct FolderHolder {
  enum class State {
    kNone,   // locked by nobody, and whoever wrote to it has ended
    kHeld,   // a process writes to it
    kUnseen  // perhaps: it names a process that cannot be asked from here
  };
  State state = State::kNone;
  // "process 7", "process 7 on host node12".
  std::string name;
};

// Finds the holder of `folder`. `process` is the number in the folder's name,
// for folders without a lock.
FolderHolder HolderOf(const std::string& folder, int process);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_FOLDER_LOCK_H_
