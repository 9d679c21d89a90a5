#include "pinode/study/damage/damage_remarks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "pinode/study/damage/wide_state.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

ChangeCandidate CandidateOf(const std::string& name, ChangeKind kind) {
  ChangeCandidate candidate;
  candidate.subject.name = name;
  candidate.subject.kind = kind;
  candidate.subject.place = "w";
  return candidate;
}

ChangeSubject SubjectOf(const std::string& name, ChangeKind kind) {
  ChangeSubject subject;
  subject.name = name;
  subject.kind = kind;
  return subject;
}

// The state of stiffness, damping and mass, as logarithms, of which the records
// know stiffness over mass with deviation `ratio`, and damping over mass twice
// as well. The prior of the mass, of deviation 1, is all that is known of it.
GroupState StateOf(double stiffness, double mass, double ratio) {
  GroupState state;
  state.values = Vector{{stiffness, mass, mass}};
  state.covariance = Matrix::Ones(3, 3);
  state.covariance(0, 0) += ratio * ratio;
  state.covariance(1, 1) += 0.25 * ratio * ratio;
  return state;
}

std::vector<std::string> RemarksOf(const GroupState& healthy,
                                   const GroupState& current, bool is_found,
                                   ChangeKind second = ChangeKind::kDamping) {
  const std::vector<ChangeCandidate> candidates = {
      CandidateOf("mass.w", ChangeKind::kMass)};
  std::vector<std::string> remarks;
  RemarkMassInstead(
      healthy, current, {true, true, true},
      {SubjectOf("k", ChangeKind::kStiffness), SubjectOf("c", second)},
      candidates, is_found ? candidates : std::vector<ChangeCandidate>(),
      &remarks);
  return remarks;
}

// Half of a loss of 17.5 % is with the stiffness and half with the mass. The
// deviation of the ratio's change is sqrt(2) times 0.001. Damping follows the
// mass as closely, but no remark is of it.
TEST(RemarkMassInstead, HasTheChangeWithoutThatOfTheMass) {
  const double change = std::log(1.0 - 0.175);
  const GroupState healthy = StateOf(0.0, 0.0, 0.001);
  const GroupState current = StateOf(0.5 * change, -0.5 * change, 0.001);
  EXPECT_THAT(
      RemarksOf(healthy, current, true),
      ElementsAre(AllOf(
          HasSubstr("'k' from the mass at w"),
          HasSubstr("-17.5 % (95 % interval -17.7 to -17.3 %)"),
          HasSubstr("scatter between records is not included"),
          HasSubstr("kinds = [\"damping\", \"stiffness\", \"nonlinear\"]"))));
  EXPECT_THAT(RemarksOf(healthy, current, false), IsEmpty());
}

// Two springs that the same mass may stand for have one remark.
TEST(RemarkMassInstead, JoinsTheGroupsOfAMass) {
  EXPECT_THAT(
      RemarksOf(StateOf(0.0, 0.0, 0.001), StateOf(-0.1, 0.1, 0.001), true,
                ChangeKind::kStiffness),
      ElementsAre(AllOf(HasSubstr("do not tell 'k', 'c' from the mass at w"),
                        HasSubstr("'k' has changed by -18.1 %"),
                        HasSubstr("'c' has changed by 0 %"))));
}

// Several masses have a remark each, and the last has the advice.
TEST(RemarkMassInstead, AdvisesOnce) {
  const std::vector<ChangeCandidate> masses = {
      CandidateOf("mass.w", ChangeKind::kMass),
      CandidateOf("mass.v", ChangeKind::kMass)};
  GroupState healthy = StateOf(0.0, 0.0, 0.001);
  std::vector<std::string> remarks;
  RemarkMassInstead(healthy, StateOf(-0.1, 0.1, 0.001), {true, true, true},
                    {SubjectOf("k", ChangeKind::kStiffness)}, masses, masses,
                    &remarks);
  EXPECT_THAT(remarks, ElementsAre(Not(HasSubstr("damage.kinds")),
                                   HasSubstr("damage.kinds")));
}

// A group that is nearly gone in the new state has no logarithm: its alpha of
// -0.92 is no change of -60 %.
TEST(RemarkMassInstead, LeavesOutWhatIsNearlyGone) {
  const std::vector<ChangeCandidate> candidates = {
      CandidateOf("mass.w", ChangeKind::kMass)};
  const std::vector<ChangeSubject> groups = {
      SubjectOf("k", ChangeKind::kStiffness),
      SubjectOf("c", ChangeKind::kStiffness)};
  for (const double alpha : {-0.92, -0.1}) {
    std::vector<GroupState> states = {StateOf(0.0, 0.0, 0.001),
                                      StateOf(alpha, 0.0, 0.001)};
    const std::vector<bool> is_logarithm =
        ToLogarithms(groups.size(), candidates, &states);
    EXPECT_THAT(is_logarithm, ElementsAre(alpha > -0.9, true, true));
    std::vector<std::string> remarks;
    RemarkMassInstead(states[0], states[1], is_logarithm, groups, candidates,
                      candidates, &remarks);
    ASSERT_EQ(remarks.size(), 1u);
    EXPECT_EQ(remarks[0].find("'k'") != std::string::npos, alpha > -0.9)
        << remarks[0];
  }
}

// Records that tell the two apart need no remark.
TEST(RemarkMassInstead, IsSilentWhereTheyAreToldApart) {
  GroupState healthy = StateOf(0.0, 0.0, 0.5),
             current = StateOf(-0.1, 0.1, 0.5);
  EXPECT_THAT(RemarksOf(healthy, current, true), IsEmpty());
}

// More than 2 % and three times what the baselines leave.
TEST(RemarkWhatIsMissed, IsSilentUnlessTheBaselinesLeaveLess) {
  MissedMotion missed;
  missed.healthy = 0.02;
  missed.last = 0.05;
  std::vector<std::string> remarks;
  RemarkWhatIsMissed(missed, &remarks);
  EXPECT_THAT(remarks, IsEmpty());
  missed.last = 0.075;
  RemarkWhatIsMissed(missed, &remarks);
  EXPECT_THAT(remarks, ElementsAre(AllOf(HasSubstr("7.5 % is unexplained"),
                                         HasSubstr("baselines' 2 %"))));
}

}  // namespace
}  // namespace pinode
