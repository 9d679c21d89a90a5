#include "pinode/dynamics/observation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/dynamics_testing.h"

namespace pinode {
namespace {

Observation At(Quantity quantity, Vector weights) {
  return {"", quantity, std::move(weights)};
}

TEST(Observation, SeesEveryQuantity) {
  StructuralModel model = testing::MakeChain(2, 10.0, 0.5);
  model.influence << 1.0, 0.5;
  const StructuralDynamics dynamics(
      model, {{InputSpec::Kind::kGroundAcceleration, 0, "ag"},
              {InputSpec::Kind::kGroundDisplacement, 0, "xg"}});
  const Vector second = Vector::Unit(2, 1);
  Vector difference(2);
  difference << -1.0, 1.0;
  const ObservationMap map(
      dynamics,
      {At(Quantity::kDisplacement, difference), At(Quantity::kVelocity, second),
       At(Quantity::kRelativeAcceleration, second),
       At(Quantity::kAbsoluteAcceleration, second),
       At(Quantity::kAbsoluteDisplacement, second),
       At(Quantity::kStrain, AxialStrain(difference, 0.05)),
       At(Quantity::kStrain, BendingStrain(difference, 0.01, 0.05))});
  const double state[] = {0.1, 0.4, -1.0, 2.0};
  const double rate[] = {-1.0, 2.0, 7.0, -3.0};
  const double input[] = {0.8, 0.06};
  double y[7];
  map.Observe(state, rate, input, y);
  EXPECT_THAT(y, ::testing::ElementsAre(
                     ::testing::DoubleEq(0.3), ::testing::DoubleEq(2.0),
                     ::testing::DoubleEq(-3.0), ::testing::DoubleEq(-2.6),
                     ::testing::DoubleEq(0.43), ::testing::DoubleEq(6.0),
                     ::testing::DoubleEq(-0.06)));
  EXPECT_THAT(map.acceleration_rows(), ::testing::ElementsAre(2, 3));
}

TEST(Observation, StateJacobianIsTheDerivative) {
  const auto dynamics = testing::MakeEverything();
  StructuralDynamics::Prepared prepared;
  std::string error;
  ASSERT_TRUE(dynamics->Prepare(dynamics->Parameters(), &prepared, &error));
  const ObservationMap map(
      *dynamics, {At(Quantity::kAbsoluteAcceleration, Vector::Ones(3)),
                  At(Quantity::kDisplacement, Vector::Unit(3, 0))});
  const double input[] = {0.4, -0.9, 2.1};
  const int ns = dynamics->num_states();
  Vector state = Vector::LinSpaced(ns, -0.4, 0.6);
  auto stage = dynamics->MakeLinearization();
  dynamics->Linearize(prepared, 1.0, input, state.data(), &stage);
  Matrix jacobian;
  map.StateJacobian(stage, &jacobian);
  const auto observe = [&](const Vector& h) {
    auto scratch = dynamics->MakeLinearization();
    Vector rate(ns);
    dynamics->Rate(prepared, 1.0, input, h.data(), rate.data(), &scratch);
    Vector y(2);
    map.Observe(h.data(), rate.data(), input, y.data());
    return y;
  };
  for (int i = 0; i < ns; ++i) {
    const Vector step = 1e-5 * Vector::Unit(ns, i);
    const Vector difference =
        (observe(state + step) - observe(state - step)) / 2e-5;
    EXPECT_LT((jacobian.col(i) - difference).norm(),
              1e-7 * (1.0 + difference.norm()));
  }
}

TEST(Observation, NamesRoundTripAndErrorsNameTheNearest) {
  Quantity quantity;
  std::string error;
  EXPECT_TRUE(ParseQuantity(QuantityName(Quantity::kAbsoluteAcceleration),
                            &quantity, &error));
  EXPECT_EQ(quantity, Quantity::kAbsoluteAcceleration);
  EXPECT_FALSE(ParseQuantity("displacment", &quantity, &error));
  EXPECT_THAT(error, ::testing::HasSubstr("did you mean 'displacement'"));
}

}  // namespace
}  // namespace pinode
