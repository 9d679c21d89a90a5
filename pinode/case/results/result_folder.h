// The folder that a program leaves behind: all of it, or nothing.

#ifndef PINODE_CASE_RESULTS_RESULT_FOLDER_H_
#define PINODE_CASE_RESULTS_RESULT_FOLDER_H_

#include <string>

namespace pinode {

// Whether a program may write its results to the folder `path`: it does not
// exist or is empty, or `overwrite` or `resume` says that it may be replaced
// and it holds results of pinode (nothing else is ever deleted); and it can be
// created. Touches nothing. Fails with one line in *error.
[[nodiscard]] bool CheckOutputFolder(const std::string& path, bool overwrite,
                                     bool resume, std::string* error);

// An output folder in the making. Everything is written to a folder beside it,
// `<path>.partial-<process>`, which takes its place at the end by a rename: a
// reader sees the old folder or the whole new one. A process that is killed
// leaves the partial folder with its last checkpoint, from which the next one
// resumes.
class ResultFolder {
 public:
  ResultFolder() = default;
  // Without Commit: removes the partial folder, but for a checkpoint in it.
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  // Checks as CheckOutputFolder does, and creates the partial folder. With
  // `resume`, takes over the newest one that a dead process left for `path`.
  // Fails where another process is writing to `path`.
  [[nodiscard]] bool Open(const std::string& path, bool overwrite, bool resume,
                          std::string* error);

  // For a process that reads what another one, which writes, has opened: with
  // a checkpoint to resume from, or "".
  void Follow(const std::string& resume_path) { resume_path_ = resume_path; }
  // Whether this process is the one that writes.
  bool writes() const { return !working_.empty(); }

  // Where to write now, and where it will be after Commit (absolute).
  const std::string& working_path() const { return working_; }
  const std::string& final_path() const { return final_; }

  // Where CheckpointWriter is to write.
  std::string checkpoint_path() const;
  // The checkpoint to resume from; empty where there is none.
  const std::string& resume_path() const { return resume_path_; }

  // Puts the folder in its place. On failure *error says why, what was in that
  // place before is there again, and the partial folder stays, whole.
  [[nodiscard]] bool Commit(std::string* error);

 private:
  bool is_whole_ = false;
  std::string final_;
  std::string working_;
  std::string resume_path_;
};

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_RESULT_FOLDER_H_
