#include "pinode/dynamics/spanned_terms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/group_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Two floors with a stiffness group each and a damping group of the first.
class SpannedTermsTest : public ::testing::Test {
 protected:
  SpannedTermsTest()
      : dynamics_(
            MakeStructuralModel(Matrix::Identity(2, 2), Matrix::Zero(2, 2),
                                2.0 * Matrix::Identity(2, 2)),
            {}) {
    Add("k1", MatrixGroup::Target::kStiffness, SpringMatrix(2, -1, 0), true);
    Add("k2", MatrixGroup::Target::kStiffness, SpringMatrix(2, 0, 1), true);
    Add("c1", MatrixGroup::Target::kDamping, SpringMatrix(2, -1, 0), true);
    Add("fixed", MatrixGroup::Target::kStiffness, SpringMatrix(2, -1, 0),
        false);
    Add("m1", MatrixGroup::Target::kMass, SpringMatrix(2, -1, 0), true);
  }

  void Add(const std::string& name, MatrixGroup::Target target,
           const Matrix& matrix, bool free) {
    GroupTerm term = testing::MakeGroupTerm(name, target, matrix);
    term.alpha.free = free;
    std::string error;
    EXPECT_TRUE(dynamics_.AddGroup(term, &error)) << error;
  }

  std::vector<std::string> SpannedBy(const std::vector<Feature>& features,
                                     const Vector& output) {
    NetworkTerm network;
    network.features = features;
    network.outputs = output;
    network.acts_as = ActsAs::kForce;
    return SpannedTerms(dynamics_, network);
  }

  StructuralDynamics dynamics_;
};

TEST_F(SpannedTermsTest, AreThoseThatTheInputsSpanAndTheOutputsShare) {
  const Vector first = Vector::Unit(2, 0);
  EXPECT_THAT(SpannedBy({Feature::Displacement(0)}, first), ElementsAre("k1"));
  EXPECT_THAT(SpannedBy({Feature::Deformation(0, 1)}, first),
              ElementsAre("k2"));
  EXPECT_THAT(
      SpannedBy({Feature::Displacement(0), Feature::Displacement(1)}, first),
      ElementsAre("k1", "k2"));
  EXPECT_THAT(SpannedBy({Feature::Velocity(0)}, first), ElementsAre("c1"));
  // The network depends on the spring of the first floor and drives the second.
  EXPECT_THAT(SpannedBy({Feature::Displacement(0)}, Vector::Unit(2, 1)),
              IsEmpty());
  EXPECT_THAT(SpannedBy({Feature::Time()}, first), IsEmpty());
}

}  // namespace
}  // namespace pinode
