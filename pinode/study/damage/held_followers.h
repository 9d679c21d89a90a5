// New records that do not determine how a structure follows a covariate.

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

// Returns values of followers to hold: the parameters by which groups of
// `problem` follow covariates, free and without a prior of their own, that all
// baselines determine. The new records do not determine them, because these are
// ambient records or modes alone, each at one value of a covariate. The values
// are the baselines' means, weighted by their variances.
std::map<std::string, double> FollowersToHold(
    const std::vector<Baseline>& baselines,
    const IdentificationProblem& problem);

// Comparison of groups that were found with followers s held at s0. Each
// baseline has its own s and is compared as if it had s0,
//
//   g - G (s - s0),   G = dg_new / ds = -H_gg^-1 H_gs,
//
// where g_new are the groups as found from the new records, and H is the
// Hessian of their cost. The uncertainty of s then enters correctly: it is zero
// at the temperatures of the baselines and grows with the distance from them.
class HeldFollowers {
 public:
  // Finds the followers that `problem` has fixed and all baselines have free.
  HeldFollowers(const std::vector<Baseline>& baselines,
                const IdentificationProblem& problem);

  bool empty() const { return names_.empty(); }
  // Names of the rows of a state after its groups (StateNear with these as
  // well).
  const std::vector<std::string>& names() const { return names_; }

  // Finds G for a fit of the new records: rows for groups, then `candidates` in
  // their units. Returns false, with *error, if the cost is not finite.
  [[nodiscard]] bool FindSlopes(const FitOfRecords& fit,
                                const std::vector<std::string>& groups,
                                const std::vector<ChangeCandidate>& candidates,
                                int num_threads, std::string* error);
  // Returns the groups and candidates to be compared from groups, followers and
  // candidates, at the slopes found last.
  GroupState Compared(const GroupState& healthy, size_t num_groups) const;
  // Returns the state of a baseline's groups and these followers.
  GroupState StateOf(const Baseline& baseline) const;

 private:
  std::vector<std::string> names_;
  Vector held_;
  Matrix slopes_;
};

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_HELD_FOLLOWERS_H_
