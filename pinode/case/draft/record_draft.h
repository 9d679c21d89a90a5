// The records of a case from the files of loggers: which column is which
// sensor.

#ifndef PINODE_CASE_DRAFT_RECORD_DRAFT_H_
#define PINODE_CASE_DRAFT_RECORD_DRAFT_H_

#include <string>
#include <vector>

#include "pinode/case/draft/case_draft.h"
#include "pinode/case/draft/first_mode.h"
#include "pinode/case/draft/log_file.h"

namespace pinode {

// Checks the answers that name columns against all files, and their places
// against the draft's storeys or deck.
[[nodiscard]] bool CheckColumnAnswers(const DraftRequest& request,
                                      const std::vector<LogFile>& logs,
                                      const CaseDraft& draft,
                                      std::string* error);

// Makes the record of a file: base, floors, units. Asks if one is not clear.
[[nodiscard]] bool DraftRecordOf(const LogFile& log,
                                 const DraftRequest& request,
                                 const CaseDraft& draft, DraftRecord* record,
                                 DraftQuestion* question, std::string* error);

// Finds the first mode in a drafted record. Signs are those of the draft.
FirstMode FirstModeOf(const LogFile& log, const DraftRecord& record);

// Decides, with what is known of the first mode (Hz), if the record starts at
// rest, and which columns have an offset.
void DraftStartAndOffsets(const LogFile& log, double first_mode_hz,
                          DraftRecord* record);

}  // namespace pinode

#endif  // PINODE_CASE_DRAFT_RECORD_DRAFT_H_
