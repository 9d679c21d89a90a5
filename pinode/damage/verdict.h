// From changes to what is said about a structure.

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

// "no_damage", "damage", "nonlinear", "other_change", "cannot_tell".
const char* DamageVerdictName(DamageVerdict verdict);

enum class ChangeKind { kStiffness, kDamping, kMass, kNonlinear };

// "stiffness", "damping", "mass", "nonlinear".
const char* ChangeKindName(ChangeKind kind);
ChangeKind KindOf(MatrixGroup::Target target);

// What may have changed: an entry of a ChangeEstimate.
struct ChangeSubject {
  std::string name;  // of the parameter
  ChangeKind kind = ChangeKind::kStiffness;
  // Where, for kMass and kNonlinear that are no groups of the user's.
  std::string place;
  std::string dof;  // kNonlinear: "u1", or "u1-u2" of a force between two
  // kNonlinear: RMS of its force as a fraction of the restoring force's.
  double force_share = 0.0;
};

// Why a change counts, or does not.
enum class Reason {
  kNone,
  // Beyond the threshold with 95 % probability.
  kBeyondThreshold,
  // Significant against the differences between healthy records.
  kBetweenRecords,
  // Significant by the intervals alone, which do not know how much healthy
  // records differ: formally, no more.
  kFormal,
  // A loss beyond the threshold is neither shown nor ruled out.
  kUndetermined,
  // Something of another kind explains it nearly as well.
  kAmbiguous,
  // Far more than it is missed of the motion: it may stand in for something
  // else.
  kUnexplained,
};

// What a model misses of the motion of records and is no noise, as fractions.
struct MissedMotion {
  double healthy = 0.0;  // by healthy records
  double groups = 0.0;   // of the new ones, with groups alone
  double last = 0.0;     // with all that was found; 0: cannot be told

  // Much more than of healthy records: of what has changed in the structure, in
  // its loads or in its sensors a part is nothing that was looked for.
  bool IsMore() const;
  // A nonlinear force of this part of the restoring force is still one where it
  // explains much of what groups alone miss, and is not small beside what is
  // left, which its form may leave.
  bool LeavesForce(double force_share) const;
};

struct Judgement {
  DamageVerdict verdict = DamageVerdict::kCannotTell;
  std::vector<Reason> reasons;  // per subject
  std::string sentence;
};

// One subject for each entry of the estimate.
//
//   nonlinear     a nonlinear force has appeared, beyond the threshold or
//                 against the differences between records, and of at least 1 %
//                 of the restoring force
//   damage        else as much of a loss of stiffness
//   other_change  else as much of damping, mass, a gain of stiffness, or a
//                 smaller nonlinear force
//   cannot_tell   none of these, but one of them with a rival of another kind,
//                 or a stiffness group that may have lost more than the
//                 threshold with more than 5 % probability; or, whatever was
//                 found, what is missed of the motion is more
//   no_damage     none, and none may
Judgement JudgeChange(const std::vector<ChangeSubject>& subjects,
                      const ChangeEstimate& estimate,
                      const ChangeOptions& options,
                      const MissedMotion& missed = MissedMotion());

}  // namespace pinode

#endif  // PINODE_DAMAGE_VERDICT_H_
