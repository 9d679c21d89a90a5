// Verdict on a structure from its changes.

#ifndef PINODE_DAMAGE_VERDICT_H_
#define PINODE_DAMAGE_VERDICT_H_

#include <string>
#include <vector>

#include "pinode/damage/change.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

enum class DamageVerdict {
  kNoDamage,
  kDamage,
  kNonlinear,
  kOtherChange,
  kCannotTell
};

// Returns "no_damage", "damage", "nonlinear", "other_change" or "cannot_tell".
const char* DamageVerdictName(DamageVerdict verdict);

enum class ChangeKind { kStiffness, kDamping, kMass, kNonlinear };

// Returns "stiffness", "damping", "mass" or "nonlinear".
const char* ChangeKindName(ChangeKind kind);
ChangeKind KindOf(MatrixGroup::Target target);

// Subject of a possible change: an entry of a ChangeEstimate.
struct ChangeSubject {
  std::string name;  // of the parameter
  ChangeKind kind = ChangeKind::kStiffness;
  // Place of kMass and kNonlinear, modes of kDamping, if they are no groups of
  // the user's.
  std::string place;
  std::string dof;  // kNonlinear: "u1", or "u1-u2" of a force between two
  // RMS of the force as a fraction of the restoring force's; kNonlinear only.
  double force_share = 0.0;
};

// Reason for which a change counts, or does not.
enum class Reason {
  kNone,
  // Change beyond the threshold with 95 % probability.
  kBeyondThreshold,
  // Significant compared with the differences between baselines.
  kBetweenRecords,
  // Significant by the intervals alone: with one baseline the normal scatter is
  // unknown.
  kFormal,
  // Loss beyond the threshold neither shown nor ruled out.
  kUndetermined,
  // Change of another kind explains the data nearly as well.
  kAmbiguous,
  // Much more motion is unexplained than in the baselines: the change may be a
  // side effect of another cause.
  kUnexplained,
  // The change is smaller than the share of the motion that the model misses,
  // of healthy records too, and one baseline does not show how much that moves.
  kModelError,
  // With one baseline: another explanation of what one of the two fits misses
  // reaches as far as the change.
  kOtherExplanation,
};

// Unexplained motion of a model, without noise, as fractions.
struct MissedMotion {
  double healthy = 0.0;  // of the baselines
  double groups = 0.0;   // of the new records, with groups alone
  double last = 0.0;     // with all found changes; 0: unknown
  // Per subject, true if the intervals of the two fits overlap, as wide as
  // other explanations of what they miss reach. Empty: for none.
  std::vector<bool> within_doubt = {};

  // True if much more is unexplained than in the baselines: part of the change
  // in the structure, its loads or its sensors is of a kind that was not
  // examined.
  bool IsMore() const;
  // True if one baseline cannot show a change of this size: the model misses a
  // larger share of the motion, and what it misses depends on the motion.
  bool Hides(double change) const;
  // True if a nonlinear force with this share of the restoring force is
  // confirmed. It must explain much of the motion that groups alone leave, and
  // must not be small compared with the remaining unexplained motion, which may
  // be due to its form.
  bool LeavesForce(double force_share) const;
};

struct Judgement {
  DamageVerdict verdict = DamageVerdict::kCannotTell;
  std::vector<Reason> reasons;  // per subject
  std::string sentence;
};

// Judges the changes, with one subject for each entry of the estimate.
//
//   nonlinear     a nonlinear force has appeared, beyond the threshold or
//                 against the differences between records, and of at least 1 %
//                 of the restoring force
//   damage        otherwise, a loss of stiffness by the same criteria
//   other_change  otherwise, a change of damping or mass, a gain of stiffness,
//                 or a smaller nonlinear force
//   cannot_tell   none of these, but one of them with a rival of another kind,
//                 or a stiffness group that may have lost more than the
//                 threshold with more than 5 % probability; or, whatever was
//                 found, more motion is unexplained; or, with one baseline,
//                 only changes smaller than what the model misses or within
//                 reach of other explanations of it
//   no_damage     none, and none is possible
Judgement JudgeChange(const std::vector<ChangeSubject>& subjects,
                      const ChangeEstimate& estimate,
                      const ChangeOptions& options,
                      const MissedMotion& missed = MissedMotion());

}  // namespace pinode

#endif  // PINODE_DAMAGE_VERDICT_H_
