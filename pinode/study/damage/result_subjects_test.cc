#include "pinode/study/damage/result_subjects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

// Two groups and three candidates, the last of which was found.
class ResultSubjectsTest : public ::testing::Test {
 protected:
  ResultSubjectsTest() {
    for (const char* name : {"mass.u1", "damping.k1", "mass.u2"}) {
      ChangeCandidate candidate;
      candidate.subject.name = name;
      candidates_.push_back(candidate);
    }
    subjects_.resize(2);
    subjects_[0].name = "k1";
    subjects_[1].name = "k2";
    subjects_.push_back(candidates_[2].subject);
    estimate_.groups.resize(3);
    estimate_.between_records = Vector::Constant(3, 0.1);
    estimate_.groups[1].changed = estimate_.groups[2].changed = true;
  }

  std::vector<ChangeCandidate> candidates_;
  std::vector<ChangeSubject> subjects_;
  ChangeEstimate estimate_;
  ResultSubjects all_{2, &candidates_, &subjects_, &estimate_};
};

TEST_F(ResultSubjectsTest, EntriesHaveAllCandidatesAfterTheGroups) {
  EXPECT_EQ(all_.EntryOf(1), 1);
  EXPECT_EQ(all_.EntryOf(2), 4);
  EXPECT_EQ(all_.SubjectOf(1), 1);
  EXPECT_EQ(all_.SubjectOf(4), 2);
  EXPECT_EQ(subjects_.size(), 3u);
  EXPECT_THAT(all_.ChangedEntries(), ElementsAre(1, 4));
}

TEST_F(ResultSubjectsTest, ARivalBecomesASubjectOnce) {
  all_.SetRivals({{4, 2, 0.5}, {1, 2, 0.7}});
  ASSERT_EQ(subjects_.size(), 4u);
  EXPECT_EQ(subjects_[3].name, "mass.u1");
  ASSERT_EQ(estimate_.groups.size(), 4u);
  EXPECT_FALSE(estimate_.groups[3].changed);
  ASSERT_EQ(estimate_.between_records.size(), 4);
  EXPECT_EQ(estimate_.between_records[2], 0.1);
  EXPECT_EQ(estimate_.between_records[3], 0.0);
  ASSERT_EQ(estimate_.rivals.size(), 2u);
  EXPECT_EQ(estimate_.rivals[0].found, 2);
  EXPECT_EQ(estimate_.rivals[0].other, 3);
  EXPECT_EQ(estimate_.rivals[1].loss, 0.7);
  EXPECT_THAT(all_.RivalEntries(), ElementsAre(Pair(4, 2), Pair(1, 2)));
  all_.SetRivals({});
  EXPECT_THAT(all_.RivalEntries(), IsEmpty());
}

// The likeliest explanation has k1 instead of k2 and the mass, the other one
// k1 and damping.
TEST_F(ResultSubjectsTest, TakesOverTheLikeliestExplanation) {
  ExplainedChange explained;
  explained.groups.resize(2);
  explained.groups[1].change = 0.01;
  explained.explanations.resize(2);
  ChangeExplanation& first = explained.explanations[0];
  first.changed = {0, 4};
  first.changes.resize(2);
  first.changes[0].change = -0.2;
  first.changes[1].change = 0.3;
  first.changes[0].changed = first.changes[1].changed = true;
  ChangeExplanation& other = explained.explanations[1];
  other.changed = {0, 3};
  other.changes.resize(2);
  other.log_odds = -1.5;
  all_.TakeOver(explained);

  ASSERT_EQ(subjects_.size(), 4u);
  EXPECT_EQ(subjects_[3].name, "damping.k1");
  EXPECT_EQ(estimate_.groups[0].change, -0.2);
  EXPECT_EQ(estimate_.groups[1].change, 0.01);
  EXPECT_EQ(estimate_.groups[2].change, 0.3);
  EXPECT_THAT(all_.ChangedEntries(), ElementsAre(0, 4));
  ASSERT_EQ(estimate_.explanations.size(), 2u);
  EXPECT_THAT(estimate_.explanations[0].changed, ElementsAre(0, 2));
  EXPECT_THAT(estimate_.explanations[1].changed, ElementsAre(0, 3));
  // k1 is in both, so that only the mass and the damping stand for each other.
  ASSERT_EQ(estimate_.rivals.size(), 1u);
  EXPECT_EQ(estimate_.rivals[0].found, 2);
  EXPECT_EQ(estimate_.rivals[0].other, 3);
  EXPECT_EQ(estimate_.rivals[0].loss, 3.0);
}

}  // namespace
}  // namespace pinode
