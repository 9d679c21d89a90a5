// What was found, written into the deck that a case's matrices came from.

#ifndef PINODE_CASE_RESULTS_UPDATED_DECK_H_
#define PINODE_CASE_RESULTS_UPDATED_DECK_H_

#include <string>

#include "pinode/case/sections/case_file.h"
#include "pinode/problem/identification_summary.h"

namespace pinode {

// Whether the deck at `path` (CalculiX, Abaqus) has the element sets of all
// groups that come from exports, and properties of theirs that can be changed:
// what WriteUpdatedDeck needs. False, with one line in *error. A group's sets
// are those of [geometry], or the one that is called like it.
[[nodiscard]] bool CheckDeck(const Case& c, const std::string& path,
                             std::string* error);

// Writes `folder`/<name>_updated.inp for a deck <name>.inp: the same with the
// properties of each group's element sets times its factor, see ScaleDeck in
// structure/decks/deck_properties.h. Comments at its head say that a fit is not
// usable, and which groups' changes are none of element sets' stiffness or mass
// and so are not in it; *remark says the latter too. A set that has lost all it
// had cannot be written: true without a deck, and *remark says why. Otherwise
// *remark is empty.
[[nodiscard]] bool WriteUpdatedDeck(const Case& c,
                                    const IdentificationSummary& summary,
                                    const IdentifiedModel& model,
                                    const std::string& path,
                                    const std::string& folder,
                                    std::string* remark, std::string* error);

}  // namespace pinode

#endif  // PINODE_CASE_RESULTS_UPDATED_DECK_H_
