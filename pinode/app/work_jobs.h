// The long steps of a work, as the command-line programs do them: draft and
// check, fit, comparison with the baseline, modes.

#ifndef PINODE_APP_WORK_JOBS_H_
#define PINODE_APP_WORK_JOBS_H_

#include <string>
#include <vector>

#include "pinode/app/work_folder.h"
#include "pinode/case/run/fit_case.h"

namespace pinode {

// Result folders in a work.
inline constexpr char kCheckFolder[] = "check";
inline constexpr char kLaterCheckFolder[] = "check_later";
inline constexpr char kResultFolder[] = "result";
inline constexpr char kDamageFolder[] = "damage";
inline constexpr char kModesFolder[] = "modes";

// Drafts the cases of `state`, checks them, and writes the cases and the
// folders of their checks; as pinode_new does. Sets what the check tells of
// *state: is_checked, sentences, and whether the results are those of older
// cases. A case that was edited by hand is not replaced.
//
// `anew`: it is replaced nevertheless.
//
// Returns false with a question in *question if an answer is missing, else with
// one line in *error.
[[nodiscard]] bool CheckWork(const WorkFolder& folder, bool anew,
                             WorkState* state, DraftQuestion* question,
                             std::string* error);

// A case that a user has edited, and the text with which this began.
struct EditedCase {
  std::string text;
  std::string before;
  bool is_later = false;  // the case of the later state
};

// Checks an edited case, and writes it with the folder of its check; sets what
// CheckWork sets. Writes nothing, with *error naming the line, if no case can
// be read from the text; and nothing if the file is not `before` any more.
[[nodiscard]] bool SaveCaseOfWork(const WorkFolder& folder,
                                  const EditedCase& edited, WorkState* state,
                                  std::string* error);

// Fits the case of the baseline into kResultFolder, as pinode_update does.
// `resume`: continues from the checkpoint that a stopped fit has left.
[[nodiscard]] bool FitWork(const WorkFolder& folder, bool resume,
                           CaseWatch* watch, std::string* error);

// Fits the case of the later state and compares it with the result folder
// `baseline`, into kDamageFolder, as pinode_damage does.
[[nodiscard]] bool CompareWork(const WorkFolder& folder,
                               const std::string& baseline, bool resume,
                               CaseWatch* watch, std::string* error);

// Drafts and checks the case of the later records in `folder` as a later state
// of another work, so that its result is their baseline: the structure is what
// was answered there. Needs no record of the baseline in `folder`.
[[nodiscard]] bool DraftLaterOf(const WorkFolder& earlier,
                                const WorkFolder& folder, WorkState* state,
                                DraftQuestion* question, std::string* error);

// Finds the modes of a record without a model, into kModesFolder, as
// pinode_modes does. `columns`: names of the channels.
[[nodiscard]] bool FindModesOfWork(const WorkFolder& folder,
                                   const WorkState& state, const WorkFile& file,
                                   const std::vector<std::string>& columns,
                                   std::string* error);

}  // namespace pinode

#endif  // PINODE_APP_WORK_JOBS_H_
