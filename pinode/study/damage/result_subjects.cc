#include "pinode/study/damage/result_subjects.h"

#include <algorithm>

#include "pinode/base/logging.h"

namespace pinode {

ResultSubjects::ResultSubjects(size_t num_groups,
                               const std::vector<ChangeCandidate>* candidates,
                               std::vector<ChangeSubject>* subjects,
                               ChangeEstimate* estimate)
    : num_groups_(num_groups),
      candidates_(*candidates),
      subjects_(*subjects),
      estimate_(*estimate) {}

int ResultSubjects::EntryOf(size_t subject) const {
  if (subject < num_groups_) return static_cast<int>(subject);
  for (size_t j = 0; j < candidates_.size(); ++j) {
    if (candidates_[j].subject.name == subjects_[subject].name) {
      return static_cast<int>(num_groups_ + j);
    }
  }
  LOG(FATAL) << "no candidate is " << subjects_[subject].name;
  return -1;
}

int ResultSubjects::SubjectOf(int entry) {
  if (entry < static_cast<int>(num_groups_)) return entry;
  const ChangeSubject& subject =
      candidates_[static_cast<size_t>(entry) - num_groups_].subject;
  for (size_t j = num_groups_; j < subjects_.size(); ++j) {
    if (subjects_[j].name == subject.name) return static_cast<int>(j);
  }
  subjects_.push_back(subject);
  estimate_.groups.emplace_back();
  Vector& between = estimate_.between_records;
  between.conservativeResize(between.size() + 1);
  between.tail(1).setZero();
  return static_cast<int>(subjects_.size()) - 1;
}

std::vector<int> ResultSubjects::ChangedEntries() const {
  std::vector<int> changed;
  for (size_t j = 0; j < subjects_.size(); ++j) {
    if (estimate_.groups[j].changed) changed.push_back(EntryOf(j));
  }
  return changed;
}

std::vector<std::pair<int, int>> ResultSubjects::RivalEntries() const {
  std::vector<std::pair<int, int>> entries;
  for (const RivalChange& rival : estimate_.rivals) {
    entries.emplace_back(EntryOf(static_cast<size_t>(rival.found)),
                         EntryOf(static_cast<size_t>(rival.other)));
  }
  return entries;
}

void ResultSubjects::SetRivals(const std::vector<RivalChange>& rivals) {
  estimate_.rivals.clear();
  for (const RivalChange& rival : rivals) {
    estimate_.rivals.push_back(
        {SubjectOf(rival.found), SubjectOf(rival.other), rival.loss});
  }
}

void ResultSubjects::TakeOver(const ExplainedChange& explained) {
  for (size_t j = 0; j < num_groups_; ++j) {
    estimate_.groups[j] = explained.groups[j];
  }
  for (size_t j = num_groups_; j < estimate_.groups.size(); ++j) {
    estimate_.groups[j].changed = false;
  }
  for (const ChangeExplanation& explanation : explained.explanations) {
    ChangeExplanation named = explanation;
    for (int& entry : named.changed) entry = SubjectOf(entry);
    estimate_.explanations.push_back(std::move(named));
  }
  const ChangeExplanation& first = estimate_.explanations[0];
  for (size_t k = 0; k < first.changed.size(); ++k) {
    estimate_.groups[static_cast<size_t>(first.changed[k])] = first.changes[k];
  }
  estimate_.rivals.clear();
  for (const ChangeExplanation& other : estimate_.explanations) {
    for (const int one : first.changed) {
      for (const int another : other.changed) {
        const auto& in = [](const ChangeExplanation& set, int entry) {
          return std::count(set.changed.begin(), set.changed.end(), entry) > 0;
        };
        if (in(other, one) || in(first, another)) continue;
        estimate_.rivals.push_back({one, another, -2.0 * other.log_odds});
      }
    }
  }
}

}  // namespace pinode
