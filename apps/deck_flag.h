// --deck: the input deck that a case's matrices came from, written again with
// what a fit has found.

#ifndef PINODE_APPS_DECK_FLAG_H_
#define PINODE_APPS_DECK_FLAG_H_

#include <string>

#include "pinode/case/results/result_folder.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// The deck, before any work; true without one.
[[nodiscard]] bool CheckDeckFlag(const Case& c, std::string* error);

// False, with *error, is no reason to lose the result: both are in its remarks.
[[nodiscard]] bool WriteDeck(const Case& c, const IdentifiedModel& model,
                             const ResultFolder& folder,
                             IdentificationSummary* summary,
                             std::string* error);

// Tells of a deck that could not be written.
void PrintNoDeck(const std::string& error);

}  // namespace pinode

#endif  // PINODE_APPS_DECK_FLAG_H_
