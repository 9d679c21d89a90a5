// From changes to what is said about a structure.

#ifndef PINODE_DAMAGE_VERDICT_H_
#define PINODE_DAMAGE_VERDICT_H_

#include <string>
#include <vector>

#include "pinode/damage/change.h"
#include "pinode/structure/structural_model.h"

namespace pinode {

enum class DamageVerdict { kNoDamage, kDamage, kOtherChange, kCannotTell };

// "no_damage", "damage", "other_change", "cannot_tell".
const char* DamageVerdictName(DamageVerdict verdict);

// Why a group's change counts, or does not.
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
};

struct Judgement {
  DamageVerdict verdict = DamageVerdict::kCannotTell;
  std::vector<Reason> reasons;  // per group
  std::string sentence;
};

// `names` and `targets` of the groups, as many as in `estimate`.
//
//   damage        a stiffness group has lost stiffness, beyond the threshold or
//                 against the differences between records
//   other_change  as much of damping, mass or a gain of stiffness, and no
//   damage cannot_tell   neither, but a stiffness group may have lost more than
//   the
//                 threshold with more than 5 % probability
//   no_damage     neither, and none may
Judgement JudgeChange(const std::vector<std::string>& names,
                      const std::vector<MatrixGroup::Target>& targets,
                      const ChangeEstimate& estimate,
                      const ChangeOptions& options);

}  // namespace pinode

#endif  // PINODE_DAMAGE_VERDICT_H_
