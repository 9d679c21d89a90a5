// Text of a drafted case, with comments for whoever edits it.

#ifndef PINODE_CASE_DRAFT_CASE_DRAFT_TEXT_H_
#define PINODE_CASE_DRAFT_CASE_DRAFT_TEXT_H_

#include <string>

#include "pinode/case/draft/case_draft.h"
#include "pinode/case/sections/case_file.h"

namespace pinode {

// Returns the case file. Paths of records are relative to the folder of
// `draft.path`. `command` is the command line, for the first comment.
std::string CaseDraftText(const CaseDraft& draft, const std::string& command);

// Name of the group of the damping in proportion to mass.
inline constexpr char kDraftedMassDamping[] = "c_mass";

// Name of the group of the damping of this storey.
std::string DraftedDamperName(int storey);

// Name of the group of the damping ratio of this mode, or of this one and all
// higher ones.
std::string DraftedRatioName(const CaseDraft& draft, int mode);

// Reads the text of a draft as if it stood in the file `path`, for a check.
[[nodiscard]] bool ReadCaseDraft(const std::string& text,
                                 const std::string& path, Case* c,
                                 std::string* error);

// True for a text that CaseDraftText has written.
bool IsCaseDraft(const std::string& text);

}  // namespace pinode

#endif  // PINODE_CASE_DRAFT_CASE_DRAFT_TEXT_H_
