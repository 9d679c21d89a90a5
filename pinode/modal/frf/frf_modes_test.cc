// Modes of exact and noisy frequency response functions of known structures.

#include "pinode/modal/frf/frf_modes.h"

#include <cmath>
#include <complex>
#include <random>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/record/frf/frf_files.h"
#include "tests/support/measured_data_testing.h"

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

// Accelerance of all DOFs to `references`. `decay_rate`: of an exponential
// window, 1 / s.
FrequencyResponses Responses(const Structure& s, int references,
                             double lowest_hz, double highest_hz,
                             double step_hz, double decay_rate = 0.0) {
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
  all.decay_rate = decay_rate;
  all.values.resize(lines, s.shapes.rows() * references);
  for (Index o = 0; o < s.shapes.rows(); ++o) {
    for (Index j = 0; j < references; ++j) {
      for (Index k = 0; k < lines; ++k) {
        const Complex iw(0.0, kTwoPi * all.frequencies_hz[k]);
        const Complex at = iw + decay_rate;
        Complex sum = 0.0;
        for (Index r = 0; r < s.hz.size(); ++r) {
          const double w = kTwoPi * s.hz[r];
          sum += s.shapes(o, r) * s.shapes(j, r) /
                 (at * at + 2.0 * s.ratio[r] * w * at + w * w);
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

// A window of 0.3 s raises the damping of the first mode to 30 %, above the
// limit for modes.
TEST(FrfModesTest, WindowDoesNotHideDampedModes) {
  Structure s = SixMasses();
  s.ratio[5] = -0.001;
  const FrequencyResponses all = Responses(s, 1, 0.5, 20.0, 0.05, 1.0 / 0.3);
  ModesOfFrfs found;
  std::string error;
  ASSERT_TRUE(FindFrfModes(all, {}, &found, &error)) << error;
  ASSERT_EQ(found.record.modes.size(), 6u);
  for (size_t m = 0; m < 6; ++m) {
    const IdentifiedMode& mode = found.record.modes[m];
    const Index r = static_cast<Index>(m);
    EXPECT_NEAR(mode.frequency_hz, s.hz[r], 1e-5);
    EXPECT_NEAR(mode.damping_ratio, s.ratio[r], 1e-5);
    EXPECT_LE(mode.damping_lower95, mode.damping_ratio);
    EXPECT_GE(mode.damping_upper95, mode.damping_ratio);
  }
  EXPECT_THAT(found.record.remarks,
              ::testing::Contains(::testing::HasSubstr(
                  "The window hides the damping at 17.01 Hz")));
}

// Finds the six modes, each within four deviations of the structure's.
void FindSixModes(const FrequencyResponses& all, const Structure& s,
                  ModesOfFrfs* found) {
  std::string error;
  ASSERT_TRUE(FindFrfModes(all, {}, found, &error)) << error;
  ASSERT_EQ(found->record.modes.size(), 6u);
  for (size_t m = 0; m < 6; ++m) {
    const IdentifiedMode& mode = found->record.modes[m];
    const Index i = static_cast<Index>(m);
    EXPECT_LT(std::abs(mode.frequency_hz - s.hz[i]),
              4.0 * mode.frequency_sigma);
    EXPECT_LT(std::abs(mode.damping_ratio - s.ratio[i]),
              4.0 * mode.damping_sigma);
  }
}

TEST(FrfModesTest, NoisyFunctionsLieWithinTheirIntervals) {
  const Structure s = SixMasses();
  FrequencyResponses all = Responses(s, 1, 0.5, 20.0, 0.05);
  AddNoise(0.01, 1, &all);
  ModesOfFrfs found;
  ASSERT_NO_FATAL_FAILURE(FindSixModes(all, s, &found));
  for (const IdentifiedMode& mode : found.record.modes) {
    EXPECT_LT(mode.frequency_sigma, 1e-3 * mode.frequency_hz);
    EXPECT_LT(mode.damping_sigma, 0.05 * 0.02);
  }
}

TEST(FrfModesTest, NoiseOfEachLineIsFound) {
  const Structure s = SixMasses();
  FrequencyResponses all = Responses(s, 1, 0.5, 20.0, 0.05);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (Complex& value : all.values.reshaped()) {
    value *=
        1.0 + 0.01 / std::sqrt(2.0) * Complex(normal(random), normal(random));
  }
  ModesOfFrfs found;
  ASSERT_NO_FATAL_FAILURE(FindSixModes(all, s, &found));
  // The Cramer-Rao bound of the first frequency under this noise is 7.3e-5 Hz,
  // see tests/benchmarks/frf_modes.py.
  EXPECT_NEAR(found.record.modes[0].frequency_sigma, 7.3e-5, 1.5e-5);
}

TEST(FrfModesTest, TwoReferencesTellCloseModesApart) {
  Structure s = SixMasses();
  s.hz[3] = 10.0;
  s.hz[4] = 10.1;
  s.ratio.setConstant(0.01);
  FrequencyResponses all = Responses(s, 2, 0.5, 20.0, 0.05);
  AddNoise(0.01, 2, &all);
  ModesOfFrfs found;
  ASSERT_NO_FATAL_FAILURE(FindSixModes(all, s, &found));
  for (const IdentifiedMode& mode : found.record.modes) {
    EXPECT_LT(mode.frequency_sigma, 0.01);
  }
}

// Modal mass of the shape whose largest entry is 1: 1 / (largest entry)^2.
TEST(FrfModesTest, DrivingPointGivesModalMassAndItsSignIsChecked) {
  const Structure s = SixMasses();
  FrequencyResponses all = Responses(s, 1, 0.5, 20.0, 0.05);
  AddNoise(0.01, 4, &all);
  for (const double sign : {1.0, -1.0}) {
    FrequencyResponses turned = all;
    turned.values *= sign;
    ModesOfFrfs found;
    std::string error;
    ASSERT_TRUE(FindFrfModes(turned, {}, &found, &error)) << error;
    ASSERT_EQ(found.scales.size(), 6u);
    for (size_t m = 0; m < 6; ++m) {
      const double largest =
          s.shapes.col(static_cast<Index>(m)).cwiseAbs().maxCoeff();
      EXPECT_LT(
          std::abs(found.scales[m].modal_mass - 1.0 / (largest * largest)),
          4.0 * found.scales[m].modal_mass_sigma);
      EXPECT_LT(found.scales[m].modal_mass_sigma, 0.02);
    }
    bool says_so = false;
    for (const std::string& remark : found.record.remarks) {
      if (remark.find("opposite directions") != std::string::npos)
        says_so = true;
    }
    EXPECT_EQ(says_so, sign < 0.0);
  }
}

// Six files whose structure drifts by 0.2 % from the first to the last.
TEST(FrfModesTest, PolesOfEachFileFollowADrift) {
  FrequencyResponses all = Responses(SixMasses(), 1, 0.5, 20.0, 0.05);
  for (Index o = 0; o < 6; ++o) {
    Structure s = SixMasses();
    s.hz *= 1.0 + 4e-4 * (static_cast<double>(o) - 2.5);
    all.values.col(o) = Responses(s, 1, 0.5, 20.0, 0.05).values.col(o);
    all.files[static_cast<size_t>(o)] = static_cast<int>(o);
  }
  AddNoise(0.002, 5, &all);
  FrfModesOptions options;
  options.poles_per_file = true;
  ModesOfFrfs found;
  std::string error;
  ASSERT_TRUE(FindFrfModes(all, options, &found, &error)) << error;
  ASSERT_EQ(found.record.modes.size(), 6u);
  const double drift = 4e-4 * std::sqrt(35.0 / 12.0 * 6.0 / 5.0);
  for (size_t m = 0; m < 6; ++m) {
    const double hz = SixMasses().hz[static_cast<Index>(m)];
    const IdentifiedMode& mode = found.record.modes[m];
    EXPECT_NEAR(mode.frequency_hz / hz, 1.0, drift);
    EXPECT_GT(mode.frequency_sigma / hz, 0.5 * drift);
    EXPECT_LT(mode.frequency_sigma / hz, 2.0 * drift);
  }
  EXPECT_LT(found.errors.maxCoeff(), 0.004);
}

// FRFs of a free beam hit at nine points, near its modes. The figures are means
// of fits of single modes to each file. The accelerometer is at point 4,
// upside down.
TEST(FrfModesTest, MeasuredBeam) {
  PINODE_FIND_MEASURED_DATA(folder, "frf/free_beam");
  std::vector<FrequencyResponse> single;
  std::vector<std::string> remarks;
  std::string error;
  for (int i = 1; i <= 9; ++i) {
    FrfFileOptions options;
    options.responses = {"p4"};
    options.references = {"p" + std::to_string(i)};
    ASSERT_TRUE(
        ReadFrfFile(folder + "/Hxysv0000" + std::to_string(i) + ".txt.gz",
                    options, &single, &remarks, &error))
        << error;
  }
  FrequencyResponses all;
  ASSERT_TRUE(AssembleFrequencyResponses(single, &all, &error)) << error;
  EXPECT_EQ(all.derivative, 2);
  const struct {
    double from, to, hz, percent;
  } modes[] = {{108.0, 116.0, 111.9943, 0.0142},
               {300.0, 312.0, 306.8547, 0.0120},
               {590.0, 600.0, 596.3684, 0.0100},
               {970.0, 980.0, 974.1360, 0.0109}};
  for (const auto& expected : modes) {
    FrfModesOptions options;
    options.poles_per_file = true;
    options.identification.lowest_hz = expected.from;
    options.identification.highest_hz = expected.to;
    options.identification.stabilisation.pick = {expected.hz};
    ModesOfFrfs found;
    ASSERT_TRUE(FindFrfModes(all, options, &found, &error)) << error;
    ASSERT_EQ(found.record.modes.size(), 1u);
    EXPECT_NEAR(found.record.modes[0].frequency_hz, expected.hz, 0.005);
    EXPECT_NEAR(100.0 * found.record.modes[0].damping_ratio, expected.percent,
                0.1 * expected.percent);
  }
}

}  // namespace
}  // namespace pinode
