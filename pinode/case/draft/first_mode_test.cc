#include "pinode/case/draft/first_mode.h"

#include <cmath>
#include <random>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;

constexpr double kStep = 0.01;

// Accelerations of a base, and of three floors in modes of 1.5, 4.2 and 6.1 Hz
// with 2 % damping, by the exact steps of a single mass for each mode.
struct Shaken {
  Matrix floors;
  Vector base;
};

Shaken Shake(int samples, unsigned seed, double noise) {
  const double hz[] = {1.5, 4.2, 6.1};
  // Shapes times participation: their sum is 1 on each floor.
  const double parts[3][3] = {
      {0.54, 0.98, 1.22}, {0.35, 0.15, -0.28}, {0.11, -0.13, 0.06}};
  constexpr int kFine = 20;
  std::mt19937 engine(seed);
  std::normal_distribution<double> gauss;
  Shaken shaken;
  shaken.floors.resize(3, samples);
  shaken.base.resize(samples);
  double u[3] = {0.0, 0.0, 0.0};
  double v[3] = {0.0, 0.0, 0.0};
  double ground = 0.0;
  for (int i = 0; i < samples; ++i) {
    const double next = gauss(engine);
    double last[3] = {0.0, 0.0, 0.0};
    for (int fine = 0; fine < kFine; ++fine) {
      const double share = static_cast<double>(fine) / kFine;
      const double now = ground + share * (next - ground);
      for (int m = 0; m < 3; ++m) {
        const double w = kTwoPi * hz[m];
        const double a = -w * w * u[m] - 0.04 * w * v[m];
        if (fine == 0) last[m] = a;
        v[m] += kStep / kFine * (a - now);
        u[m] += kStep / kFine * v[m];
      }
    }
    shaken.base[i] = ground + noise * gauss(engine);
    for (int c = 0; c < 3; ++c) {
      double sum = 0.0;
      for (int m = 0; m < 3; ++m) sum += parts[m][c] * last[m];
      shaken.floors(c, i) = sum + noise * gauss(engine);
    }
    ground = next;
  }
  return shaken;
}

TEST(FirstModeTest, FrequencyWithAndWithoutTheBase) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Shaken shaken = Shake(3000, seed, 0.05);
    const FirstMode mode = FindFirstMode(shaken.floors, shaken.base, kStep);
    EXPECT_NEAR(mode.hz, 1.5, 0.08) << seed;
    EXPECT_THAT(mode.is_reversed, ElementsAre(false, false, false));
    EXPECT_FALSE(mode.is_base_reversed);
    const FirstMode alone = FindFirstMode(shaken.floors, Vector(), kStep);
    EXPECT_NEAR(alone.hz, 1.5, 0.1) << seed;
    EXPECT_THAT(alone.is_reversed, ElementsAre(false, false, false));
  }
}

TEST(FirstModeTest, SensorsThatAreUpsideDown) {
  const Shaken shaken = Shake(3000, 4, 0.05);
  Matrix floors = shaken.floors;
  floors.row(1) *= -1.0;
  for (const Vector& base : {shaken.base, Vector()}) {
    const FirstMode mode = FindFirstMode(floors, base, kStep);
    EXPECT_THAT(mode.is_reversed, ElementsAre(false, true, false));
    EXPECT_FALSE(mode.is_base_reversed);
  }
  const FirstMode mode = FindFirstMode(shaken.floors, -shaken.base, kStep);
  EXPECT_THAT(mode.is_reversed, ElementsAre(false, false, false));
  EXPECT_TRUE(mode.is_base_reversed);
}

TEST(FirstModeTest, RecordsThatShowNoMode) {
  // Nothing, too little, and a sensor that stands still beside one that moves.
  EXPECT_EQ(FindFirstMode(Matrix(), Vector(), kStep).hz, 0.0);
  EXPECT_EQ(FindFirstMode(Matrix::Ones(2, 500), Vector::Ones(500), kStep).hz,
            0.0);
  const Shaken shaken = Shake(3000, 5, 0.05);
  EXPECT_EQ(
      FindFirstMode(shaken.floors.leftCols(40), shaken.base.head(40), kStep).hz,
      0.0);
  Matrix floors = shaken.floors;
  floors.row(0).setZero();
  const FirstMode mode = FindFirstMode(floors, Vector(), kStep);
  EXPECT_NEAR(mode.hz, 1.5, 0.08);
  EXPECT_FALSE(mode.is_reversed[0]);
}

TEST(FirstModeTest, MissingSamplesAreNoMotion) {
  const Shaken shaken = Shake(3000, 6, 0.05);
  Matrix floors = shaken.floors;
  floors.block(2, 1000, 1, 50).setConstant(kNaN);
  EXPECT_NEAR(FindFirstMode(floors, shaken.base, kStep).hz, 1.5, 0.08);
}

}  // namespace
}  // namespace pinode
