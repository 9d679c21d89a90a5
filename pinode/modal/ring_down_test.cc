#include "pinode/modal/ring_down.h"

#include <cmath>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/modal/identify_modes.h"
#include "tests/support/modal_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

ModesOfRecord DecayModes(const ResponseRecord& record,
                         const ModeIdentificationOptions& options = {}) {
  ModesOfRecord result;
  std::string error;
  EXPECT_TRUE(IdentifyModes(record, options, &result, &error)) << error;
  return result;
}

TEST(RingDownTest, ExactWithoutNoise) {
  const TestChain chain(3, 900.0);
  const ResponseRecord record = SimulateRingDown(chain, 0.02, 800, 1, 0.0);
  SubspaceOptions options;
  options.block_rows = 40;
  options.max_order = 6;
  std::vector<SubspacePole> poles;
  std::string error;
  const RingDown decay = RingDownHankel(record.samples, 40, 6);
  ASSERT_TRUE(IdentifySubspace(decay.hankel, 0.02, options, 2, &poles, &error));
  EXPECT_LT(decay.noise.maxCoeff(), 1e-9);
  int exact = 0;
  for (const SubspacePole& pole : poles) {
    if (pole.order != 6) continue;
    const int m = exact++;
    EXPECT_NEAR(pole.frequency(), chain.frequency_hz[m], 1e-9);
    EXPECT_NEAR(pole.damping_ratio(), 0.01, 1e-9);
    const Eigen::VectorXcd shape = pole.shape / pole.shape[0];
    const Vector expected = chain.shapes.col(m) / chain.shapes(0, m);
    EXPECT_LT((shape - expected).norm(), 1e-7);
  }
  EXPECT_EQ(exact, 3);
}

TEST(RingDownFigures, FindsTheModesAndNoOther) {
  const TestChain chain(4, 6000.0);
  const ModesOfRecord result =
      DecayModes(SimulateRingDown(chain, 0.01, 3000, 2, 0.1));
  EXPECT_EQ(result.method, ModalMethod::kRingDown);
  EXPECT_EQ(DifferenceFromChain(chain, result, 4.0), "");
  for (size_t m = 0; m < result.modes.size(); ++m) {
    const IdentifiedMode& mode = result.modes[m];
    EXPECT_GT(mode.phase_collinearity, 0.99);
    EXPECT_LT(mode.frequency_sigma, 0.001 * mode.frequency_hz);
  }
}

// A few decays; many are in tests/cases/modes_study_test.cc.
TEST(RingDownFigures, IntervalsHoldTheTruth) {
  const TestChain chain(3, 900.0);
  int inside = 0;
  int count = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const ModesOfRecord result =
        DecayModes(SimulateRingDown(chain, 0.02, 1000, seed, 0.1));
    for (const IdentifiedMode& mode : result.modes) {
      for (int m = 0; m < 3; ++m) {
        if (std::abs(mode.frequency_hz / chain.frequency_hz[m] - 1.0) > 0.02) {
          continue;
        }
        count += 2;
        inside += mode.frequency_lower95 <= chain.frequency_hz[m] &&
                  mode.frequency_upper95 >= chain.frequency_hz[m];
        inside += mode.damping_lower95 <= 0.01 && mode.damping_upper95 >= 0.01;
      }
    }
  }
  EXPECT_EQ(count, 36);
  EXPECT_GE(inside, 30) << inside << " of " << count;
}

// The fit of a decay removes noise at its frequency. The series contain that
// noise again.
TEST(RingDownTest, NoiseSeriesAreAsLargeAtAModeAsNoiseIs) {
  constexpr double kStepSize = 0.02;
  constexpr double kNoise = 0.1;
  const TestChain chain(3, 900.0);
  const double w = kTwoPi * chain.frequency_hz[0];
  const std::complex<double> s(-0.01 * w, w);
  double ratio = 0.0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const ResponseRecord quiet =
        SimulateRingDown(chain, kStepSize, 1000, seed, 0.0);
    const ResponseRecord record =
        SimulateRingDown(chain, kStepSize, 1000, seed, kNoise);
    const RingDown decay = RingDownHankel(record.samples, 100, 60);
    const Eigen::Index size = decay.samples.cols();
    ComplexVector mode(size);
    for (Eigen::Index k = 0; k < size; ++k) {
      mode[k] = std::exp(s * kStepSize * static_cast<double>(k));
    }
    for (int b = 0; b < kNoiseSeries; ++b) {
      const ComplexVector seen =
          decay.noise_series(b).cast<std::complex<double>>() * mode.conjugate();
      for (Eigen::Index c = 0; c < 3; ++c) {
        const double variance =
            kNoise * kNoise * quiet.samples.row(c).squaredNorm() / 1000.0;
        ratio += std::norm(seen[c]) / (variance * mode.squaredNorm());
      }
    }
  }
  ratio /= 6.0 * 3.0 * kNoiseSeries;
  EXPECT_GT(ratio, 0.7);
  EXPECT_LT(ratio, 1.3);
}

// Least squares over the whole decay, not over its first samples.
TEST(RingDownFigures, ShapesAreAsGoodAsTheDecayAllows) {
  const TestChain chain(3, 900.0);
  double squares = 0.0;
  double count = 0.0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const ModesOfRecord result =
        DecayModes(SimulateRingDown(chain, 0.02, 1000, seed, 0.1));
    ASSERT_EQ(result.modes.size(), 3u) << seed;
    const IdentifiedMode& mode = result.modes[0];
    const Vector expected = chain.shapes.col(0) / chain.shapes(2, 0);
    for (Eigen::Index i = 0; i < 2; ++i) {
      squares += std::norm(
          (mode.shape[i] - expected[i]) /
          std::hypot(mode.shape_sigma_real[i], mode.shape_sigma_imaginary[i]));
      count += 1.0;
    }
  }
  EXPECT_LT(squares / count, 2.0);
}

// The other modes decay too.
TEST(RingDownTest, OneModeIsPicked) {
  const TestChain chain(3, 900.0);
  ModeIdentificationOptions options;
  options.stabilisation.pick = {chain.frequency_hz[0]};
  const ModesOfRecord result =
      DecayModes(SimulateRingDown(chain, 0.02, 1000, 1, 0.01), options);
  ASSERT_EQ(result.modes.size(), 1u);
  const Vector expected = chain.shapes.col(0) / chain.shapes(2, 0);
  EXPECT_LT((result.modes[0].shape - expected).norm(), 0.003);
}

TEST(RingDownTest, NoiseHasNoModes) {
  ResponseRecord record =
      SimulateRingDown(TestChain(2, 900.0), 0.02, 2000, 1, 0.0);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (double& value : record.samples.reshaped()) value = normal(random);
  const ModesOfRecord result = DecayModes(record);
  EXPECT_THAT(result.modes, IsEmpty());
  EXPECT_THAT(result.remarks, Not(IsEmpty()));
}

TEST(RingDownTest, SaysWhatIsWrong) {
  ResponseRecord record =
      SimulateRingDown(TestChain(2, 900.0), 0.02, 2000, 1, 0.01);
  record.samples(1, 30) = kNaN;
  ModesOfRecord result;
  std::string error;
  EXPECT_FALSE(IdentifyModes(record, {}, &result, &error));
  EXPECT_THAT(error, HasSubstr("missing samples"));
  record.samples(1, 30) = 0.0;
  ModeIdentificationOptions options;
  options.block_rows = 1000;
  EXPECT_FALSE(IdentifyModes(record, options, &result, &error));
  EXPECT_THAT(error, HasSubstr("too few"));
}

}  // namespace
}  // namespace pinode
