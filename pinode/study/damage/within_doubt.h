// Changes that are no larger than what is in doubt about the fits.

#ifndef PINODE_STUDY_DAMAGE_WITHIN_DOUBT_H_
#define PINODE_STUDY_DAMAGE_WITHIN_DOUBT_H_

#include <string>
#include <vector>

#include "pinode/damage/change.h"
#include "pinode/damage/verdict.h"
#include "pinode/study/damage/baseline.h"

namespace pinode {

// Values of a fit, and what is in doubt about them.
struct DoubtedState {
  const GroupState& state;
  const Doubts& doubts;
  bool misses_motion = false;  // see MissesMotion
};

// Returns whether the doubts of one baseline (`then`) and of the new records
// (`now`) cover a change, one for each of `subjects`. The first subjects are
// `groups`. See MissedMotion::within_doubt.
std::vector<bool> WithinDoubt(const DoubtedState& then, const DoubtedState& now,
                              const std::vector<std::string>& groups,
                              const std::vector<ChangeSubject>& subjects,
                              const ChangeEstimate& estimate,
                              const ChangeOptions& options);

// Returns the changes of `groups` if one explanation of what the model lacks
// holds for `then` and `now`. WithinDoubt compares these values. Empty if there
// is no such explanation, or if it has no value of a group.
std::vector<ExplainedValue> ChangesUnderOne(
    const DoubtedState& then, const Doubts& now,
    const std::vector<std::string>& groups, const ChangeEstimate& estimate,
    const ChangeOptions& options);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_WITHIN_DOUBT_H_
