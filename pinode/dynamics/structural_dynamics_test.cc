#include "pinode/dynamics/structural_dynamics.h"

#include <ceres/jet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "pinode/dynamics/elements.h"
#include "pinode/dynamics/testing.h"

namespace pinode {
namespace {

constexpr double kTime = 1.3;
const double kInput[] = {0.4, -0.9, 2.1};

Vector SomeState(int size) {
  Vector state(size);
  for (int i = 0; i < size; ++i) state[i] = 0.5 * std::cos(2.1 * i + 0.4);
  return state;
}

// All derivatives of dh/dt by Jets, columns: states then parameters.
Matrix JetJacobian(const StructuralDynamics& dynamics,
                   const StructuralDynamics::Prepared& prepared,
                   const Vector& state) {
  const int ns = dynamics.num_states();
  const int np = dynamics.num_parameters();
  constexpr int kWidth = 8;
  Matrix jacobian(ns, ns + np);
  std::vector<WideJet> h(ns), theta(np), rate(ns);
  for (int begin = 0; begin < ns + np; begin += kWidth) {
    for (int i = 0; i < ns; ++i) h[i] = WideJet(state[i]);
    for (int i = 0; i < np; ++i) theta[i] = WideJet(prepared.theta[i]);
    const int count = std::min(kWidth, ns + np - begin);
    for (int k = 0; k < count; ++k) {
      const int column = begin + k;
      (column < ns ? h[column] : theta[column - ns]).v[k] = 1.0;
    }
    dynamics.Rate(prepared, kTime, kInput, h.data(), theta.data(), rate.data());
    for (int i = 0; i < ns; ++i) {
      for (int k = 0; k < count; ++k) jacobian(i, begin + k) = rate[i].v[k];
    }
  }
  return jacobian;
}

TEST(StructuralDynamics, AgreesWithJetsForEveryTerm) {
  const auto dynamics = testing::MakeEverything();
  std::string error;
  StructuralDynamics::Prepared prepared;
  ASSERT_TRUE(dynamics->Prepare(dynamics->Parameters(), &prepared, &error));
  const int ns = dynamics->num_states();
  const int np = dynamics->num_parameters();
  ASSERT_EQ(ns, 7);
  ASSERT_EQ(dynamics->num_tangent_columns(), np);
  const Vector state = SomeState(ns);

  auto stage = dynamics->MakeStage();
  dynamics->Linearize(prepared, kTime, kInput, state.data(), &stage);
  Vector rate(ns);
  auto scratch = dynamics->MakeStage();
  dynamics->Rate(prepared, kTime, kInput, state.data(), rate.data(), &scratch);
  EXPECT_LT((rate - stage.rate).norm(), 1e-13 * rate.norm());

  const Matrix identity = Matrix::Identity(ns, ns);
  const StructuralDynamics::Stage* stages[] = {&stage};
  const Matrix* lefts[] = {&identity};
  auto tangent_scratch = dynamics->MakeTangentScratch(ns);
  Matrix by_theta = Matrix::Zero(ns, np);
  dynamics->AddParameterTangents(prepared, stages, lefts, 1, &tangent_scratch,
                                 by_theta.data());

  const Matrix jets = JetJacobian(*dynamics, prepared, state);
  EXPECT_LT((stage.jacobian - jets.leftCols(ns)).norm(),
            1e-12 * jets.leftCols(ns).norm());
  for (int j = 0; j < np; ++j) {
    EXPECT_LT((by_theta.col(j) - jets.col(ns + j)).norm(),
              1e-12 * (jets.col(ns + j).norm() + 1.0))
        << "parameter " << j;
  }
}

TEST(StructuralDynamics, LinearPartIsTheEquationOfMotion) {
  // M a + C v + K x = f - M r a_g by hand for two DOFs.
  StructuralModel model = testing::MakeChain(2, 10.0, 0.5);
  model.mass.diagonal() << 2.0, 4.0;
  const StructuralDynamics dynamics(
      model, {{InputSpec::Kind::kGroundAcceleration, 0, "g"},
              {InputSpec::Kind::kForce, 1, "f"}});
  StructuralDynamics::Prepared prepared;
  std::string error;
  ASSERT_TRUE(dynamics.Prepare(Vector(), &prepared, &error));
  const double state[] = {0.1, 0.3, -1.0, 2.0};
  const double input[] = {0.7, 5.0};
  double rate[4];
  auto scratch = dynamics.MakeStage();
  dynamics.Rate(prepared, 0.0, input, state, rate, &scratch);
  EXPECT_DOUBLE_EQ(rate[0], -1.0);
  EXPECT_DOUBLE_EQ(rate[1], 2.0);
  // K x = (20*0.1 - 10*0.3, -10*0.1 + 10*0.3) = (-1, 2);
  // C v = (-2, 1.5).
  EXPECT_NEAR(rate[2], (1.0 + 2.0) / 2.0 - 0.7, 1e-14);
  EXPECT_NEAR(rate[3], (5.0 - 2.0 - 1.5) / 4.0 - 0.7, 1e-14);
}

TEST(StructuralDynamics, FixedBlocksHaveNoTangentColumns) {
  auto dynamics = testing::MakeEverything();
  StructuralDynamics copy(dynamics->model(), dynamics->inputs());
  std::string error;
  GroupTerm group = dynamics->groups()[0];
  group.alpha.free = false;
  ASSERT_TRUE(copy.AddGroup(group, &error)) << error;
  LawTerm law = dynamics->laws()[0];
  ASSERT_TRUE(copy.AddLaw(law, &error)) << error;
  EXPECT_EQ(copy.num_parameters(), 3);
  EXPECT_THAT(copy.tangent_columns(), ::testing::ElementsAre(1, 2));
}

TEST(StructuralDynamics, RefusesWhatDoesNotFit) {
  StructuralDynamics dynamics(testing::MakeChain(2, 1.0, 0.1), {});
  std::string error;
  GroupTerm group;
  group.group.name = "k";
  group.group.matrix = Matrix::Identity(3, 3);
  EXPECT_FALSE(dynamics.AddGroup(group, &error));
  group.group.matrix = Matrix::Identity(2, 2);
  group.alpha.lower = 1.0;
  group.alpha.upper = 0.0;
  EXPECT_FALSE(dynamics.AddGroup(group, &error));
  EXPECT_THAT(error, ::testing::HasSubstr("bounds are crossed"));
  group.alpha = Parameter();
  group.group.target = MatrixGroup::Target::kMass;
  group.follows = GroupTerm::Follows::kTime;
  EXPECT_FALSE(dynamics.AddGroup(group, &error));
  EXPECT_THAT(error, ::testing::HasSubstr("mass cannot follow"));
  EXPECT_EQ(dynamics.num_parameters(), 0);
}

TEST(StructuralDynamics, MassThatTurnsIndefiniteIsRefused) {
  StructuralDynamics dynamics(testing::MakeChain(2, 1.0, 0.1), {});
  GroupTerm group;
  group.group.name = "m";
  group.group.target = MatrixGroup::Target::kMass;
  group.group.matrix = Matrix::Identity(2, 2);
  std::string error;
  ASSERT_TRUE(dynamics.AddGroup(group, &error)) << error;
  StructuralDynamics::Prepared prepared;
  EXPECT_TRUE(dynamics.Prepare(Vector::Constant(1, -0.5), &prepared, &error));
  EXPECT_FALSE(dynamics.Prepare(Vector::Constant(1, -1.5), &prepared, &error));
  EXPECT_THAT(error, ::testing::HasSubstr("not positive definite"));
}

TEST(StructuralDynamics, CorrectedModelCarriesTheGroups) {
  const auto dynamics = testing::MakeEverything();
  StructuralDynamics::Prepared prepared;
  std::string error;
  ASSERT_TRUE(dynamics->Prepare(dynamics->Parameters(), &prepared, &error));
  const StructuralModel model =
      dynamics->CorrectedModel(dynamics->Parameters());
  EXPECT_EQ(model.stiffness, prepared.stiffness);
  EXPECT_EQ(model.damping, prepared.damping);
  EXPECT_EQ(model.mass, prepared.mass);
}

}  // namespace
}  // namespace pinode
