// Modes of exact and noisy frequency response functions of known structures.

#include "pinode/modal/frf/frf_modes.h"

#include <cmath>
#include <complex>
#include <random>
#include <string>

#include "gtest/gtest.h"
#include "pinode/base/constants.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// The frequencies of a chain of six unit masses, all 2 % damped, with modes of
// a matrix of reflection.
struct Structure {
  Vector hz, ratio;
  Matrix shapes;  // DOFs x modes, mass 1
};

Structure SixMasses() {
  Structure s;
  s.hz.resize(6);
  s.hz << 1.9293, 5.6169, 8.6806, 14.4909, 15.8430, 17.0080;
  s.ratio = Vector::Constant(6, 0.02);
  Vector v(6);
  v << 1.0, 0.8, -0.6, 1.3, 0.5, -0.9;
  s.shapes = Matrix::Identity(6, 6) - 2.0 * v * v.transpose() / v.squaredNorm();
  return s;
}

// Accelerance of all DOFs to `references`.
FrequencyResponses Responses(const Structure& s, int references,
                             double lowest_hz, double highest_hz,
                             double step_hz) {
  FrequencyResponses all;
  all.name = "test";
  const Index lines =
      static_cast<Index>(std::lround((highest_hz - lowest_hz) / step_hz)) + 1;
  all.frequencies_hz = Vector::LinSpaced(lines, lowest_hz, highest_hz);
  for (Index i = 0; i < s.shapes.rows(); ++i) {
    all.responses.push_back("u" + std::to_string(i + 1));
    if (i < references) all.references.push_back(all.responses.back());
  }
  all.derivative = 2;
  all.values.resize(lines, s.shapes.rows() * references);
  for (Index o = 0; o < s.shapes.rows(); ++o) {
    for (Index j = 0; j < references; ++j) {
      for (Index k = 0; k < lines; ++k) {
        const Complex iw(0.0, kTwoPi * all.frequencies_hz[k]);
        Complex sum = 0.0;
        for (Index r = 0; r < s.hz.size(); ++r) {
          const double w = kTwoPi * s.hz[r];
          sum += s.shapes(o, r) * s.shapes(j, r) /
                 (iw * iw + 2.0 * s.ratio[r] * w * iw + w * w);
        }
        all.values(k, all.Pair(o, j)) = iw * iw * sum;
      }
    }
  }
  all.files.assign(static_cast<size_t>(all.values.cols()), 0);
  return all;
}

void AddNoise(double part, unsigned seed, FrequencyResponses* all) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (Index c = 0; c < all->values.cols(); ++c) {
    const double rms = std::sqrt(all->values.col(c).squaredNorm() /
                                 static_cast<double>(all->num_lines()));
    for (Index k = 0; k < all->num_lines(); ++k) {
      all->values(k, c) +=
          part * rms / std::sqrt(2.0) * Complex(normal(random), normal(random));
    }
  }
}

TEST(FrfModesTest, ExactFunctionsGiveExactModes) {
  const Structure s = SixMasses();
  const FrequencyResponses all = Responses(s, 1, 0.5, 20.0, 0.05);
  ModesOfFrfs found;
  std::string error;
  ASSERT_TRUE(FindFrfModes(all, {}, &found, &error)) << error;
  ASSERT_EQ(found.record.modes.size(), 6u);
  for (size_t m = 0; m < 6; ++m) {
    const Index r = static_cast<Index>(m);
    EXPECT_NEAR(found.record.modes[m].frequency_hz, s.hz[r], 1e-7);
    EXPECT_NEAR(found.record.modes[m].damping_ratio, 0.02, 1e-8);
    const Vector shape =
        s.shapes.col(r) / s.shapes.col(r).cwiseAbs().maxCoeff();
    EXPECT_NEAR((found.record.modes[m].shape.cwiseAbs() - shape.cwiseAbs())
                    .cwiseAbs()
                    .maxCoeff(),
                0.0, 1e-6);
  }
}

TEST(FrfModesTest, NoisyFunctionsLieWithinTheirIntervals) {
  const Structure s = SixMasses();
  FrequencyResponses all = Responses(s, 1, 0.5, 20.0, 0.05);
  AddNoise(0.01, 1, &all);
  ModesOfFrfs found;
  std::string error;
  ASSERT_TRUE(FindFrfModes(all, {}, &found, &error)) << error;
  ASSERT_EQ(found.record.modes.size(), 6u);
  for (size_t m = 0; m < 6; ++m) {
    const IdentifiedMode& mode = found.record.modes[m];
    EXPECT_LT(std::abs(mode.frequency_hz - s.hz[static_cast<Index>(m)]),
              4.0 * mode.frequency_sigma);
    EXPECT_LT(std::abs(mode.damping_ratio - 0.02), 4.0 * mode.damping_sigma);
    EXPECT_LT(mode.frequency_sigma, 1e-3 * mode.frequency_hz);
    EXPECT_LT(mode.damping_sigma, 0.05 * 0.02);
  }
}

}  // namespace
}  // namespace pinode
