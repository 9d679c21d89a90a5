#include "pinode/study/damage/damage_remarks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

ChangeCandidate CandidateOf(const std::string& name, ChangeKind kind) {
  ChangeCandidate candidate;
  candidate.subject.name = name;
  candidate.subject.kind = kind;
  candidate.subject.place = "w";
  return candidate;
}

// The state of stiffness, damping and mass, as logarithms, of which the records
// know stiffness over mass with deviation `ratio`. The prior of the mass, of
// deviation 1, is all that is known of it.
GroupState StateOf(double stiffness, double mass, double ratio) {
  GroupState state;
  state.values = Vector{{stiffness, 0.0, mass}};
  state.covariance = Matrix{
      {1.0 + ratio * ratio, 0.0, 1.0}, {0.0, 0.01, 0.0}, {1.0, 0.0, 1.0}};
  return state;
}

std::vector<std::string> RemarksOf(const GroupState& healthy,
                                   const GroupState& current, bool is_found) {
  const std::vector<ChangeCandidate> candidates = {
      CandidateOf("mass.w", ChangeKind::kMass)};
  std::vector<std::string> remarks;
  RemarkMassInstead(healthy, current, {"k", "c"}, candidates,
                    is_found ? candidates : std::vector<ChangeCandidate>(),
                    &remarks);
  return remarks;
}

// Half of a loss of 17.5 % is with the stiffness and half with the mass. The
// deviation of the ratio's change is sqrt(2) times 0.001.
TEST(RemarkMassInstead, HasTheChangeWithoutThatOfTheMass) {
  const double change = std::log(1.0 - 0.175);
  const GroupState healthy = StateOf(0.0, 0.0, 0.001);
  const GroupState current = StateOf(0.5 * change, -0.5 * change, 0.001);
  EXPECT_THAT(RemarksOf(healthy, current, true),
              ElementsAre(AllOf(HasSubstr("'k' from the mass at w"),
                                HasSubstr("-17.5 % (-17.7 to -17.3 %)"))));
  EXPECT_THAT(RemarksOf(healthy, current, false), IsEmpty());
}

// Records that tell the two apart need no remark.
TEST(RemarkMassInstead, IsSilentWhereTheyAreToldApart) {
  EXPECT_THAT(RemarksOf(StateOf(0.0, 0.0, 0.5), StateOf(-0.1, 0.1, 0.5), true),
              IsEmpty());
}

}  // namespace
}  // namespace pinode
