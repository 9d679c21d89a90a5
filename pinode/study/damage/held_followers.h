// New records that do not tell how a structure follows a covariate.

#ifndef PINODE_STUDY_DAMAGE_HELD_FOLLOWERS_H_
#define PINODE_STUDY_DAMAGE_HELD_FOLLOWERS_H_

#include <map>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/damage/change.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/study/damage/baseline.h"
#include "pinode/study/damage/change_candidates.h"
#include "pinode/study/damage/wide_state.h"

namespace pinode {

// The parameters by which groups of `problem` follow covariates, free and
// without a prior of their own, that its records are not asked for (it has
// ambient records or modes alone, each at one value of a covariate) and all
// baselines tell: what they say of them, weighed by their variances.
std::map<std::string, double> FollowersToHold(
    const std::vector<Baseline>& baselines,
    const IdentificationProblem& problem);

// A comparison of groups that were found with followers s held at s0. A healthy
// state knows them itself: it is compared as what it would have been with s0 in
// their place,
//
//   g - G (s - s0),   G = dg_new / ds = -H_gg^-1 H_gs,
//
// g_new being what the new records say of the groups, and H the Hessian of
// their cost. What is uncertain about s is then where it belongs: not there at
// the temperatures where the healthy records were made, and growing from there.
class HeldFollowers {
 public:
  // Those that `problem` has fixed and all baselines have free.
  HeldFollowers(const std::vector<Baseline>& baselines,
                const IdentificationProblem& problem);

  bool empty() const { return names_.empty(); }
  // Rows of a state behind its groups (StateNear with these as well).
  const std::vector<std::string>& names() const { return names_; }

  // G for a fit of the new records: rows for groups, then `candidates` in their
  // units. False, with *error, where the cost is not finite.
  [[nodiscard]] bool FindSlopes(const FitOfRecords& fit,
                                const std::vector<std::string>& groups,
                                const std::vector<ChangeCandidate>& candidates,
                                int num_threads, std::string* error);
  // At the slopes found last: from groups, followers and candidates to groups
  // and candidates as they are compared.
  GroupState Compared(const GroupState& healthy, size_t num_groups) const;
  // The state of a baseline's groups and of all of its followers, of these
  // alone.
  GroupState StateOf(const Baseline& baseline) const;

 private:
  std::vector<std::string> names_;
  Vector held_;
  Matrix slopes_;
};

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_HELD_FOLLOWERS_H_
