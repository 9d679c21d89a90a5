// Changes of masses and damping in place of losses of stiffness, and losses in
// place of masses. Not meant for other layers.

#ifndef PINODE_STUDY_DAMAGE_SCALE_INSTEAD_H_
#define PINODE_STUDY_DAMAGE_SCALE_INSTEAD_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "pinode/damage/change.h"
#include "pinode/study/damage/result_subjects.h"

namespace pinode {

// Sets of changes that are compared by the difference d between two states,
// d ~ N(D delta, W^-1). The columns of D are the directions of a set: an entry
// each, or several entries that change together.
class ChangeSets {
 public:
  struct Fit {
    Vector sizes;  // delta, one per direction
    Matrix covariance;
    // Gain in twice the log-likelihood, r' (D'WD)^-1 r with r = D'Wd.
    double gain = 0.0;
    // Logarithm of the evidence with delta ~ N(0, 1), times n^-k for k
    // directions among n entries, as that of refits (ChangeExplanations):
    //   1/2 r' (D'WD + I)^-1 r - 1/2 log det(D'WD + I) - k log n.
    double log_evidence = 0.0;
  };

  ChangeSets(const PooledBaselines& expected, const GroupState& current);

  Eigen::Index size() const { return right_.size(); }
  // Half width of a 95 % interval in standard deviations, by the differences
  // between the baselines.
  double quantile() const { return quantile_; }
  // Fits the sizes of `directions`, size() x at least 1, linearly independent.
  Fit FitOf(const Matrix& directions) const;

 private:
  Matrix information_;
  Vector right_;
  double quantile_ = 0.0;
};

// Groups and all candidates in the healthy states and the current one, and the
// flags of their entries, see ToLogarithms.
struct ComparedStates {
  const std::vector<GroupState>& healthy;
  const GroupState& current;
  const std::vector<bool>& is_logarithm;
};

// Losses of stiffness and what may stand for them.
struct MassesInstead {
  std::vector<size_t> losses;  // subjects
  std::string what;            // in words, with sizes
  // Logarithm of the odds of masses and damping against the losses.
  double log_odds = 0.0;
};

// Looks for changes that have the same effect as those that were found in
// *subjects. A free decay and a response to ground motion know stiffness and
// damping over mass alone. One loss of 17 % is then the same as a mass and a
// damper of +20 % each. A set counts as the same if it loses less than
// options.rival_loss of twice the log-likelihood.
//
// Masses for losses: one mass and one damping in place of each loss, and one
// factor on all masses and one on all damping in place of all losses. One of
// the other changes that were found may stay beside these factors: with all
// masses 20 % heavier, a spring that lost 28 % is one of several losses. A loss
// that stays there is flagged too unless it is one either way.
// *masses has the likeliest for each loss and for all. The odds decide, for the
// sizes of two changes have to match. Below 20 for a loss, it gets a flag in
// *is_loss, one per subject (MissedMotion::loss_instead). Losses are those of
// groups and of springs in no group.
//
// Losses for masses: a loss of all stiffness in place of several masses, with
// all damping free in both, if there are no more springs than masses. Springs
// that may have lost more than options.threshold get a flag, and the change
// that they have without the masses. One that was found and is lost either way
// gets none (IsLostEitherWay). FindLossesInstead does it for one mass.
//
// Returns false, with *error, if the states cannot be compared.
[[nodiscard]] bool FindScaleInstead(const ComparedStates& states,
                                    const ChangeOptions& options,
                                    ResultSubjects* subjects,
                                    std::vector<bool>* is_loss,
                                    std::vector<MassesInstead>* masses,
                                    std::string* error);

// Appends one remark each: what may stand for a loss, and its odds.
void RemarkMassesInstead(const std::vector<MassesInstead>& instead,
                         const ResultSubjects& subjects,
                         std::vector<std::string>* remarks);

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_SCALE_INSTEAD_H_
