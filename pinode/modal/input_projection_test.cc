#include "pinode/modal/input_projection.h"

#include <cmath>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/statistics.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/modal/stabilisation.h"
#include "tests/support/modal_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

ModesOfRecord IdentifyOrFail(const ResponseRecord& record,
                             const ModeIdentificationOptions& options = {}) {
  ModesOfRecord result;
  std::string error;
  EXPECT_TRUE(IdentifyModes(record, options, &result, &error)) << error;
  return result;
}

// Without noise, sums over the same samples cancel exactly for any ground
// motion. It causes no additional mode, and the standard deviations are zero.
TEST(InputProjectionTest, ExactWithoutNoise) {
  const TestChain chain(3, 900.0);
  TestExcitation excitation;
  excitation.base = true;
  excitation.memory = 0.97;
  excitation.sensor_noise = 0.0;
  excitation.measured = 1;
  const ResponseRecord record =
      SimulateChain(chain, 0.02, 20000, 3, {2}, excitation);
  Eigen::Index window = 0;
  const HankelWindows hankel = ProjectInput(
      std::make_shared<Matrix>(record.samples),
      std::make_shared<Matrix>(record.inputs), {0, 1, 2}, 20, 40, 2, &window);
  SubspaceOptions options;
  options.block_rows = 20;
  options.max_order = 6;
  std::vector<SubspacePole> poles;
  std::string error;
  ASSERT_TRUE(IdentifySubspace(hankel, 0.02, options, 2, &poles, &error))
      << error;
  int exact = 0;
  for (const SubspacePole& pole : poles) {
    if (pole.order != 6) continue;
    const double f = chain.frequency_hz[exact++];
    EXPECT_NEAR(pole.frequency(), f, 1e-6 * f);
    EXPECT_NEAR(pole.damping_ratio(), 0.01, 1e-6);
    EXPECT_LT(
        FindPoleSigmas(pole, 0.02 * static_cast<double>(window)).frequency,
        1e-6 * f);
  }
  EXPECT_EQ(exact, 3);
}

// Ground motion with its own peak, which the response alone would show as a
// mode, and unmeasured wind.
TEST(InputProjectionFigures, TheInputHasNoModes) {
  const TestChain chain(3, 4000.0);
  TestExcitation excitation;
  excitation.base = true;
  excitation.memory = 0.9;
  excitation.sensor_noise = 0.05;
  excitation.measured = 1;
  ResponseRecord record = SimulateChain(chain, 0.01, 30000, 5, {2}, excitation);
  record.samples.row(1) *= 1000.0;  // units do not matter
  ModesOfRecord result = IdentifyOrFail(record);
  EXPECT_EQ(result.method, ModalMethod::kInputOutput);
  EXPECT_EQ(DifferenceFromChain(chain, result, 4.0), "");
  ModeIdentificationOptions options;
  options.method = ModalMethod::kCovarianceDriven;
  const ModesOfRecord without = IdentifyOrFail(record, options);
  // Measuring the load makes damping more certain.
  ASSERT_GE(without.modes.size(), 3u);
  EXPECT_LT(result.modes[0].damping_sigma, without.modes[0].damping_sigma);
}

TEST(InputProjectionTest, GapsHaveNoWeight) {
  const TestChain chain(2, 900.0);
  TestExcitation excitation;
  excitation.common = 0.0;
  excitation.measured = 1;
  ResponseRecord record = SimulateChain(chain, 0.02, 20000, 8, {2}, excitation);
  record.samples.block(0, 5000, 1, 400).setConstant(kNaN);
  record.samples(1, 9000) = kNaN;
  EXPECT_EQ(DifferenceFromChain(chain, IdentifyOrFail(record), 4.0), "");
}

// One of three forces is measured: intervals contain the truth as often as
// stated. A few records; many are in tests/cases/modes_study_test.cc.
TEST(InputProjectionFigures, IntervalsHoldTheTruth) {
  const TestChain chain(3, 2000.0);
  TestExcitation excitation;
  excitation.common = 0.0;
  excitation.measured = 1;
  int inside = 0;
  int count = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const ModesOfRecord result = IdentifyOrFail(
        SimulateChain(chain, 0.02, 15000, seed, {2}, excitation));
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
  EXPECT_GE(count, 22);
  EXPECT_GE(inside, 0.8 * count) << inside << " of " << count;
}

TEST(InputProjectionTest, NeedsAnInput) {
  ModeIdentificationOptions options;
  options.method = ModalMethod::kInputOutput;
  ModesOfRecord result;
  std::string error;
  ResponseRecord record = SimulateChain(TestChain(2, 900.0), 0.02, 20000, 8);
  EXPECT_FALSE(IdentifyModes(record, options, &result, &error));
  EXPECT_THAT(error, HasSubstr("has no measured load"));
  record.inputs = Matrix::Zero(1, 7);
  EXPECT_FALSE(IdentifyModes(record, options, &result, &error));
  EXPECT_THAT(error, HasSubstr("loads of 7 samples"));
}

}  // namespace
}  // namespace pinode
