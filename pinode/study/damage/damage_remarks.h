// Remarks of the result of a search for damage.

#ifndef PINODE_STUDY_DAMAGE_DAMAGE_REMARKS_H_
#define PINODE_STUDY_DAMAGE_DAMAGE_REMARKS_H_

#include <string>
#include <vector>

#include "pinode/damage/change.h"
#include "pinode/damage/verdict.h"
#include "pinode/study/damage/baseline.h"
#include "pinode/study/damage/damage_search.h"

namespace pinode {

// Each function appends its remarks, if there is anything to say.

// Directions that `records` do not determine. Changes of few groups are told by
// what the others have kept. A change along a direction that is open on either
// side is told by nothing.
void RemarkWhatIsOpen(const std::string& records,
                      const std::vector<std::string>& directions,
                      std::vector<std::string>* remarks);

// Another solution describes the data of `whose` as well.
void RemarkAnotherSolution(const std::string& whose, const Doubts& doubts,
                           std::vector<std::string>* remarks);

// Changes of `groups` that differ from those of the fit `current` with all
// groups free, whose values the table of parameters shows.
void RemarkWhatDiffers(const std::vector<GroupState>& healthy,
                       const GroupState& current,
                       const std::vector<std::string>& groups,
                       const ChangeEstimate& estimate,
                       std::vector<std::string>* remarks);

// Motion that the changes found leave unexplained, if it is more than the
// baselines leave.
void RemarkWhatIsMissed(const MissedMotion& missed,
                        std::vector<std::string>* remarks);

// Groups of stiffness whose change the records do not tell from that of a mass
// among `found`, and the change that they have if the mass has none. A free
// decay knows stiffness over mass alone: 17 % less stiffness was "a loss is not
// ruled out". One remark per mass. Both states have `groups` and then
// `candidates`. Entries without the flag `is_logarithm` are left out.
void RemarkMassInstead(const GroupState& healthy, const GroupState& current,
                       const std::vector<bool>& is_logarithm,
                       const std::vector<ChangeSubject>& groups,
                       const std::vector<ChangeCandidate>& candidates,
                       const std::vector<ChangeCandidate>& found,
                       std::vector<std::string>* remarks);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_DAMAGE_REMARKS_H_
