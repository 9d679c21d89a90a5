#include "pinode/modal/merge_setups.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/modal_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

// Returns the modes from channels `rows` of a record of the chain.
SetupModes FindSetup(const TestChain& chain, const std::string& name,
                     const std::vector<int>& rows, unsigned seed) {
  const ResponseRecord all = SimulateChain(chain, 0.01, 60000, seed);
  ResponseRecord record = all;
  record.name = name;
  record.channels.clear();
  record.samples.resize(static_cast<Eigen::Index>(rows.size()),
                        all.samples.cols());
  SetupModes setup;
  setup.name = name;
  for (size_t i = 0; i < rows.size(); ++i) {
    record.channels.push_back(all.channels[static_cast<size_t>(rows[i])]);
    record.samples.row(static_cast<Eigen::Index>(i)) = all.samples.row(rows[i]);
    setup.places.push_back(record.channels.back().name);
  }
  ModesOfRecord modes;
  std::string error;
  EXPECT_TRUE(IdentifyModes(record, {}, &modes, &error)) << error;
  setup.modes = modes.modes;
  return setup;
}

TEST(MergeSetupsTest, TiesShapesTogetherAtReferences) {
  const TestChain chain(5, 6000.0);
  // Each set-up has its own scale: another seed, other forces.
  const std::vector<SetupModes> setups = {FindSetup(chain, "a", {0, 1, 4}, 1),
                                          FindSetup(chain, "b", {2, 1, 4}, 2),
                                          FindSetup(chain, "c", {3, 1, 4}, 3)};
  MergedModes merged;
  std::string error;
  ASSERT_TRUE(MergeSetups(setups, {}, &merged, &error)) << error;
  EXPECT_THAT(merged.places, ElementsAre("u1", "u2", "u5", "u3", "u4"));
  ASSERT_THAT(merged.modes, SizeIs(5));
  const std::vector<int> rows = {0, 1, 4, 2, 3};
  for (int m = 0; m < 5; ++m) {
    const MergedMode& found = merged.modes[static_cast<size_t>(m)];
    EXPECT_NEAR(found.mode.frequency_hz, chain.frequency_hz[m],
                4.0 * found.mode.frequency_sigma);
    EXPECT_THAT(found.in_setups, ElementsAre(m, m, m));
    EXPECT_LT(found.frequency_between, 0.003 * chain.frequency_hz[m]);
    Eigen::Index largest = 0;
    found.mode.shape.cwiseAbs().maxCoeff(&largest);
    const Vector shape = chain.shapes.col(m);
    for (Eigen::Index i = 0; i < 5; ++i) {
      const double expected = shape[rows[static_cast<size_t>(i)]] /
                              shape[rows[static_cast<size_t>(largest)]];
      EXPECT_NEAR(found.mode.shape[i].real(), expected,
                  4.0 * found.mode.shape_sigma_real[i] + 1e-12)
          << "mode " << m << ", place " << i;
    }
  }
  // The covariance of frequency, damping and shape together is valid.
  for (const MergedMode& found : merged.modes) {
    const Matrix& covariance = found.mode.covariance;
    EXPECT_NEAR(std::sqrt(covariance(0, 0)), found.mode.frequency_sigma,
                1e-9 * found.mode.frequency_sigma);
    EXPECT_NEAR(std::sqrt(covariance(1, 1)), found.mode.damping_sigma,
                1e-9 * found.mode.damping_sigma);
    const Vector scales =
        covariance.diagonal().cwiseSqrt().cwiseMax(1e-12).cwiseInverse();
    const Matrix correlation =
        scales.asDiagonal() * covariance * scales.asDiagonal();
    EXPECT_GT(
        Eigen::SelfAdjointEigenSolver<Matrix>(correlation).eigenvalues()[0],
        -1e-6);
  }
  // Three records know a frequency better than one.
  EXPECT_LT(merged.modes[2].mode.frequency_sigma,
            setups[0].modes[2].frequency_sigma);
}

TEST(MergeSetupsTest, OneSetupIsReturnedAsItIs) {
  SetupModes setup;
  setup.name = "a";
  setup.places = {"x"};
  setup.modes.resize(2);
  setup.modes[1].frequency_hz = 3.0;
  MergedModes merged;
  std::string error;
  ASSERT_TRUE(MergeSetups({setup}, {}, &merged, &error));
  ASSERT_THAT(merged.modes, SizeIs(2));
  EXPECT_EQ(merged.modes[1].mode.frequency_hz, 3.0);
}

TEST(MergeSetupsTest, NeedsAPlaceInCommon) {
  SetupModes a, b;
  a.name = "a";
  a.places = {"x"};
  b.name = "b";
  b.places = {"y"};
  MergedModes merged;
  std::string error;
  EXPECT_FALSE(MergeSetups({a, b}, {}, &merged, &error));
  EXPECT_THAT(error, HasSubstr("no common place"));
  MergeOptions options;
  options.references = {"x"};
  EXPECT_FALSE(MergeSetups({a, b}, options, &merged, &error));
  EXPECT_THAT(error, HasSubstr("'x' is not in record 'b'"));
}

}  // namespace
}  // namespace pinode
