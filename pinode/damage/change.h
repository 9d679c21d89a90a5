// What changed between healthy states and a new one.

#ifndef PINODE_DAMAGE_CHANGE_H_
#define PINODE_DAMAGE_CHANGE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Identified factors of a structure's groups with their covariance: alpha of
// K0 + sum_j alpha_j K_j, so that the group has 1 + alpha times its nominal
// stiffness. Other unknowns that may change can stand among them, see
// ChangeOptions::absolute.
struct GroupState {
  Vector values;
  Matrix covariance;
};

struct ChangeOptions {
  // Loss from which damage is called, as a fraction of the healthy stiffness.
  double threshold = 0.05;
  // Probability of calling any change where there is none.
  double false_alarm_rate = 0.05;
  // Random draws for the distribution of the largest statistic.
  int num_draws = 20000;
  // Entries whose change is wanted as it is and not as a fraction of the
  // healthy 1 + alpha, such as a mass that may have been added; empty: none.
  std::vector<bool> absolute;
  // Another explanation counts as a rival of a found change where it loses less
  // than this in twice the log-likelihood: odds of 20 (R. E. Kass and A. E.
  // Raftery, J. Amer. Statist. Assoc. 90 (1995) 773-795).
  double rival_loss = 6.0;

  // On failure *error names the option and the violated constraint.
  [[nodiscard]] bool IsValid(std::string* error) const;
};

struct GroupChange {
  // Fraction of the healthy value: -0.1, a tenth of it lost. Of a changed group
  // refitted with the others that changed, of another one as if it had changed
  // beside them.
  double change = 0.0;
  double sigma = 0.0;  // its standard deviation
  double lower95 = 0.0;
  double upper95 = 0.0;
  // P(loss > threshold).
  double probability = 0.0;
  // "No change" is rejected at the family-wise false-alarm rate.
  bool changed = false;
  // Adjusted p-value of that test: the smallest family-wise rate at which the
  // group counts as changed, given those that were found before it.
  double p_value = 1.0;
};

// The data explain themselves nearly as well with a change of group `other`
// (not found) in place of that of group `found`.
struct RivalChange {
  int found = 0;
  int other = 0;
  double loss = 0.0;  // in twice the log-likelihood
};

struct ChangeEstimate {
  std::vector<GroupChange> groups;
  std::vector<RivalChange> rivals;  // least loss first
  // Deviation of each healthy value from record to record beyond what its
  // covariance says, as its change; zero with one healthy state.
  Vector between_records;
  // Whether there are several healthy states, so that records' own differences
  // have entered.
  bool has_between_records = false;
  // chi^2 of "nothing but the groups found has changed" and the number of
  // groups left: what the found ones do not explain.
  double unexplained_chi2 = 0.0;
  int unexplained_degrees = 0;
};

// Of which entries so little is there in one of the healthy states (1 + alpha
// not above a tenth) that it is no measure of their change: dampers of a simple
// model, for instance. For ChangeOptions::absolute. All states have the same
// size.
std::vector<bool> NearlyGone(const std::vector<GroupState>& healthy);

// The change of every group from the healthy states (at least one, the same
// groups in each) to the current one.
//
// The differences are normal with the covariances of both sides, and, with
// several healthy states, the variance between records: by moments per group
// (R. DerSimonian and N. Laird, Controlled Clinical Trials 7 (1986) 177-188),
// never below zero. Because it comes from few records, tests and intervals then
// are those of Student's t.
//
// Few groups change at a time. A group that seems to have changed alone has the
// score z_j = (W d)_j / sqrt(W_jj), W the inverse covariance of the differences
// d. The largest |z_j| is compared with its distribution where nothing changed,
// which is drawn with the scores' own correlation, so that the false-alarm rate
// holds for all groups together; the group is taken in, the scores of the
// others are conditioned on it, and so on. Where a group found earlier is
// explained by later ones it leaves again. Unlike the LASSO this has no bias on
// what it keeps and a rate that can be stated.
//
// False, with *error, where sizes differ, a covariance is not positive
// definite, or a healthy stiffness is not positive.
[[nodiscard]] bool EstimateChange(const std::vector<GroupState>& healthy,
                                  const GroupState& current,
                                  const ChangeOptions& options,
                                  ChangeEstimate* estimate, std::string* error);

// What else would explain the changes of the groups `found`, whatever they were
// found by: exchanges of one of them for one of the others, least loss first.
// False as EstimateChange is.
[[nodiscard]] bool FindRivals(const std::vector<GroupState>& healthy,
                              const GroupState& current,
                              const ChangeOptions& options,
                              const std::vector<int>& found,
                              std::vector<RivalChange>* rivals,
                              std::string* error);

}  // namespace pinode

#endif  // PINODE_DAMAGE_CHANGE_H_
