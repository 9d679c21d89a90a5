#include "pinode/structure/model/mode_comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pinode/base/constants.h"

namespace pinode {
namespace {

StructuralModel TwoMasses(double first, double second) {
  const Matrix stiffness =
      first * SpringMatrix(2, -1, 0) + second * SpringMatrix(2, -1, 1);
  return MakeStructuralModel(Matrix::Identity(2, 2), Matrix::Zero(2, 2),
                             stiffness);
}

TEST(ModeComparison, FollowsModesThatChangePlaces) {
  // Two separate masses: the softer one is stiffened beyond the other.
  std::vector<ModePair> pairs;
  std::string error;
  ASSERT_TRUE(
      CompareModes(TwoMasses(1.0, 4.0), TwoMasses(9.0, 4.0), &pairs, &error))
      << error;
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_NEAR(pairs[0].initial_frequency, 1.0 / kTwoPi, 1e-12);
  EXPECT_NEAR(pairs[0].updated_frequency, 3.0 / kTwoPi, 1e-12);
  EXPECT_NEAR(pairs[1].updated_frequency, 2.0 / kTwoPi, 1e-12);
  EXPECT_NEAR(pairs[0].mac, 1.0, 1e-12);
  EXPECT_EQ(pairs[0].updated_mode, 1);
  EXPECT_EQ(pairs[1].updated_mode, 0);
}

// A mass that stands on a spring of its own is one mode's effective mass.
// Masses of 1 and 3 change places, for the spring of the first is stiffened.
TEST(ModeComparison, MassesBelongToTheUpdatedModes) {
  const auto with_masses = [](double first) {
    StructuralModel model = TwoMasses(first, 12.0);
    model.mass(1, 1) = 3.0;
    model.directions = {"x", "y"};
    model.influence = Matrix::Zero(2, 2);
    model.influence.col(0).setOnes();
    model.support_mass_coupling = Matrix::Zero(2, 2);
    return model;
  };
  std::vector<ModePair> pairs;
  std::string error;
  ASSERT_TRUE(CompareModes(with_masses(1.0), with_masses(9.0), &pairs, &error))
      << error;
  ASSERT_EQ(pairs.size(), 2u);
  ASSERT_EQ(pairs[0].updated_mass_shares.size(), 2);
  EXPECT_NEAR(pairs[0].updated_mass_shares[0], 0.25, 1e-12);
  EXPECT_NEAR(pairs[1].updated_mass_shares[0], 0.75, 1e-12);
  // Nothing moves along y.
  EXPECT_TRUE(std::isnan(pairs[0].updated_mass_shares[1]));
}

// Three equal masses in a row, two of them connected: any combination of the
// two unsupported motions is a mode.
TEST(ModeComparison, RigidBodiesAreAsLikeAsTheyCanBe) {
  const auto tied = [](double spring) {
    const Matrix mass = (Vector(3) << 1.0, 2.0, spring).finished().asDiagonal();
    return MakeStructuralModel(mass, Matrix::Zero(3, 3),
                               spring * SpringMatrix(3, 0, 1));
  };
  std::vector<ModePair> pairs;
  std::string error;
  ASSERT_TRUE(CompareModes(tied(2.0), tied(3.0), &pairs, &error)) << error;
  ASSERT_EQ(pairs.size(), 3u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(pairs[i].initial_frequency, 0.0);
    EXPECT_EQ(pairs[i].updated_frequency, 0.0);
    EXPECT_NEAR(pairs[i].mac, 1.0, 1e-12);
  }
  // Another mass changes the scale of shapes, but they stay modes.
  const Matrix mass = tied(3.0).mass;
  const Vector first = pairs[0].updated_shape;
  EXPECT_NEAR(first.dot(mass * first), 1.0, 1e-12);
  EXPECT_NEAR(first.dot(mass * pairs[1].updated_shape), 0.0, 1e-12);
}

}  // namespace
}  // namespace pinode
