// Sets of changes that explain new records, each fitted on its own.

#ifndef PINODE_STUDY_DAMAGE_CHANGE_EXPLANATIONS_H_
#define PINODE_STUDY_DAMAGE_CHANGE_EXPLANATIONS_H_

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "pinode/damage/change.h"
#include "pinode/study/damage/change_candidates.h"
#include "pinode/study/damage/change_refit.h"

namespace pinode {

// Entries below are those of groups, then of all candidates.
struct ExplainedChange {
  // The likeliest first. `changed` has entries; those that are not listed have
  // less than a twentieth of the odds of the first, or contain more than the
  // records ask for.
  std::vector<ChangeExplanation> explanations;
  // Changes of all groups beside the first explanation: of one that has not
  // changed, as if it had changed too.
  std::vector<GroupChange> groups;
};

// Search for sets of changes. Refits of single groups and of exchanges in the
// set that was found are ranked by what a linearisation says that they gain.
// The best is extended while an addition is significant.
//
// The odds of a set of k changes among n possible ones are its evidence
// (ChangePosterior::log_evidence) times n^-k.
class ChangeExplanations {
 public:
  // Computes the states of the baselines with these candidates after the
  // groups.
  using StatesOfBaselines = std::function<bool(
      const std::vector<ChangeCandidate>&, std::vector<GroupState>*)>;

  // All must outlive this object. `absolute`: groups whose change is no
  // fraction. `near`: see ChangeRefitter::Refit.
  ChangeExplanations(ChangeRefitter* refitter,
                     const std::vector<bool>& absolute,
                     const std::vector<ChangeCandidate>& candidates,
                     StatesOfBaselines states, BaselinesNear near,
                     const ChangeOptions& options);

  // Explains what has changed. `found`: the entries that a test found.
  // `exchanges`: pairs (a found entry, another one) worth a refit. `thorough`:
  // fits are cheap, so that all single groups are refitted. Returns false if
  // `found` cannot be refitted.
  [[nodiscard]] bool Run(const std::vector<int>& found,
                         const std::vector<std::pair<int, int>>& exchanges,
                         bool thorough, ExplainedChange* result);

 private:
  struct Refit {
    std::vector<int> entries;  // ascending
    std::vector<int> changed;  // the same in the model
    std::vector<ChangeCandidate> candidates;
    ChangeRefit fit;
    double log_odds = 0.0;
  };

  int num_groups() const { return static_cast<int>(absolute_.size()); }
  bool ModelFor(const std::vector<ChangeCandidate>& candidates,
                ChangeModel* model);
  bool Try(std::vector<int> entries, const Refit* from);
  const Refit* Find(std::vector<int> entries) const;
  const Refit* Best() const;
  void TrySingles(bool thorough);
  void Extend();
  // Returns the changes of a refit that are left when those that are not needed
  // are taken away one by one, by its linearisation.
  std::vector<int> NeededOf(const Refit& refit) const;
  // p-value of the least needed change of a refit, for all entries together.
  double LeastNeeded(const Refit& refit, int* entry);
  double FamilyWise(double gain) const;
  void Report(ExplainedChange* result);

  ChangeRefitter& refitter_;
  const std::vector<bool>& absolute_;
  const std::vector<ChangeCandidate>& candidates_;
  const StatesOfBaselines states_;
  const BaselinesNear near_;
  const ChangeOptions& options_;
  std::vector<Refit> refits_;
  std::vector<std::vector<int>> tried_;
  // Several baselines differ by more than their intervals: no further change
  // can be tested by intervals.
  bool between_ = false;
};

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_CHANGE_EXPLANATIONS_H_
