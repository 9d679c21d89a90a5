#include "pinode/modal/modal_spectra.h"

#include <cmath>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/modal/spectra.h"
#include "tests/support/modal_testing.h"

namespace pinode {
namespace {

// The chain's own modes.
std::vector<IdentifiedMode> ModesOf(const TestChain& chain) {
  std::vector<IdentifiedMode> modes;
  for (const double frequency : chain.frequency_hz) {
    IdentifiedMode mode;
    mode.frequency_hz = frequency;
    mode.damping_ratio = chain.damping_ratio;
    modes.push_back(mode);
  }
  return modes;
}

TEST(ModalSpectraTest, ModesExplainAllButTheNoise) {
  const TestChain chain(3, 4000.0);  // 4.5, 12.6, 18.1 Hz
  TestExcitation excitation;
  excitation.memory = 0.5;
  excitation.sensor_noise = 0.3;
  const ResponseRecord record =
      SimulateChain(chain, 0.01, 120000, 3, {2, 1, 0}, excitation);
  const ModalSpectra spectra =
      FitModalSpectra(record, ModesOf(chain), 0.0, 50.0);
  ASSERT_EQ(spectra.explained.size(), 3);
  for (int c = 0; c < 3; ++c) {
    // Noise of 0.3 of the standard deviation, white up to 50 Hz.
    EXPECT_NEAR(spectra.explained[c], 1.0 / 1.09, 0.02) << c;
    // The model is the mean of the measured values, line by line.
    const Vector ratio = spectra.measured.row(c)
                             .cwiseQuotient(spectra.modelled.row(c))
                             .transpose();
    EXPECT_GT(spectra.modelled.row(c).minCoeff(), 0.0) << c;
    EXPECT_NEAR(ratio.mean(), 1.0, 0.02) << c;
    const double deviation = std::sqrt((ratio.array() - 1.0).square().mean());
    EXPECT_LT(deviation, 2.0 / std::sqrt(spectra.num_segments)) << c;
  }
}

// A mode that was not found is missing in the share, with its own power from
// the spectrum of a chain of that mode alone.
TEST(ModalSpectraTest, AModeThatIsMissingIsNotExplained) {
  const TestChain chain(3, 4000.0);
  const ResponseRecord record = SimulateChain(chain, 0.01, 120000, 3);
  std::vector<IdentifiedMode> modes = ModesOf(chain);
  const Spectra spectra = EstimateSpectra(record, 0, 0);
  double near = 0.0;
  for (Eigen::Index f = 0; f < spectra.frequency_hz.size(); ++f) {
    if (std::abs(spectra.frequency_hz[f] - modes[1].frequency_hz) < 1.5) {
      near += spectra.densities(0, f) / spectra.densities.row(0).sum();
    }
  }
  EXPECT_GT(near, 0.1);
  const double all = FitModalSpectra(record, modes, 0.0, 50.0).explained[0];
  modes.erase(modes.begin() + 1);
  const double without = FitModalSpectra(record, modes, 0.0, 50.0).explained[0];
  EXPECT_GT(all, 0.95);
  EXPECT_NEAR(all - without, near, 0.25 * near);
}

TEST(ModalSpectraTest, NoModesExplainNothing) {
  const ResponseRecord record =
      SimulateChain(TestChain(2, 4000.0), 0.01, 20000, 1);
  const ModalSpectra spectra = FitModalSpectra(record, {}, 1.0, 20.0);
  EXPECT_NEAR(spectra.explained[0], 0.0, 1e-12);
  EXPECT_GE(spectra.frequency_hz[0], 1.0);
  EXPECT_LE(spectra.frequency_hz.tail(1)[0], 20.0);
}

TEST(ModalSpectraTest, AChannelWithoutPowerIsNotExplained) {
  const TestChain chain(2, 4000.0);
  ResponseRecord record = SimulateChain(chain, 0.01, 20000, 1);
  record.samples.row(0).setZero();
  const ModalSpectra spectra =
      FitModalSpectra(record, ModesOf(chain), 0.0, 50.0);
  EXPECT_EQ(spectra.explained[0], 0.0);
  EXPECT_GT(spectra.explained[1], 0.5);
}

}  // namespace
}  // namespace pinode
