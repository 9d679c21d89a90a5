#include "pinode/integrate/step_choice.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pinode/base/types.h"

namespace pinode {
namespace {

Matrix Oscillator(double omega, double zeta) {
  Matrix a(2, 2);
  a << 0.0, 1.0, -omega * omega, -2.0 * zeta * omega;
  return a;
}

TEST(StepChoice, DividesTheSamplingStepForHighModes) {
  EXPECT_EQ(StableSubsteps(Oscillator(10.0, 0.02), 0.01), 1);
  // dt omega = 10: four steps of 2.5.
  EXPECT_EQ(StableSubsteps(Oscillator(1000.0, 0.02), 0.01), 4);
}

TEST(StepChoice, HeavilyDampedModesCount) {
  // zeta = 5: the fast real eigenvalue is 9.9 omega.
  EXPECT_EQ(StableSubsteps(Oscillator(100.0, 5.0), 0.01), 4);
}

TEST(StepChoice, ReportsTheLimitOfStability) {
  // Undamped: stable up to dt omega = 2 sqrt(2).
  const double limit = 2.0 * std::sqrt(2.0);
  EXPECT_TRUE(
      CheckStability(Oscillator(100.0 * limit * 0.999, 0.0), 0.01, 1).stable);
  EXPECT_FALSE(
      CheckStability(Oscillator(100.0 * limit * 1.001, 0.0), 0.01, 1).stable);
}

TEST(StepChoice, AStructureThatGrowsIsNotTheMethodsFault) {
  Matrix a(2, 2);
  a << 0.0, 1.0, 4.0, 0.0;  // negative stiffness
  EXPECT_TRUE(CheckStability(a, 0.01, 1).stable);
}

}  // namespace
}  // namespace pinode
