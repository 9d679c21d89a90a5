// Result folder of a program, written completely or not at all.

#ifndef PINODE_CASE_RESULTS_RESULT_FOLDER_H_
#define PINODE_CASE_RESULTS_RESULT_FOLDER_H_

#include <string>

#include "pinode/case/results/folder_lock.h"

namespace pinode {

// Checks if a program may write its results to the folder `path`. The folder
// must be possible to create, and one of the following must hold:
//
// - it does not exist or is empty;
// - `overwrite` or `resume` allows its replacement, and it holds results of
//   pinode (nothing else is ever deleted).
//
// Changes nothing on disk. Returns false with one line in *error.
[[nodiscard]] bool CheckOutputFolder(const std::string& path, bool overwrite,
                                     bool resume, std::string* error);

// Output folder while it is written. All files go to a neighbouring folder,
// `<path>.partial-<process>`, which replaces `path` at the end by a rename. A
// reader sees either the old folder or the complete new one. A process that is
// killed leaves the partial folder with its last checkpoint, from which the
// next process resumes.
class ResultFolder {
 public:
  ResultFolder() = default;
  // Removes the partial folder if it was not committed, but keeps a checkpoint
  // in it.
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  // Checks as CheckOutputFolder does, and creates the partial folder. With
  // `resume`, takes over the newest one that a dead process left for `path`.
  // Fails if another process is writing to `path`, be it in another container
  // or on another host.
  [[nodiscard]] bool Open(const std::string& path, bool overwrite, bool resume,
                          std::string* error);

  // Opens a folder for a process that only reads, while another process writes:
  // with a checkpoint to resume from, or "".
  void Follow(const std::string& resume_path) { resume_path_ = resume_path; }
  // True if this process writes.
  bool writes() const { return !working_.empty(); }

  // Path to write to now, and path after Commit (absolute).
  const std::string& working_path() const { return working_; }
  const std::string& final_path() const { return final_; }

  // Path for CheckpointWriter.
  std::string checkpoint_path() const;
  // Path of the checkpoint to resume from; empty if there is none.
  const std::string& resume_path() const { return resume_path_; }

  // Moves the folder to its final place. On failure *error gives the reason,
  // the previous contents are restored, and the complete partial folder
  // remains.
  [[nodiscard]] bool Commit(std::string* error);

 private:
  bool is_whole_ = false;
  std::string final_;
  std::string working_;
  std::string resume_path_;
  FolderLock lock_;
};

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_RESULT_FOLDER_H_
