#include "pinode/modal/identify_modes.h"

#include <cmath>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "tests/support/modal_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

ModesOfRecord FindOrFail(const ResponseRecord& record,
                         const ModeIdentificationOptions& options = {}) {
  ModesOfRecord result;
  std::string error;
  EXPECT_TRUE(IdentifyModes(record, options, &result, &error)) << error;
  return result;
}

// Checks that all modes of the chain and no others are found, each within
// `sigmas` standard deviations.
void ExpectModes(const TestChain& chain, const ModesOfRecord& result,
                 double sigmas) {
  std::string found;
  for (const IdentifiedMode& mode : result.modes) {
    found += std::to_string(mode.frequency_hz) + " +- " +
             std::to_string(mode.frequency_sigma) + " in " +
             std::to_string(mode.orders_seen) + " orders at " +
             std::to_string(1.0 / mode.sampling_step) + " Hz, ";
  }
  ASSERT_EQ(static_cast<int>(result.modes.size()), chain.masses()) << found;
  for (int m = 0; m < chain.masses(); ++m) {
    const IdentifiedMode& mode = result.modes[static_cast<size_t>(m)];
    EXPECT_NEAR(mode.frequency_hz, chain.frequency_hz[m],
                sigmas * mode.frequency_sigma);
    EXPECT_NEAR(mode.damping_ratio, chain.damping_ratio,
                sigmas * mode.damping_sigma);
    EXPECT_LT(mode.frequency_sigma, 0.005 * mode.frequency_hz);
    const Vector shape = chain.shapes.col(m);
    Eigen::Index largest = 0;
    mode.shape.cwiseAbs().maxCoeff(&largest);
    EXPECT_EQ(mode.shape[largest], 1.0);
    for (Eigen::Index i = 0; i < shape.size(); ++i) {
      if (i == largest) continue;
      EXPECT_NEAR(mode.shape[i].real(), shape[i] / shape[largest],
                  sigmas * mode.shape_sigma_real[i]);
      EXPECT_NEAR(mode.shape[i].imag(), 0.0,
                  sigmas * mode.shape_sigma_imaginary[i]);
    }
  }
}

TEST(IdentifyModesTest, FindsTheModesOfAChainAndNoOther) {
  const TestChain chain(4, 6000.0);
  ExpectModes(chain, FindOrFail(SimulateChain(chain, 0.01, 60000, 1)), 4.0);
}

TEST(IdentifyModesTest, QuantitiesMayBeMixed) {
  const TestChain chain(3, 900.0);
  TestExcitation excitation;
  excitation.memory = 0.9;
  ExpectModes(
      chain,
      FindOrFail(SimulateChain(chain, 0.02, 40000, 2, {0, 1, 2}, excitation)),
      4.0);
}

TEST(IdentifyModesFigures, ModesOverTwoDecades) {
  Matrix stiffness = Vector(Vector::Constant(4, 1.0)).asDiagonal();
  const Vector hz = (Vector(4) << 0.4, 2.2, 9.0, 33.0).finished();
  // Rotated, so that all sensors see all modes.
  Matrix turn = Matrix::Identity(4, 4);
  for (int i = 0; i < 3; ++i) {
    Eigen::Matrix2d r;
    r << 0.8, -0.6, 0.6, 0.8;
    turn.middleCols(i, 2) = turn.middleCols(i, 2) * r;
  }
  stiffness = turn * (kTwoPi * hz).cwiseAbs2().asDiagonal() * turn.transpose();
  const TestChain chain(stiffness, 0.01);
  const ModesOfRecord result =
      FindOrFail(SimulateChain(chain, 0.01, 120000, 5));
  EXPECT_GT(result.bands.size(), 3u);
  ExpectModes(chain, result, 4.0);
}

TEST(IdentifyModesTest, CloseModesWithDifferentShapesAreTwo) {
  const double w = kTwoPi * 3.0;
  Matrix stiffness(2, 2);
  // 1 % apart: (1 -+ 0.005).
  stiffness << 1.0, 0.01, 0.01, 1.0;
  const TestChain chain(w * w * stiffness, 0.01);
  ExpectModes(chain, FindOrFail(SimulateChain(chain, 0.02, 90000, 3)), 4.0);
}

TEST(IdentifyModesFigures, UnitsDoNotMatter) {
  const TestChain chain(3, 4000.0);
  ResponseRecord record = SimulateChain(chain, 0.01, 30000, 4);
  const ModesOfRecord first = FindOrFail(record);
  record.samples.row(1) *= 1024.0;
  const ModesOfRecord second = FindOrFail(record);
  ASSERT_EQ(first.modes.size(), second.modes.size());
  for (size_t m = 0; m < first.modes.size(); ++m) {
    EXPECT_NEAR(first.modes[m].frequency_hz, second.modes[m].frequency_hz,
                1e-9);
    EXPECT_NEAR(first.modes[m].damping_sigma, second.modes[m].damping_sigma,
                1e-9);
    EXPECT_LT(
        std::abs(first.modes[m].shape[1] / first.modes[m].shape[0] * 1024.0 -
                 second.modes[m].shape[1] / second.modes[m].shape[0]),
        1e-5);
  }
}

