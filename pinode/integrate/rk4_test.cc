#include "pinode/integrate/rk4.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/figure_testing.h"

namespace pinode {
namespace {

// Largest error at t = 1 of a damped oscillator against its closed form.
double OscillatorError(int steps) {
  constexpr double kOmega = 7.0;
  constexpr double kZeta = 0.05;
  const auto rate = [&](int, double, const double* h, double* r) {
    r[0] = h[1];
    r[1] = -kOmega * kOmega * h[0] - 2.0 * kZeta * kOmega * h[1];
  };
  std::vector<double> state = {1.0, 0.0};
  Rk4Scratch<double> scratch(2);
  for (int i = 0; i < steps; ++i) {
    Rk4Step(rate, i / static_cast<double>(steps), 1.0 / steps, state.data(),
            &scratch);
  }
  const double omega_d = kOmega * std::sqrt(1.0 - kZeta * kZeta);
  const double x =
      std::exp(-kZeta * kOmega) *
      (std::cos(omega_d) + kZeta * kOmega / omega_d * std::sin(omega_d));
  return std::abs(state[0] - x);
}

TEST(Rk4, HasOrderFour) {
  const double order = std::log2(OscillatorError(100) / OscillatorError(200));
  testing::ReportFigure("RK4: order", testing::Between(3.9, 4.1), order);
  EXPECT_NEAR(order, 4.0, 0.1);
}

TEST(Rk4, IsExactOnCubicsInTime) {
  // Without a state in the rate the scheme is Simpson's rule, which is exact
  // for rates that are cubic in time.
  const auto rate = [](int, double t, const double*, double* r) {
    r[0] = 4.0 * t * t * t - 6.0 * t * t + 2.0 * t - 5.0;
  };
  double state = 1.5;
  Rk4Scratch<double> scratch(1);
  const double dt = 0.37;
  for (int i = 0; i < 7; ++i) Rk4Step(rate, i * dt, dt, &state, &scratch);
  const double t = 7 * dt;
  const double exact = 1.5 + t * (-5.0 + t * (1.0 + t * (-2.0 + t)));
  const double error = std::abs(state / exact - 1.0);
  testing::ReportFigure("RK4: relative error on cubics, rounding",
                        testing::AtMost(1e-13), error);
  EXPECT_LT(error, 1e-13);
}

TEST(Rk4, TakesInputsFromTheirNode) {
  // A held input that jumps after the step must not leak into its end.
  std::vector<int> nodes;
  const auto rate = [&](int node, double, const double*, double* r) {
    nodes.push_back(node);
    r[0] = 0.0;
  };
  double state = 0.0;
  Rk4Scratch<double> scratch(1);
  Rk4Step(rate, 0.0, 0.1, &state, &scratch);
  EXPECT_EQ(nodes, (std::vector<int>{0, 1, 1, 2}));
}

}  // namespace
}  // namespace pinode
