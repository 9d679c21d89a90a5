// Verdict on the changes of a structure.

#ifndef PINODE_DAMAGE_VERDICT_H_
#define PINODE_DAMAGE_VERDICT_H_

#include <string>
#include <vector>

#include "pinode/damage/change.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {

// Verdict on a structure. JudgeChange defines the values.
enum class DamageVerdict {
  kNoDamage,
  kDamage,
  kNonlinear,
  kOtherChange,
  kCannotTell
};

// Returns "no_damage", "damage", "nonlinear", "other_change" or "cannot_tell".
const char* DamageVerdictName(DamageVerdict verdict);

// Kind of a change, by the part of the model that changes.
enum class ChangeKind { kStiffness, kDamping, kMass, kNonlinear };

// Returns "stiffness", "damping", "mass" or "nonlinear".
const char* ChangeKindName(ChangeKind kind);
// Returns the kind of change of a group that is added to this matrix.
ChangeKind KindOf(MatrixGroup::Target target);

// Subject of a possible change: describes one entry of a ChangeEstimate.
struct ChangeSubject {
  std::string name;  // name of the parameter
  // Kind of the change.
  ChangeKind kind = ChangeKind::kStiffness;
  // Place of a mass or of a nonlinear force, or the modes whose damping
  // changes. Empty for groups that the user has defined.
  std::string place;
  // DOFs of a nonlinear force: "u1", or "u1-u2" for a force between two DOFs.
  // Empty for other kinds.
  std::string dof;
  // RMS of a nonlinear force as a fraction of the RMS of the restoring force. 0
  // for other kinds.
  double force_share = 0.0;
};

// Reason for which a change counts, or does not.
enum class Reason {
  kNone,
  // Change beyond the threshold with 95 % probability.
  kBeyondThreshold,
  // Change significant compared with the differences between baselines.
  kBetweenRecords,
  // Change significant by the intervals alone. With one baseline the normal
  // scatter is unknown.
  kFormal,
  // Loss beyond the threshold is neither shown nor ruled out.
  kUndetermined,
  // Change of another kind explains the data nearly as well.
  kAmbiguous,
  // Unexplained motion is much larger than in the baselines. The change may be
  // a side effect of another cause.
  kUnexplained,
  // Change smaller than the unexplained share of the motion, which is large in
  // the baseline too. One baseline does not show how much this share varies.
  kModelError,
  // Change that may come from the unexplained motion of one of the two fits:
  // another explanation of this motion shifts the group as far. Only with one
  // baseline.
  kOtherExplanation,
  // Change between records at different levels of motion, or at levels that
  // cannot be compared. The model leaves motion unexplained, so that the change
  // may come from the level.
  kOtherLevel,
};

// Unexplained motion: RMS error of the simulation without the part due to
// noise, as a fraction of the RMS of the measured motion. Each value is the
// largest of the records.
struct MissedMotion {
  // Value in the baselines.
  double healthy = 0.0;
  // Value in the new records if only groups change.
  double groups = 0.0;
  // Value in the new records with all found changes. 0: unknown.
  double last = 0.0;
  // One flag per subject. It is true if the intervals of baseline and new state
  // overlap after widening by other explanations of the unexplained motion.
  // Empty: false for all.
  std::vector<bool> within_doubt = {};
  // True if another solution describes the data of a baseline as well, or those
  // of the new records without being among the explanations. No number of
  // baselines decides between mirrored solutions.
  bool other_solution = false;
  // One flag per subject. It is true if an added mass explains what changed
  // about as well, whatever the number of baselines. Empty: false for all.
  std::vector<bool> mass_instead = {};
  // One flag per subject. It is true in two cases:
  // - a stiffness may have lost more than the threshold, if the mass that was
  //   found is in fact unchanged;
  // - changes of masses and damping say the same as this loss of stiffness.
  // Empty: false for all.
  std::vector<bool> loss_instead = {};

  // True if motion is unexplained, and the new records are at another level of
  // motion than all baselines.
  bool other_level = false;
  // True if motion is unexplained, and no sensor shows how the levels compare.
  bool unknown_level = false;
  // True if changes count at another level, because one explanation holds for
  // both sides, but some group may have lost more than the threshold with it.
  bool level_hides_loss = false;

  // True if `last` is above 2 % and above three times `healthy`. The structure,
  // its loads or its sensors then have changed in a way that was not examined.
  bool IsMore() const;
  // True if the level of motion may hide a loss.
  bool MayHideLoss() const;
  // True if one baseline cannot show a change of this size (a fraction). The
  // unexplained share of the motion is then above 10 % and above the change.
  // Unexplained motion depends on the motion, and so differs between records.
  bool Hides(double change) const;
  // True if a nonlinear force with this share of the restoring force is
  // confirmed. It must explain at least 30 % of the motion that groups alone
  // leave unexplained. It must also be above 40 % of the motion that then
  // remains unexplained, which may be due to its form.
  bool LeavesForce(double force_share) const;
};

// Result of JudgeChange.
struct Judgement {
  DamageVerdict verdict = DamageVerdict::kCannotTell;
  std::vector<Reason> reasons;  // one per subject
  // Verdict in words, with numbers, reason and next step.
  std::string sentence;
};

// Judges the changes. `subjects` has one entry for each group of the estimate.
// `missed` is the unexplained motion; the default stands for none. The first
// line that applies is the verdict:
//
//   nonlinear     A nonlinear force was found: beyond the threshold, or
//                 significant against the differences between baselines. It is
//                 at least 1 % of the restoring force.
//   damage        A loss of stiffness was found by the same criteria.
//   other_change  A change of damping or mass, a gain of stiffness, or a
//                 smaller nonlinear force was found.
//   cannot_tell   A change may exist but does not count as found, see below.
//                 Or a stiffness group may have lost more than the threshold,
//                 with more than 5 % probability. Or the level of motion may
//                 hide a loss: it is another one or unknown, and motion is
//                 unexplained.
//   no_damage     No change was found. For each group, a loss beyond the
//                 threshold has a probability of at most 5 %.
//
// These changes do not count as found:
// - a change with a rival of another kind;
// - any change, if more motion is unexplained than in the baselines
//   (MissedMotion::IsMore), except a nonlinear force that
//   MissedMotion::LeavesForce confirms;
// - any change between different or unknown levels of motion, if some motion is
//   unexplained;
// - with one baseline, a change that is smaller than the unexplained motion, or
//   within reach of other explanations of this motion.
Judgement JudgeChange(const std::vector<ChangeSubject>& subjects,
                      const ChangeEstimate& estimate,
                      const ChangeOptions& options,
                      const MissedMotion& missed = MissedMotion());

}  // namespace pinode

#endif  // PINODE_DAMAGE_VERDICT_H_
