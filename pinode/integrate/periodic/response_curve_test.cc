// Periodic responses against closed forms and against long runs of the
// classical Runge-Kutta method on StructuralDynamics::Rate.

#include "pinode/integrate/periodic/response_curve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/dynamics/elements.h"
#include "pinode/dynamics/memory_network.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// A chain of unit masses with a force on its first mass.
struct ForcedChain {
  ForcedChain(int masses, double stiffness, double damping, double amplitude)
      : dynamics(testing::MakeChain(masses, stiffness, damping),
                 {{InputSpec::Kind::kForce, 0, "shaker"}}),
        input{Vector::Zero(1), Vector::Constant(1, amplitude)} {}

  void Add(const std::string& type, int from, int to,
           const std::vector<double>& values) {
    std::string error;
    CHECK(dynamics.AddElement(type, type, from, to, values, &error)) << error;
  }
  std::unique_ptr<HarmonicBalance> Balance() {
    std::string error;
    CHECK(dynamics.Prepare(dynamics.Parameters(), &prepared, &error)) << error;
    auto balance = HarmonicBalance::Create(dynamics, prepared, input, &error);
    CHECK(balance != nullptr) << error;
    return balance;
  }
  // The curve's points, `most` at most.
  std::vector<PeriodicResponse> Curve(ResponseCurveOptions options,
                                      size_t most = 10000) {
    const auto balance = Balance();
    std::vector<PeriodicResponse> curve;
    options.each = [&curve, most](const PeriodicResponse& response) {
      curve.push_back(response);
      return curve.size() < most;
    };
    std::string error;
    EXPECT_TRUE(FollowResponseCurve(options, balance.get(), &error)) << error;
    return curve;
  }

