#include "pinode/dynamics/prescribed_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pinode/dynamics/observation.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "tests/support/dynamics_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

std::vector<InputSpec> MotionOf(int dof) {
  return {{InputSpec::Kind::kForce, 0, "force"},
          {InputSpec::Kind::kPrescribedAcceleration, dof, "a"},
          {InputSpec::Kind::kPrescribedDisplacement, dof, "x"},
          {InputSpec::Kind::kPrescribedVelocity, dof, "v"}};
}

TEST(PrescribedMotion, IsFoundAmongTheInputs) {
  std::vector<InputSpec> inputs = MotionOf(2);
  for (const InputSpec& input : MotionOf(1)) inputs.push_back(input);
  const auto prescribed = PrescribedDofs(inputs);
  ASSERT_EQ(prescribed.size(), 2u);
  EXPECT_EQ(prescribed[0].dof, 1);
  EXPECT_EQ(prescribed[0].displacement, 6);
  EXPECT_EQ(prescribed[1].dof, 2);
  EXPECT_EQ(prescribed[1].displacement, 2);
  EXPECT_EQ(prescribed[1].velocity, 3);
  EXPECT_EQ(prescribed[1].acceleration, 1);
}

TEST(PrescribedMotion, IsRefusedWhereItIsNotWhole) {
  StructuralModel model = testing::MakeChain(2, 10.0, 0.5);
  std::string error;
  EXPECT_TRUE(LinearDynamics::IsValid(model, MotionOf(1), &error)) << error;
  EXPECT_FALSE(LinearDynamics::IsValid(model, MotionOf(2), &error));
  std::vector<InputSpec> inputs = MotionOf(1);
  inputs.pop_back();
  EXPECT_FALSE(LinearDynamics::IsValid(model, inputs, &error));
  EXPECT_THAT(error, HasSubstr("needs displacement, velocity"));
  inputs = MotionOf(1);
  inputs.push_back(inputs.back());
  EXPECT_FALSE(LinearDynamics::IsValid(model, inputs, &error));
  EXPECT_THAT(error, HasSubstr("given twice"));
  model.mass(0, 1) = model.mass(1, 0) = 0.1;
  EXPECT_FALSE(LinearDynamics::IsValid(model, MotionOf(1), &error));
  EXPECT_THAT(error, HasSubstr("a lumped mass"));
}

TEST(PrescribedMotion, KeepsItsMass) {
  StructuralDynamics dynamics(testing::MakeChain(2, 10.0, 0.5), MotionOf(1));
  GroupTerm group;
  group.alpha.name = group.group.name = "m";
  group.group.target = MatrixGroup::Target::kMass;
  group.group.matrix = Matrix::Zero(2, 2);
  group.group.matrix(1, 1) = 1.0;
  std::string error;
  EXPECT_FALSE(dynamics.AddGroup(group, &error));
  EXPECT_THAT(error, HasSubstr("cannot change"));
  EXPECT_EQ(dynamics.num_terms(), 0);
  group.group.matrix = Matrix::Zero(2, 2);
  group.group.matrix(0, 0) = 1.0;
  EXPECT_TRUE(dynamics.AddGroup(group, &error)) << error;
}

// Two masses, m1 to the ground by k1 and c1, m2 to m1 by k2, c2 and a cubic
// spring; m2 is moved.
TEST(PrescribedMotion, MovesTheRestAndNeedsAForce) {
  Matrix mass(2, 2), damping(2, 2), stiffness(2, 2);
  mass << 2.0, 0.0, 0.0, 0.5;
  damping << 0.7, -0.3, -0.3, 0.3;
  stiffness << 50.0, -20.0, -20.0, 20.0;
  StructuralDynamics dynamics(MakeStructuralModel(mass, damping, stiffness),
                              MotionOf(1));
  std::string error;
  ASSERT_TRUE(dynamics.AddElement("e", "cubic", 0, 1, {4.0}, &error)) << error;
  StructuralDynamics::Prepared prepared;
  ASSERT_TRUE(dynamics.Prepare(dynamics.Parameters(), &prepared, &error));
  const ObservationMap map(
      dynamics, {{"f", Quantity::kForce, Vector::Unit(2, 1)},
                 {"a2", Quantity::kRelativeAcceleration, Vector::Unit(2, 1)},
                 {"a1", Quantity::kRelativeAcceleration, Vector::Unit(2, 0)},
                 {"x2", Quantity::kDisplacement, Vector::Unit(2, 1)}});
  const double input[] = {1.5, -6.0, 0.4, 2.0};  // f1, a2, x2, v2
  const double x1 = 0.1, v1 = -0.2;
  // The state's entries of the second mass do not matter.
  double state[] = {x1, 77.0, v1, 88.0};
  Vector rate(4);
  auto at = dynamics.MakeLinearization();
  dynamics.Linearize(prepared, 0.0, input, state, &at);
  dynamics.Rate(prepared, 0.0, input, state, rate.data(), &at);
  EXPECT_EQ(rate, at.rate);
  const double d = 0.4 - x1, w = 2.0 - v1;
  const double between = 20.0 * d + 0.3 * w + 4.0 * d * d * d;
  EXPECT_NEAR(rate[2], (1.5 + between - 30.0 * x1 - 0.4 * v1) / 2.0, 1e-13);
  dynamics.Prescribe(input, state);
  EXPECT_EQ(state[1], 0.4);
  EXPECT_EQ(state[3], 2.0);
  double y[4];
  map.Observe(state, rate.data(), input, y);
  EXPECT_NEAR(y[0], 0.5 * -6.0 + between, 1e-13);
  EXPECT_EQ(y[1], -6.0);
  EXPECT_EQ(y[2], rate[2]);
  EXPECT_EQ(y[3], 0.4);
  EXPECT_TRUE(at.jacobian.col(1).isZero(0.0));
  EXPECT_TRUE(at.jacobian.col(3).isZero(0.0));
  EXPECT_NE(at.jacobian(3, 0), 0.0);

  const StructuralModel held = dynamics.HeldModel(dynamics.Parameters());
  ASSERT_EQ(held.num_dofs(), 1);
  EXPECT_EQ(held.stiffness(0, 0), 50.0);
  EXPECT_EQ(held.dof_names[0], "u1");
  EXPECT_TRUE(held.IsValid(&error)) << error;
}

}  // namespace
}  // namespace pinode
