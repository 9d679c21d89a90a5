// What changed between healthy states and a new one.

#ifndef PINODE_DAMAGE_CHANGE_H_
#define PINODE_DAMAGE_CHANGE_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// Identified factors of a structure's groups with their covariance: alpha of
// K0 + sum_j alpha_j K_j, so that the group has 1 + alpha times its nominal
// stiffness.
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

struct ChangeEstimate {
  std::vector<GroupChange> groups;
  // Deviation of each healthy value from record to record beyond what its
  // covariance says, as a fraction; zero with one healthy state.
  Vector between_records;
  // Whether there are several healthy states, so that records' own differences
  // have entered.
  bool has_between_records = false;
  // chi^2 of "nothing but the groups found has changed" and the number of
  // groups left: what the found ones do not explain.
  double unexplained_chi2 = 0.0;
  int unexplained_degrees = 0;
};

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

}  // namespace pinode

#endif  // PINODE_DAMAGE_CHANGE_H_
