// Subjects of a result among all groups and candidates that were compared.

#ifndef PINODE_STUDY_DAMAGE_RESULT_SUBJECTS_H_
#define PINODE_STUDY_DAMAGE_RESULT_SUBJECTS_H_

#include <cstddef>
#include <utility>
#include <vector>

#include "pinode/damage/change.h"
#include "pinode/damage/verdict.h"
#include "pinode/study/damage/change_candidates.h"
#include "pinode/study/damage/change_explanations.h"

namespace pinode {

// Subjects of a result with their changes. The searches number the groups and
// then all candidates: their entries. A result has the groups and then few
// candidates, those that were found and their rivals: its subjects.
class ResultSubjects {
 public:
  // All must outlive this object. The first `num_groups` of *subjects are the
  // groups; *estimate has an entry for each subject.
  ResultSubjects(size_t num_groups,
                 const std::vector<ChangeCandidate>* candidates,
                 std::vector<ChangeSubject>* subjects,
                 ChangeEstimate* estimate);

  size_t num_groups() const { return num_groups_; }
  const std::vector<ChangeCandidate>& candidates() const { return candidates_; }
  const std::vector<ChangeSubject>& subjects() const { return subjects_; }
  const ChangeEstimate& estimate() const { return estimate_; }
  ChangeEstimate* mutable_estimate() { return &estimate_; }

  // Returns the entry of a subject. Candidates go by their names.
  int EntryOf(size_t subject) const;
  // Returns the subject of an entry. A candidate that was not one becomes one.
  int SubjectOf(int entry);
  // Returns the entries of the subjects that have changed.
  std::vector<int> ChangedEntries() const;
  // Returns the entries of the rivals, as pairs (found, other).
  std::vector<std::pair<int, int>> RivalEntries() const;
  // Replaces the rivals by `rivals`, which are of entries.
  void SetRivals(const std::vector<RivalChange>& rivals);
  // Replaces changes, explanations and rivals by those of `explained`.
  void TakeOver(const ExplainedChange& explained);

 private:
  const size_t num_groups_;
  const std::vector<ChangeCandidate>& candidates_;
  std::vector<ChangeSubject>& subjects_;
  ChangeEstimate& estimate_;
};

}  // namespace pinode

#endif  // PINODE_STUDY_DAMAGE_RESULT_SUBJECTS_H_
