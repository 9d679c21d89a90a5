// Results written into the deck from which a case's matrices came.

#ifndef PINODE_CASE_RESULTS_UPDATED_DECK_H_
#define PINODE_CASE_RESULTS_UPDATED_DECK_H_

#include <string>

#include "pinode/case/sections/case_file.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// Checks for WriteUpdatedDeck that the deck at `path` (CalculiX, Abaqus) has
// the element sets of all groups from exports, with properties that can be
// changed. Returns false with one line in *error. A group's sets are those of
// [geometry], or the one with the group's name.
[[nodiscard]] bool CheckDeck(const Case& c, const std::string& path,
                             std::string* error);

// Writes `folder`/<name>_updated.inp for a deck <name>.inp, with the properties
// of each group's element sets multiplied by its factor; see ScaleDeck in
// structure/decks/deck_properties.h. Comments at its head say if a fit is not
// usable, and name the groups whose changes do not belong to element sets'
// stiffness or mass and are therefore missing. *remark also names these groups.
// A set that has lost all its stiffness or mass cannot be written: the function
// then returns true without a deck, and *remark gives the reason. Otherwise
// *remark is empty.
[[nodiscard]] bool WriteUpdatedDeck(const Case& c,
                                    const IdentificationSummary& summary,
                                    const IdentifiedModel& model,
                                    const std::string& path,
                                    const std::string& folder,
                                    std::string* remark, std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_UPDATED_DECK_H_
