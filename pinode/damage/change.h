// Changes of a structure between its baselines and a new state.

#ifndef PINODE_DAMAGE_CHANGE_H_
#define PINODE_DAMAGE_CHANGE_H_

#include <cstddef>
#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Identified factors alpha_j of the structure's groups in K0 + sum_j alpha_j
// K_j. Group j has 1 + alpha_j times its nominal stiffness. Other unknowns that
// may change can be entries too, see ChangeOptions::absolute.
struct GroupState {
  // One factor per group, dimensionless, and their covariance, groups x groups.
  // The covariance must be positive definite.
  Vector values;
  Matrix covariance;
};

// Options of EstimateChange.
struct ChangeOptions {
  // Loss from which damage is reported, as a fraction of the baseline
  // stiffness.
  double threshold = 0.05;
  // Probability of reporting a change of any group although none has changed.
  double false_alarm_rate = 0.05;
  // Number of random draws, at least 1000, for the distribution of the largest
  // score (see EstimateChange).
  int num_draws = 20000;
  // Entries whose change is a plain difference, in the unit of their value,
  // such as a mass that may have been added. The change of any other entry is a
  // fraction of its baseline 1 + alpha. One flag per entry; empty: none.
  std::vector<bool> absolute;
  // Limit for rivals of a found change. Another explanation is a rival if it
  // lowers twice the log-likelihood by less than this. The default is odds of
  // 20 (R. E. Kass and A. E. Raftery, J. Amer. Statist. Assoc. 90 (1995)
  // 773-795).
  double rival_loss = 6.0;

