#include "pinode/record/sampled_calculus.h"

#include <algorithm>
#include <cmath>

#include "gtest/gtest.h"
#include "pinode/record/excitation.h"

namespace pinode {
namespace {

TEST(DifferentiateTest, IsOfFourthOrderInsideAndOfSecondAtTheEnds) {
  const auto error = [](int samples, bool ends) {
    const double step = 2.0 / (samples - 1);
    Vector values(samples);
    for (int i = 0; i < samples; ++i) values[i] = std::sin(3.0 * step * i);
    const Vector found = Differentiate(values, step);
    double worst = 0.0;
    for (int i = 0; i < samples; ++i) {
      const bool end = i < 2 || i > samples - 3;
      if (end != ends) continue;
      const double truth = 3.0 * std::cos(3.0 * step * i);
      worst = std::max(worst, std::abs(found[i] - truth));
    }
    return worst;
  };
  EXPECT_NEAR(error(101, false) / error(201, false), 16.0, 0.5);
  EXPECT_NEAR(error(101, true) / error(201, true), 4.0, 0.5);
}

// The reference: Simpson's rule on the interpolated acceleration, which is
// exact for cubics, over two integrations.
TEST(IntegrateTwiceTest, IsExactForTheInterpolation) {
  constexpr int kSamples = 30;
  constexpr double kStep = 0.02;
  Vector acceleration(kSamples);
  for (int i = 0; i < kSamples; ++i) {
    acceleration[i] = std::sin(0.5 * i) + 0.1 * i;
  }
  for (const Interpolation interpolation :
       {Interpolation::kHeld, Interpolation::kLinear, Interpolation::kCubic}) {
    const Excitation excitation(0.0, kStep, acceleration.transpose(),
                                interpolation);
    const Vector found = IntegrateTwice(acceleration, kStep, interpolation);
    double velocity = 0.0;
    double displacement = 0.0;
    constexpr int kParts = 64;
    for (int i = 0; i + 1 < kSamples; ++i) {
      EXPECT_NEAR(found[i], displacement, 1e-12 * kSamples)
          << InterpolationName(interpolation) << " at " << i;
      for (int p = 0; p < kParts; ++p) {
        const double h = kStep / kParts;
        double a[3];
        for (int k = 0; k < 3; ++k) {
          // The right end of a held interval belongs to it.
          const double fraction = (p + 0.5 * k) / kParts;
          excitation.Evaluate(i, fraction, &a[k]);
        }
        if (interpolation == Interpolation::kHeld) a[2] = a[0];
        // x += h v + int int a; a quadratic through three points.
        displacement += h * velocity + h * h * (a[0] + 2.0 * a[1]) / 6.0;
        velocity += h * (a[0] + 4.0 * a[1] + a[2]) / 6.0;
      }
    }
  }
}

}  // namespace
}  // namespace pinode
