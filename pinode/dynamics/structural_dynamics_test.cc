#include "pinode/dynamics/structural_dynamics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "pinode/dynamics/elements.h"
#include "tests/support/dynamics_testing.h"

namespace pinode {
namespace {

constexpr double kTime = 1.3;
const double kInput[] = {0.4, -0.9, 2.1};

Vector SomeState(int size) {
  Vector state(size);
  for (int i = 0; i < size; ++i) state[i] = 0.5 * std::cos(2.1 * i + 0.4);
  return state;
}

TEST(StructuralDynamics, AgreesWithJetsForEveryTerm) {
  const auto dynamics = testing::MakeEverything();
  std::string error;
  StructuralDynamics::Prepared prepared;
  ASSERT_TRUE(dynamics->Prepare(dynamics->Parameters(), &prepared, &error));
  const int ns = dynamics->num_states();
  const int np = dynamics->num_parameters();
  // Three DOFs, and 13 states of elements with a memory.
  ASSERT_EQ(ns, 19);
  ASSERT_EQ(dynamics->num_tangent_columns(), np);
  const Vector state = SomeState(ns);

  auto point = dynamics->MakeLinearization();
  dynamics->Linearize(prepared, kTime, kInput, state.data(), &point);
  Vector rate(ns);
  auto scratch = dynamics->MakeLinearization();
  dynamics->Rate(prepared, kTime, kInput, state.data(), rate.data(), &scratch);
  EXPECT_LT((rate - point.rate).norm(), 1e-13 * rate.norm());

  const Matrix identity = Matrix::Identity(ns, ns);
  const StructuralDynamics::Linearization* points[] = {&point};
  const Matrix* lefts[] = {&identity};
  auto tangent_scratch = dynamics->MakeTangentScratch(ns);
  Matrix by_theta = Matrix::Zero(ns, np);
  dynamics->AddParameterTangents(prepared, points, lefts, 1, &tangent_scratch,
                                 by_theta.data());

  const Matrix jets =
      testing::JetJacobian(*dynamics, prepared, kTime, kInput, state);
  EXPECT_LT((point.jacobian - jets.leftCols(ns)).norm(),
            1e-12 * jets.leftCols(ns).norm());
  for (int j = 0; j < np; ++j) {
    EXPECT_LT((by_theta.col(j) - jets.col(ns + j)).norm(),
              1e-12 * (jets.col(ns + j).norm() + 1.0))
        << "parameter " << j;
  }
}

TEST(StructuralDynamics, LinearDynamicsIsTheEquationOfMotion) {
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
  auto scratch = dynamics.MakeLinearization();
  dynamics.Rate(prepared, 0.0, input, state, rate, &scratch);
  EXPECT_DOUBLE_EQ(rate[0], -1.0);
  EXPECT_DOUBLE_EQ(rate[1], 2.0);
  // K x = (20*0.1 - 10*0.3, -10*0.1 + 10*0.3) = (-1, 2);
  // C v = (-2, 1.5).
  EXPECT_NEAR(rate[2], (1.0 + 2.0) / 2.0 - 0.7, 1e-14);
  EXPECT_NEAR(rate[3], (5.0 - 2.0 - 1.5) / 4.0 - 0.7, 1e-14);
}

TEST(StructuralDynamics, FixedParametersHaveNoTangentColumns) {
  auto dynamics = testing::MakeEverything();
  StructuralDynamics copy(dynamics->model(), dynamics->inputs());
  std::string error;
  GroupTerm group = dynamics->groups()[0];
  group.alpha.free = false;
  ASSERT_TRUE(copy.AddGroup(group, &error)) << error;
  LawTerm law = dynamics->laws()[0];
  ASSERT_TRUE(copy.AddLaw(law, &error)) << error;
  law.name = law.parameters.name = "half fixed";
  law.parameters.parameters[0].free = false;
  ASSERT_TRUE(copy.AddLaw(law, &error)) << error;
  EXPECT_EQ(copy.num_parameters(), 5);
  EXPECT_THAT(copy.tangent_columns(), ::testing::ElementsAre(1, 2, 4));
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

TEST(StructuralDynamics, RefusesModelsAndInputsThatDoNotFit) {
  std::string error;
  const StructuralModel model = testing::MakeChain(2, 1.0, 0.1);
  EXPECT_NE(StructuralDynamics::Create(model, {}, &error), nullptr) << error;
  using Kind = InputSpec::Kind;
  for (Kind kind :
       {Kind::kForce, Kind::kGroundAcceleration, Kind::kGroundDisplacement}) {
    for (int index : {-1, 2}) {
      EXPECT_EQ(
          StructuralDynamics::Create(model, {{kind, index, "in"}}, &error),
          nullptr);
      EXPECT_THAT(error, ::testing::HasSubstr("input 'in' needs a "));
    }
  }
  StructuralModel bad = model;
  bad.mass(0, 0) = -1.0;
  EXPECT_EQ(StructuralDynamics::Create(bad, {}, &error), nullptr);
  EXPECT_EQ(StructuralDynamics::Create({}, {}, &error), nullptr);
}

TEST(StructuralDynamics, RefusesTermsThatDoNotFit) {
  const auto all = testing::MakeEverything();
  StructuralDynamics dynamics(all->model(), {});
  std::string error;
  const auto refused = [&](bool added, const char* why) {
    EXPECT_FALSE(added);
    EXPECT_THAT(error, ::testing::HasSubstr(why));
  };
  refused(dynamics.AddTerm(nullptr, &error), "no term");
  refused(dynamics.AddLaw(LawTerm(), &error), "has no law");
  refused(dynamics.AddNetwork(NetworkTerm(), &error), "has no network");
  refused(dynamics.AddUnknownForce(UnknownForceTerm(), &error),
          "has no history");
  LawTerm law = all->laws()[0];
  law.outputs.resize(2, 1);
  refused(dynamics.AddLaw(law, &error), "outputs do not fit");
  law = all->laws()[0];
  law.outputs(0, 0) = std::nan("");
  refused(dynamics.AddLaw(law, &error), "not finite");
  law = all->laws()[0];
  law.features[0].b = 3;
  refused(dynamics.AddLaw(law, &error), "does not exist");
  NetworkTerm network = all->networks()[0];
  network.weights.parameters.pop_back();
  refused(dynamics.AddNetwork(network, &error), "do not fit its architecture");
  refused(dynamics.AddNetwork(all->networks()[1], &error), "an input");
  UnknownForceTerm force = all->unknown_forces()[0];
  force.prior.precisions = {-1.0};
  force.prior.combinations.resize(1);
  force.prior.combinations[0] = {1, 0, Vector::Ones(1)};
  refused(dynamics.AddUnknownForce(force, &error), "its prior does not fit");
  force.prior.combinations[0] = {0, 7, Vector::Ones(2)};
  refused(dynamics.AddUnknownForce(force, &error), "its prior does not fit");
  force.prior.combinations[0] = {0, 7, Vector::Ones(1)};
  force.parameters.parameters[3].free = false;
  refused(dynamics.AddUnknownForce(force, &error), "are free, or none");
  force.input = 0;
  refused(dynamics.AddUnknownForce(force, &error), "does not exist");
  ForceScaleTerm scale = all->force_scales()[0];
  refused(dynamics.AddForceScale(scale, &error),
          "which is not a measured force");
  StructuralDynamics driven(all->model(), all->inputs());
  scale.forces = {};
  refused(driven.AddForceScale(scale, &error), "the scale of no force");
  scale.forces = {{0, -1}};
  refused(driven.AddForceScale(scale, &error), "which is not a measured force");
  scale.forces = {{1, 3}};
  refused(driven.AddForceScale(scale, &error), "does not exist");
  scale.forces = {{1, -1}};
  scale.parameters.parameters.clear();
  refused(driven.AddForceScale(scale, &error), "expected only its scale");
  refused(dynamics.AddElement("e", "cubick", -1, 0, {1.0}, &error), "cubic");
  refused(dynamics.AddElement("e", "cubic", 0, 0, {1.0}, &error),
          "its ends are");
  refused(dynamics.AddElement("e", "cubic", 0, 3, {1.0}, &error),
          "its ends are");
  refused(dynamics.AddElement("e", "cubic", 0, 1, {}, &error), "0 values");
  refused(dynamics.AddElement("e", "bilinear", 0, 1, {1.0, -1.0}, &error),
          "e.gap");
  EXPECT_EQ(dynamics.num_terms(), 0);
  ASSERT_TRUE(dynamics.AddElement("e", "cubic", -1, 1, {2.0}, &error)) << error;
  EXPECT_EQ(dynamics.laws()[0].parameters.parameters[0].name, "e.k3");
  StructuralDynamics::Prepared prepared;
  EXPECT_FALSE(dynamics.Prepare(Vector(), &prepared, &error));
  EXPECT_THAT(error,
              ::testing::HasSubstr("0 values of parameters, expected 1"));
}

// The result is as if the column had been multiplied before, with any other
// terms.
TEST(StructuralDynamics, ScaleOfAForceMultipliesIt) {
  auto scaled = testing::MakeEverything();
  StructuralDynamics plain(scaled->model(), scaled->inputs());
  std::string error;
  for (int i = 0; i < scaled->num_terms(); ++i) {
    if (scaled->term(i).kind() == TermKind::kForceScale) continue;
    ASSERT_TRUE(plain.AddTerm(scaled->term(i).Clone(), &error)) << error;
  }
  Vector theta = scaled->Parameters();
  theta[scaled->block_offset(scaled->force_scale_block(0))] = -2.5;
  theta[scaled->block_offset(scaled->force_scale_block(1))] = 1.0;
  StructuralDynamics::Prepared prepared, without;
  ASSERT_TRUE(scaled->Prepare(theta, &prepared, &error)) << error;
  ASSERT_TRUE(plain.Prepare(plain.Parameters(), &without, &error)) << error;
  const Vector state = SomeState(scaled->num_states());
  Vector rate(state.size()), expected(state.size());
  auto scratch = scaled->MakeLinearization();
  auto plain_scratch = plain.MakeLinearization();
  const double input[] = {kInput[0], -2.5 * kInput[1], kInput[2]};
  scaled->Rate(prepared, kTime, kInput, state.data(), rate.data(), &scratch);
  plain.Rate(without, kTime, input, state.data(), expected.data(),
             &plain_scratch);
  EXPECT_LT((rate - expected).norm(), 1e-14 * expected.norm());

  // The second force is off where its record's switch is zero.
  theta[scaled->block_offset(scaled->force_scale_block(1))] = 7.0;
  ASSERT_TRUE(scaled->Prepare(theta, &prepared, &error)) << error;
  const double off[] = {kInput[0], kInput[1], 0.0};
  const double off_scaled[] = {kInput[0], -2.5 * kInput[1], 0.0};
  scaled->Rate(prepared, kTime, off, state.data(), rate.data(), &scratch);
  plain.Rate(without, kTime, off_scaled, state.data(), expected.data(),
             &plain_scratch);
  EXPECT_LT((rate - expected).norm(), 1e-14 * expected.norm());
}

// A copy has its own terms. theta is in the order of the kinds, whatever the
// order in which they were added.
TEST(StructuralDynamics, CopiesAndOrders) {
  const auto all = testing::MakeEverything();
  StructuralDynamics backwards(all->model(), all->inputs());
  std::string error;
  for (int i = all->num_terms() - 1; i >= 0; --i) {
    ASSERT_TRUE(backwards.AddTerm(all->term(i).Clone(), &error)) << error;
  }
  const int last = static_cast<int>(all->networks().size()) - 1;
  EXPECT_EQ(backwards.networks()[0].name, all->networks()[last].name);
  EXPECT_EQ(backwards.block_offset(backwards.network_block(0)),
            all->block_offset(all->network_block(0)));
  StructuralDynamics copy = *all;
  copy.SetParameters(Vector::Zero(copy.num_parameters()));
  EXPECT_NE(all->Parameters(), copy.Parameters());
  EXPECT_EQ(copy.groups()[0].alpha.value, 0.0);
  EXPECT_EQ(copy.linear_dynamics().changes()[0].group, &copy.groups()[0].group);
  const StructuralDynamics moved = std::move(copy);
  EXPECT_EQ(moved.linear_dynamics().changes()[0].group,
            &moved.groups()[0].group);
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
  EXPECT_EQ(model.stiffness, prepared.linear.stiffness);
  EXPECT_EQ(model.damping, prepared.linear.damping);
  EXPECT_EQ(model.mass, prepared.linear.mass);
}

}  // namespace
}  // namespace pinode