  // Returns false if an option is not allowed. *error then names the option and
  // the violated constraint.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

// Estimated change of one group.
struct GroupChange {
  // Change as a fraction of the baseline value: -0.1 means that a tenth is
  // lost. It is estimated jointly with the changes of all groups that were
  // found. Groups that were not found are assumed unchanged, except this one.
  double change = 0.0;
  double sigma = 0.0;  // standard deviation of `change`
  // 95 % interval of `change`.
  double lower95 = 0.0;
  double upper95 = 0.0;
  // Probability that the loss, -change, is above ChangeOptions::threshold.
  double probability = 0.0;
  // True if the group was found: "no change" is rejected at
  // ChangeOptions::false_alarm_rate, which holds for all groups together.
  bool changed = false;
  // Adjusted p-value of that test: the smallest false-alarm rate at which the
  // group is found, given the groups found before it.
  double p_value = 1.0;
};

// Rival explanation: a change of group `other` (not found) in place of group
// `found` explains the data nearly as well.
struct RivalChange {
  // Indices of the two groups, from 0.
  int found = 0;
  int other = 0;
  double loss = 0.0;  // decrease of twice the log-likelihood
};

// Explanation of the new records by changes of a few groups. These changes were
// fitted to the records; everything else is as in the baselines.
struct ChangeExplanation {
  // Indices of the groups that change, from 0, and the change of each.
  std::vector<int> changed;
  std::vector<GroupChange> changes;
  // Natural logarithm of the odds of this explanation relative to the likeliest
  // one: 0 for the likeliest, negative for the others.
  double log_odds = 0.0;
  // Probability among all sets of groups that were fitted. Their prior
  // probabilities are equal.
  double probability = 0.0;
};

// Result of EstimateChange.
struct ChangeEstimate {
  // Change of every group, in the order of the states' entries.
  std::vector<GroupChange> groups;
  std::vector<RivalChange> rivals;  // least loss first
  // Standard deviation of each value from baseline to baseline, beyond its own
  // covariance, in the units of GroupChange::change. Zero with one baseline.
  Vector between_records;
  // True with several baselines: the intervals then include the differences
  // between them.
  bool has_between_records = false;
  // Test that only the groups found have changed: chi^2 statistic and its
  // degrees of freedom, the number of the other groups.
  double unexplained_chi2 = 0.0;
  int unexplained_degrees = 0;
  // Explanations with at least a twentieth of the odds of the likeliest one.
  // The likeliest comes first; its changes equal those in `groups`. Empty: none
  // was fitted.
  std::vector<ChangeExplanation> explanations;
};

// Values that the baselines predict for a new state in which nothing has
// changed.
struct PooledBaselines {
  // Expected values, one per group, and their covariance, groups x groups. The
  // covariance includes the differences between baselines.
  GroupState state;
  // Variance of each value between baselines beyond its own covariance.
  Vector between;
  // Number of baselines, at least 1.
  int num_baselines = 0;
  // Cost (negative log-likelihood) of the baselines' data at the expected
  // values, and half of log(det(covariance)). Zero if they are the same for all
  // explanations.
  double cost = 0.0;
  double log_volume = 0.0;
};

// Returns one flag per entry for ChangeOptions::absolute. It is true if 1 +
// alpha is at most 0.1 in one of the baselines, as for some dampers of a simple
// model. Such a value is too small for a change to be a fraction of it. All
// states must have the same size.
std::vector<bool> NearlyGone(const std::vector<GroupState>& healthy);

// Estimates the change of every group from the baselines to the current state.
// There is at least one baseline, and all states have the same groups.
//
// The differences d of the values have a normal distribution. Its covariance is
// the sum of those of both states. With several baselines the variance between
// baselines is added. It is estimated per group by the method of moments (R.
// DerSimonian and N. Laird, Controlled Clinical Trials 7 (1986) 177-188). As it
// comes from few baselines, tests and intervals then use Student's t.
//
// The method assumes that few groups change at a time and finds them one by
// one:
//
// 1. The score of group j, if it alone has changed, is
//    z_j = (W d)_j / sqrt(W_jj), with W the inverse covariance of d.
// 2. The largest |z_j| is compared with its distribution without change. Draws
//    with the correlation of the scores give this distribution, so that the
//    false-alarm rate holds for all groups together.
// 3. If it is significant, the group is found. The scores of the others are
//    conditioned on it, and step 2 is repeated.
// 4. A group found earlier is removed if groups found later explain it.
//
// Unlike the LASSO, the method does not bias the changes that it finds, and its
// false-alarm rate is known.
//
// Returns false, with *error, if an option is not allowed, sizes differ, a
// covariance is not positive definite, or a baseline stiffness is not positive.
[[nodiscard]] bool EstimateChange(const std::vector<GroupState>& healthy,
                                  const GroupState& current,
                                  const ChangeOptions& options,
                                  ChangeEstimate* estimate, std::string* error);

// Pools the baselines as EstimateChange does. Returns false, with *error, if
// there is none, sizes differ, or a covariance is not positive definite.
[[nodiscard]] bool PoolBaselines(const std::vector<GroupState>& healthy,
                                 PooledBaselines* pooled, std::string* error);

// Returns the degrees of freedom of differences from baselines. `variances` are
// those of the differences, `between` their parts between baselines (both in
// the same units). Infinite if baselines do not differ.
double DegreesOfFreedom(const Vector& between, const Vector& variances,
                        size_t num_baselines);

// Finds rivals of the changes in the groups `found`, by whichever method these
// were found. A rival replaces one of these groups by another group. *rivals is
// sorted by loss, smallest first. Returns false as EstimateChange does.
[[nodiscard]] bool FindRivals(const std::vector<GroupState>& healthy,
                              const GroupState& current,
                              const ChangeOptions& options,
                              const std::vector<int>& found,
                              std::vector<RivalChange>* rivals,
                              std::string* error);

// Change of one group in place of another one that was found.
struct ChangeInstead {
  GroupChange change;  // `changed` and `p_value` are not set
  // Decrease of twice the log-likelihood by the exchange.
  double loss = 0.0;
};

// Computes the change of group `other` if group `one`, an entry of `found`, has
// not changed. `other` may be in `found` too. The groups `beside` may change
// along with both explanations, such as damping with stiffness. Options and
// errors as EstimateChange.
[[nodiscard]] bool FindChangeInstead(const std::vector<GroupState>& healthy,
                                     const GroupState& current,
                                     const ChangeOptions& options,
                                     const std::vector<int>& found, int one,
                                     int other, const std::vector<int>& beside,
                                     ChangeInstead* result, std::string* error);

}  // namespace pinode

#endif  // PINODE_DAMAGE_CHANGE_H_