  // The state after whole periods from `state`, by steps that follow the
  // force's phase.
  Vector Run(double omega, int periods, Vector state) {
    constexpr int kSteps = 600;
    const double dt = kTwoPi / omega / kSteps;
    auto scratch = dynamics.MakeLinearization();
    const auto rate = [&](double phase, const Vector& at) {
      const Vector u = input.mean + std::cos(phase) * input.amplitude;
      Vector result(at.size());
      dynamics.Rate(prepared, 0.0, u.data(), at.data(), result.data(),
                    &scratch);
      return result;
    };
    for (int j = 0; j < periods * kSteps; ++j) {
      const double phase = kTwoPi * j / kSteps;
      const double half = kTwoPi * (j + 0.5) / kSteps;
      const double whole = kTwoPi * (j + 1) / kSteps;
      const Vector k1 = rate(phase, state);
      const Vector k2 = rate(half, state + 0.5 * dt * k1);
      const Vector k3 = rate(half, state + 0.5 * dt * k2);
      const Vector k4 = rate(whole, state + dt * k3);
      state += dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    return state;
  }
  // The largest multiplier by differences of runs over one period.
  double MultiplierOfRuns(double omega, const Vector& start) {
    constexpr double kStep = 1e-6;
    Matrix motion(start.size(), start.size());
    for (Eigen::Index i = 0; i < start.size(); ++i) {
      const Vector change = kStep * Vector::Unit(start.size(), i);
      motion.col(i) =
          (Run(omega, 1, start + change) - Run(omega, 1, start - change)) /
          (2.0 * kStep);
    }
    return motion.eigenvalues().cwiseAbs().maxCoeff();
  }

  StructuralDynamics dynamics;
  HarmonicInput input;
  StructuralDynamics::Prepared prepared;
};

ResponseCurveOptions Between(double from, double to, int points) {
  ResponseCurveOptions options;
  options.from = from;
  options.to = to;
  options.num_points = points;
  return options;
}

TEST(ResponseCurve, OfALinearMassIsTheFrequencyResponse) {
  ForcedChain chain(1, 4.0, 0.1, 0.7);
  chain.input.mean[0] = 0.2;
  const auto curve = chain.Curve(Between(0.5, 4.0, 40));
  ASSERT_GE(curve.size(), 40u);
  EXPECT_EQ(curve.front().omega, 0.5);
  EXPECT_EQ(curve.back().omega, 4.0);
  double worst = 0.0;
  for (const PeriodicResponse& point : curve) {
    const double w = point.omega;
    const std::complex<double> x =
        0.7 / std::complex<double>(4.0 - w * w, 0.1 * w);
    Vector expected = Vector::Zero(point.states.cols());
    expected.head(3) << 0.05, x.real(), -x.imag();
    worst = testing::Worse(
        worst,
        (point.states.row(0).transpose() - expected).norm() / expected.norm());
    // exp(real part of the pole * period)
    EXPECT_NEAR(point.largest_multiplier, std::exp(-0.05 * kTwoPi / w), 1e-9);
  }
  testing::ReportFigure("periodic response of a linear mass: relative error",
                        testing::AtMost(1e-11), worst);
  EXPECT_LT(worst, 1e-11);
}

// The hardening mass jumps: three responses belong to one frequency, and the
// middle one is unstable.
TEST(ResponseCurve, OfAHardeningMassFoldsWhereItIsUnstable) {
  ForcedChain chain(1, 1.0, 0.1, 0.3);
  chain.Add("cubic", Feature::kGround, 0, {0.5});
  const auto curve = chain.Curve(Between(0.3, 3.0, 60));
  double worst = 0.0;
  int num_back = 0;
  int num_compared = 0;
  for (size_t i = 1; i + 1 < curve.size(); ++i) {
    const PeriodicResponse& point = curve[i];
    EXPECT_LT(point.neglected, 1e-6);
    // On the part of the curve that runs backwards the response is unstable.
    const bool back =
        curve[i + 1].omega < point.omega && point.omega < curve[i - 1].omega;
    const bool forth =
        curve[i + 1].omega > point.omega && point.omega > curve[i - 1].omega;
    num_back += back;
    if (back) {
      EXPECT_GT(point.largest_multiplier, 1.0) << point.omega;
    }
    if (forth) {
      EXPECT_LT(point.largest_multiplier, 1.0) << point.omega;
    }
    if (i % 12 != 0 || !(back || forth)) continue;
    // One period of the equation of motion leads back to its begin.
    const Vector start = ValueAt(point.states, 0.0);
    worst = testing::Worse(
        worst,
        (chain.Run(point.omega, 1, start) - start).norm() / start.norm());
    EXPECT_NEAR(point.largest_multiplier,
                chain.MultiplierOfRuns(point.omega, start), 2e-4);
    ++num_compared;
  }
  EXPECT_GT(num_back, 5);
  EXPECT_GT(num_compared, 5);
  testing::ReportFigure("periodic response of a hardening mass against runs",
                        testing::AtMost(1e-6), worst);
  EXPECT_LT(worst, 1e-6);
}

// Runs from rest come to the same motion if it is the only one.
TEST(ResponseCurve, OfHysteresisIsWhatARunComesTo) {
  ForcedChain chain(2, 4.0, 0.4, 0.5);
  chain.Add("bouc_wen", 0, 1, {2.0, 1.0, 0.5, 0.5, 2.0});
  auto options = Between(1.0, 1.2, 2);
  options.most_harmonics = 127;
  const auto curve = chain.Curve(options);
  const PeriodicResponse& last = curve.back();
  const Vector run = chain.Run(1.2, 60, Vector::Zero(5));
  const double error =
      (ValueAt(last.states, 0.0).head(4) - run.head(4)).norm() / run.norm();
  testing::ReportFigure("periodic response with hysteresis against a run",
                        testing::AtMost(1e-4), error);
  EXPECT_LT(error, 1e-4);
  // Rates are those of the law.
  const Vector rate = ValueAt(DerivativeCoefficients(last.states, 1.2), 0.3);
  EXPECT_NEAR(rate[0], ValueAt(last.states, 0.3)[2], 1e-6);
}

// A mass that a spring pushes away grows by exp(sqrt(k) T) in a period.
TEST(ResponseCurve, MultiplierOfAMotionThatGrowsIsNotZero) {
  ForcedChain chain(1, -1.0, 0.0, 0.3);
  for (const PeriodicResponse& point : chain.Curve(Between(0.002, 0.05, 10))) {
    EXPECT_NEAR(std::log(point.largest_multiplier),
                std::min(kTwoPi / point.omega, 690.0), 1e-6);
  }
}

// A law that acts in a small part of the period only.
TEST(ResponseCurve, MultipliersOfFrictionVarySmoothly) {
  ForcedChain chain(1, 4.0, 0.4, 1.0);
  chain.Add("coulomb", Feature::kGround, 0, {0.3, 0.05});
  const auto curve = chain.Curve(Between(1.0, 1.1, 8));
  for (size_t i = 1; i < curve.size(); ++i) {
    EXPECT_NEAR(curve[i].largest_multiplier, curve[i - 1].largest_multiplier,
                0.03);
  }
  const PeriodicResponse& last = curve.back();
  EXPECT_NEAR(last.largest_multiplier,
              chain.MultiplierOfRuns(last.omega, ValueAt(last.states, 0.0)),
              0.02);
}

TEST(ResponseCurve, EndsAtAnyFrequency) {
  ForcedChain chain(1, 1.0, 0.1, 0.3);
  chain.Add("cubic", Feature::kGround, 0, {0.5});
  for (int i = 0; i < 30; ++i) {
    const double to = 0.8 + 0.013 * i;
    const auto curve = chain.Curve(Between(0.5, to, 7 + i % 5));
    EXPECT_EQ(curve.back().omega, to);
  }
}

TEST(ResponseCurve, EndsWhenItIsTold) {
  ForcedChain chain(1, 1.0, 0.1, 0.3);
  EXPECT_EQ(chain.Curve(Between(0.3, 3.0, 60), 5).size(), 5u);
}

TEST(HarmonicBalance, RefusesWhatHasNoPeriodicResponse) {
  std::string error;
  ForcedChain free(2, 4.0, 0.1, 1.0);
  // Two masses on a spring, without a support.
  StructuralModel model = testing::MakeChain(2, 4.0, 0.1);
  model.stiffness << 4.0, -4.0, -4.0, 4.0;
  model.damping.setZero();
  StructuralDynamics loose(model, {{InputSpec::Kind::kForce, 0, "shaker"}});
  StructuralDynamics::Prepared prepared;
  ASSERT_TRUE(loose.Prepare(loose.Parameters(), &prepared, &error)) << error;
  EXPECT_EQ(HarmonicBalance::Create(loose, prepared, free.input, &error),
            nullptr);
  EXPECT_THAT(error, HasSubstr("without stiffness"));
  const auto everything = testing::MakeEverything();
  ASSERT_TRUE(everything->Prepare(everything->Parameters(), &prepared, &error));
  EXPECT_EQ(HarmonicBalance::Create(*everything, prepared,
                                    {Vector::Zero(3), Vector::Ones(3)}, &error),
            nullptr);
  EXPECT_THAT(error, HasSubstr("pinode_discover"));
  // Their dissipated energy is a state that grows.
  free.Add("baber_noori", 0, 1,
           {1.0, 0.5, 0.5, 1.0, 0.1, 0.0, 0.0, 0.5, 0.1, 0.2, 0.0, 0.5});
  ForcedChain other(2, 4.0, 0.1, 1.0);
  const MemoryNetworkShape shape;
  ASSERT_TRUE(other.dynamics.AddLaw(
      MakeMemoryNetwork("device", shape,
                        {Feature::Displacement(0), Feature::Velocity(0)}, 2,
                        MemoryNetwork(shape).DrawWeights(1), 3.0),
      &error));
  for (ForcedChain* chain : {&free, &other}) {
    const StructuralDynamics& dynamics = chain->dynamics;
    ASSERT_TRUE(dynamics.Prepare(dynamics.Parameters(), &prepared, &error));
    EXPECT_EQ(HarmonicBalance::Create(dynamics, prepared, chain->input, &error),
              nullptr);
    EXPECT_THAT(error, HasSubstr("counts the energy that it dissipates"));
  }
}

}  // namespace
}  // namespace pinode
