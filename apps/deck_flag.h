// --deck: the input deck from which a case's matrices came, written again with
// the results of a fit.

#ifndef PINODE_APPS_DECK_FLAG_H_
#define PINODE_APPS_DECK_FLAG_H_

#include <string>

#include "pinode/case/results/result_folder.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// Checks the deck before any work; true without one.
[[nodiscard]] bool CheckDeckFlag(const Case& c, std::string* error);

// Writes the deck. If it returns false, with *error, the result should still be
// kept: both are in its remarks.
[[nodiscard]] bool WriteDeck(const Case& c, const IdentifiedModel& model,
                             const ResultFolder& folder,
                             IdentificationSummary* summary,
                             std::string* error);

// Reports a deck that could not be written.
void PrintNoDeck(const std::string& error);

}  // namespace pinode

#endif  // PINODE_APPS_DECK_FLAG_H_
