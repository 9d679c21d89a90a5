#include "pinode/modal/harmonics.h"

#include <cmath>
#include <random>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/modal/identify_modes.h"
#include "tests/support/modal_testing.h"

namespace pinode {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

// Adds a sine of `size` standard deviations to all channels.
void AddSine(double hz, double size, ResponseRecord* record) {
  for (Eigen::Index c = 0; c < record->samples.rows(); ++c) {
    const double amplitude =
        size * std::sqrt(2.0 * record->samples.row(c).squaredNorm() /
                         static_cast<double>(record->num_samples()));
    for (Eigen::Index k = 0; k < record->num_samples(); ++k) {
      record->samples(c, k) +=
          amplitude * std::sin(kTwoPi * hz * record->sampling_step *
                               static_cast<double>(k));
    }
  }
}

TEST(HarmonicsTest, SineAndRandomVibrationDiffer) {
  const TestChain chain(2, 4000.0);
  ResponseRecord record = SimulateChain(chain, 0.01, 30000, 1);
  const ComplexVector shape = chain.shapes.col(0).cast<std::complex<double>>();
  const NarrowBand random =
      FindNarrowBand(record.samples, 0.01, shape, chain.frequency_hz[0]);
  EXPECT_FALSE(IsSine(random));
  EXPECT_LT(random.coherence, 0.6);
  AddSine(10.0, 0.3, &record);
  // The frequency need not be exact.
  const NarrowBand sine = FindNarrowBand(
      record.samples, 0.01, ComplexVector::Ones(2), 10.0 + 0.3 / 300.0);
  EXPECT_TRUE(IsSine(sine));
  EXPECT_NEAR(sine.kurtosis, 1.5, 0.1);
}

TEST(HarmonicsFigures, HarmonicIsNamedAndModesAreNot) {
  const TestChain chain(3, 4000.0);
  ResponseRecord record = SimulateChain(chain, 0.01, 60000, 3);
  AddSine(16.5, 0.3, &record);
  ModesOfRecord result;
  std::string error;
  ASSERT_TRUE(IdentifyModes(record, {}, &result, &error)) << error;
  int harmonics = 0;
  int modes = 0;
  for (const IdentifiedMode& mode : result.modes) {
    if (mode.is_harmonic) {
      ++harmonics;
      EXPECT_NEAR(mode.frequency_hz, 16.5, 0.01);
    } else {
      ++modes;
    }
  }
  EXPECT_EQ(harmonics, 1);
  EXPECT_EQ(modes, 3);
  EXPECT_THAT(result.remarks, Contains(HasSubstr("is a harmonic, not a mode")));
}

// Deviations of modes under random loads are not below Au's limit.
TEST(HarmonicsFigures, DeviationsRespectTheBoundOfRandomLoads) {
  const TestChain chain(4, 6000.0);
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const ResponseRecord record = SimulateChain(chain, 0.01, 20000, seed);
    ModesOfRecord result;
    std::string error;
    ASSERT_TRUE(IdentifyModes(record, {}, &result, &error)) << error;
    EXPECT_GE(result.modes.size(), 3u);
    for (const IdentifiedMode& mode : result.modes) {
      const double bound =
          std::sqrt(mode.damping_ratio /
                    (kTwoPi * mode.frequency_hz * record.duration()));
      EXPECT_GE(mode.frequency_sigma, 0.999 * bound * mode.frequency_hz);
      EXPECT_GE(mode.damping_sigma, 0.999 * bound);
    }
  }
}

}  // namespace
}  // namespace pinode
