// One piece of work on disk: uploaded files, answers, cases and results.
//
//   FOLDER/work_1/work.json       files and answers of the page
//                 records/        baseline records
//                 later/          records of a later state
//                 deck/           a deck with its exported matrices
//                 case.toml, case_later.toml
//                 check/, check_later/, modes/, result/, damage/
//
// The cases and the result folders are those of the command-line programs.

#ifndef PINODE_APP_WORK_FOLDER_H_
#define PINODE_APP_WORK_FOLDER_H_

#include <map>
#include <string>
#include <vector>

#include "pinode/case/draft/case_draft.h"

namespace pinode {

// Use of an uploaded file.
enum class FileUse { kBaseline, kLater, kDeck };

// "baseline", "later", "deck".
const char* FileUseName(FileUse use);
[[nodiscard]] bool FindFileUse(const std::string& name, FileUse* use);

struct WorkFile {
  std::string name;
  FileUse use = FileUse::kBaseline;
};

// Files and answers of a user.
struct WorkState {
  std::vector<WorkFile> files;
  // Answers by the names of DraftRequest's members, as pinode_new has flags:
  // "storeys", "weights", ... Only AnswerNames() are kept.
  std::map<std::string, std::string> answers;
  // Place of each column: "base", "none", a floor "3" or a DOF of the deck
  // "12.1", with "-" if upside down; a force "force:3". No entry: found by the
  // column's name.
  std::map<std::string, std::string> places;
  // True while the cases are those of these files and answers.
  bool is_checked = false;
  // True if the cases have changed since the result was made.
  bool is_result_old = false;
  bool is_damage_old = false;
  // Work whose result was compared with; empty: this one.
  std::string compared_with;
  // Hashes of the cases as they were written, by file name: a case that was
  // edited by hand since then is not replaced.
  std::map<std::string, std::string> written;
  // Sentences of the drafts.
  std::vector<std::string> assumptions;
  std::vector<std::string> remarks;
};

// Names of the answers that a user may give.
const std::vector<std::string>& AnswerNames();

class WorkFolder {
 public:
  WorkFolder() = default;
  // `root`: folder of all works; `name`: "work_1".
  WorkFolder(const std::string& root, const std::string& name);

  const std::string& name() const { return name_; }
  const std::string& path() const { return path_; }
  // Path of a file or folder in it.
  std::string At(const std::string& relative) const;
  std::string PathOf(const WorkFile& file) const;
  std::string case_path() const { return At("case.toml"); }
  std::string later_case_path() const { return At("case_later.toml"); }

  // Creates the folders.
  [[nodiscard]] bool Create(std::string* error) const;
  // Reads work.json; a file that is missing on disk is left out of *state.
  [[nodiscard]] bool Load(WorkState* state, std::string* error) const;
  [[nodiscard]] bool Save(const WorkState& state, std::string* error) const;

  // True if a fit into the result folder `relative` was killed or stopped and
  // has a checkpoint.
  bool HasUnfinishedFit(const std::string& relative) const;

  // Returns `text` without the paths of this folder, and with the labels of the
  // page in place of flags, for the user's eyes.
  std::string ForReader(std::string text) const;

 private:
  std::string name_;
  std::string path_;
};

// Returns the works in `root`, in the order of their numbers.
std::vector<std::string> ListWorks(const std::string& root);
// Returns the name of a work that `root` does not have.
std::string NextWork(const std::string& root);

// Returns the request for DraftCases.
DraftRequest RequestOf(const WorkFolder& folder, const WorkState& state);
// Returns the options with which its records are read.
LogOptions LogOptionsOf(const WorkState& state);
// Returns `text` as one word of a shell's command.
std::string ShellWord(const std::string& text);
// Returns the command of pinode_new, run in the folder, that drafts the same.
std::string CommandOf(const WorkFolder& folder, const WorkState& state);

}  // namespace pinode

#endif  // PINODE_APP_WORK_FOLDER_H_
