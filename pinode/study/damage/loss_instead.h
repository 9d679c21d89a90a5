// Losses of stiffness in place of masses that were found. Not meant for other
// layers.

#ifndef PINODE_STUDY_DAMAGE_LOSS_INSTEAD_H_
#define PINODE_STUDY_DAMAGE_LOSS_INSTEAD_H_

#include <string>
#include <vector>

#include "pinode/damage/change.h"
#include "pinode/study/damage/kinds_search.h"
#include "pinode/study/damage/result_subjects.h"

namespace pinode {

// Looks for stiffness that may have been lost where a mass was found, if
// damping has changed too. An added mass lowers damping over mass as well as
// stiffness over mass, and so needs one change where the others are two.
// `kinds` has found the changes of *subjects.
//
// A group counts if it may have lost more than options.threshold and the
// exchange loses less than options.rival_loss. It gets a flag in *is_loss, one
// per subject (MissedMotion::loss_instead). Its change becomes the one that it
// has if the mass has not changed, and if it was not found, it becomes a rival
// of the mass. A group that was found and is lost either way, to 95 %, does not
// count; its interval then holds both sizes. Returns false, with *error, as
// FindChangeInstead does.
[[nodiscard]] bool FindLossesInstead(const KindsSearch& kinds,
                                     const ChangeOptions& options,
                                     ResultSubjects* subjects,
                                     std::vector<bool>* is_loss,
                                     std::string* error);

// True if a group that was found is lost either way, to 95 %: by *own, or by
// `instead` under another explanation. The interval of *own then holds both.
bool IsLostEitherWay(const GroupChange& instead, GroupChange* own);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_LOSS_INSTEAD_H_