TEST(IdentifyModesTest, GapsAndThreadsAreAllowed) {
  const TestChain chain(3, 4000.0);
  ResponseRecord record = SimulateChain(chain, 0.01, 60000, 6);
  record.samples.block(1, 20000, 1, 500).setConstant(kNaN);
  ModeIdentificationOptions options;
  options.num_threads = 2;
  ExpectModes(chain, FindOrFail(record, options), 4.0);
}

TEST(IdentifyModesTest, PickedModesAlone) {
  const TestChain chain(3, 4000.0);
  ModeIdentificationOptions options;
  options.stabilisation.pick = {chain.frequency_hz[1] * 1.002, 40.0};
  const ModesOfRecord result =
      FindOrFail(SimulateChain(chain, 0.01, 30000, 4), options);
  ASSERT_GE(result.modes.size(), 1u);
  EXPECT_NEAR(result.modes[0].frequency_hz, chain.frequency_hz[1], 0.05);
}

TEST(IdentifyModesTest, NoiseHasNoModes) {
  ResponseRecord record = SimulateChain(TestChain(2, 4000.0), 0.01, 30000, 8);
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  for (double& value : record.samples.reshaped()) value = normal(random);
  EXPECT_THAT(FindOrFail(record).modes, IsEmpty());
}

// "option: message".
std::string ErrorOf(const ResponseRecord& record,
                    const ModeIdentificationOptions& options = {}) {
  ModesOfRecord result;
  std::string error;
  std::string option;
  EXPECT_FALSE(IdentifyModes(record, options, &result, &error, &option));
  return option + ": " + error;
}

TEST(IdentifyModesTest, SaysWhatIsWrong) {
  const ResponseRecord good =
      SimulateChain(TestChain(2, 4000.0), 0.01, 3000, 1);
  ResponseRecord record = good;
  record.samples.row(1).setConstant(3.0);
  EXPECT_THAT(ErrorOf(record),
              HasSubstr(": record 'ambient', channel 'u2' is dead"));
  record = good;
  record.samples = good.samples.leftCols(500).eval();
  EXPECT_THAT(ErrorOf(record), AllOf(StartsWith(": "), HasSubstr("too few")));
  ModeIdentificationOptions options;
  options.block_rows = 30;
  EXPECT_THAT(ErrorOf(record, options),
              AllOf(StartsWith("block_rows: "), HasSubstr("too few")));
  options = {};
  options.method = ModalMethod::kInputOutput;
  EXPECT_THAT(ErrorOf(good, options), StartsWith("method: "));
  options = {};
  options.lowest_hz = 60.0;
  EXPECT_THAT(ErrorOf(good, options), StartsWith("lowest_hz: "));
  options = {};
  options.highest_hz = 60.0;
  EXPECT_THAT(
      ErrorOf(good, options),
      AllOf(StartsWith("highest_hz: "), HasSubstr("half its sampling rate")));
  options = {};
  options.references = {"u7"};
  EXPECT_THAT(ErrorOf(good, options),
              HasSubstr("references: reference 'u7' is not a channel"));
  options = {};
  options.max_order = 400;
  EXPECT_THAT(ErrorOf(good, options),
              AllOf(StartsWith("max_order: "), HasSubstr("order 400")));
}

TEST(IdentifyModesTest, FaultsOfChannelsAreNamed) {
  ResponseRecord record = SimulateChain(TestChain(4, 4000.0), 0.01, 6000, 1);
  record.samples.row(1) = -2.0 * record.samples.row(0);
  const double limit = 0.5 * record.samples.row(2).cwiseAbs().maxCoeff();
  record.samples.row(2) =
      record.samples.row(2).cwiseMax(-limit / 2.0).cwiseMin(limit / 2.0).eval();
  for (Eigen::Index k = 1; k < 6000; ++k) {
    if (k % 4 != 0) record.samples(3, k) = record.samples(3, k - 1);
  }
  const std::vector<std::string> faults = FindChannelFaults(record);
  ASSERT_THAT(faults, SizeIs(3));
  EXPECT_THAT(faults[0], HasSubstr("'u2' is channel 'u1' again"));
  EXPECT_THAT(faults[1], HasSubstr("'u3' is clipped"));
  EXPECT_THAT(faults[2], HasSubstr("'u4' repeats itself"));
  EXPECT_THAT(
      FindChannelFaults(SimulateChain(TestChain(4, 4000.0), 0.01, 6000, 1)),
      IsEmpty());
}

}  // namespace
}  // namespace pinode
