// Changes between the baselines and a new state.

#ifndef PINODE_DAMAGE_CHANGE_H_
#define PINODE_DAMAGE_CHANGE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Identified factors of a structure's groups with their covariance: alpha of K0
// + sum_j alpha_j K_j, so that the group has 1 + alpha times its nominal
// stiffness. Other unknowns that may change can be included, see
// ChangeOptions::absolute.
struct GroupState {
  Vector values;
  Matrix covariance;
};

struct ChangeOptions {
  // Loss from which damage is reported, as a fraction of the baseline
  // stiffness.
  double threshold = 0.05;
  // Probability of reporting any change without a change.
  double false_alarm_rate = 0.05;
  // Number of random draws for the distribution of the largest statistic.
  int num_draws = 20000;
  // Marks entries whose change is absolute instead of a fraction of the
  // baseline 1 + alpha, such as a mass that may have been added; empty: none.
  std::vector<bool> absolute;
  // Loss in twice the log-likelihood below which another explanation is a rival
  // of a found change: odds of 20 (R. E. Kass and A. E. Raftery, J. Amer.
  // Statist. Assoc. 90 (1995) 773-795).
  double rival_loss = 6.0;

  // On failure *error names the option and the violated constraint.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

struct GroupChange {
  // Change as a fraction of the baseline value: -0.1, a tenth of it lost. A
  // changed group is refitted with the others that changed, any other group as
  // if it had changed together with them.
  double change = 0.0;
  double sigma = 0.0;  // its standard deviation
  double lower95 = 0.0;
  double upper95 = 0.0;
  // Probability P(loss > threshold).
  double probability = 0.0;
  // True if "no change" is rejected at the family-wise false-alarm rate.
  bool changed = false;
  // Adjusted p-value of that test: the smallest family-wise rate at which the
  // group counts as changed, given the groups found before it.
  double p_value = 1.0;
};

// Rival explanation: a change of group `other` (not found) in place of group
// `found` explains the data nearly as well.
struct RivalChange {
  int found = 0;
  int other = 0;
  double loss = 0.0;  // in twice the log-likelihood
};

// Set of changes that explains the new records alone, everything else as in
// the baselines, and was fitted to them.
struct ChangeExplanation {
  std::vector<int> changed;
  std::vector<GroupChange> changes;  // of `changed`
  // Logarithm of the odds against the likeliest explanation, 0 or less.
  double log_odds = 0.0;
  // Probability among all sets that were fitted, a priori equal.
  double probability = 0.0;
};

struct ChangeEstimate {
  std::vector<GroupChange> groups;
  std::vector<RivalChange> rivals;  // least loss first
  // Standard deviation of each baseline value from record to record beyond its
  // covariance, in the units of its change; zero with one baseline.
  Vector between_records;
  // True with several baselines, so that the differences between records are
  // included.
  bool has_between_records = false;
  // Test of "nothing but the groups found has changed": chi^2 and number of
  // groups left.
  double unexplained_chi2 = 0.0;
  int unexplained_degrees = 0;
  // Explanations with at least a twentieth of the odds of the likeliest, which
  // comes first and has the values of `groups`. Empty: none was fitted.
  std::vector<ChangeExplanation> explanations;
};

// Prediction of a new record by the baselines if nothing has changed.
struct PooledBaselines {
  // Expected values and their covariance, with the differences between records.
  GroupState state;
  // Variance of each value between records beyond its own covariance.
  Vector between;
  int num_baselines = 0;
  // Cost of the baselines' data at the expected values, and half the logarithm
  // of the determinant of the covariance. Zero if these are the same for all
  // explanations.
  double cost = 0.0;
  double log_volume = 0.0;
};

// Marks entries that are so small in one of the baselines (1 + alpha not above
// a tenth) that they cannot scale their change: dampers of a simple model, for
// instance. For ChangeOptions::absolute. All states have the same size.
std::vector<bool> NearlyGone(const std::vector<GroupState>& healthy);

// Estimates the change of every group from the baselines (at least one, the
// same groups in each) to the current state.
//
// The differences are normal with the covariances of both sides. With several
// baselines the variance between records is added: by moments per group (R.
// DerSimonian and N. Laird, Controlled Clinical Trials 7 (1986) 177-188), never
// below zero. It comes from few records, so that tests and intervals then are
// those of Student's t.
//
// Few groups change at a time. A group that seems to have changed alone has the
// score z_j = (W d)_j / sqrt(W_jj), W the inverse covariance of the differences
// d. The largest |z_j| is compared with its distribution without change. That
// is drawn with the scores' own correlation, so that the false-alarm rate holds
// for all groups together. The group is taken in, the scores of the others are
// conditioned on it, and so on. A group found earlier leaves again if later
// ones explain it. Unlike the LASSO, this has no bias on the groups it keeps
// and a rate that can be stated.
//
// Returns false, with *error, if sizes differ, a covariance is not positive
// definite, or a baseline stiffness is not positive.
[[nodiscard]] bool EstimateChange(const std::vector<GroupState>& healthy,
                                  const GroupState& current,
                                  const ChangeOptions& options,
                                  ChangeEstimate* estimate, std::string* error);

// Pools the baselines as EstimateChange does. Returns false, with *error, if
// sizes differ or a covariance is not positive definite.
[[nodiscard]] bool PoolBaselines(const std::vector<GroupState>& healthy,
                                 PooledBaselines* pooled, std::string* error);

// Finds other explanations of the changes of the groups `found`, whichever
// method found them: exchanges of one of them for one of the others, least loss
// first. Returns false as EstimateChange does.
[[nodiscard]] bool FindRivals(const std::vector<GroupState>& healthy,
                              const GroupState& current,
                              const ChangeOptions& options,
                              const std::vector<int>& found,
                              std::vector<RivalChange>* rivals,
                              std::string* error);

}  // namespace pinode

#endif  // PINODE_DAMAGE_CHANGE_H_
