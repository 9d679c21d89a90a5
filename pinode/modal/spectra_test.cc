#include "pinode/modal/spectra.h"

#include <cmath>

#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "tests/support/modal_testing.h"

namespace pinode {
namespace {

TEST(SpectraTest, DensityOfWhiteNoiseIsItsVarianceOverTheBand) {
  ResponseRecord record = SimulateChain(TestChain(2, 4000.0), 0.01, 40000, 1);
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  for (double& value : record.samples.reshaped()) value = 3.0 * normal(random);
  const Spectra spectra = EstimateSpectra(record, 512, 2);
  EXPECT_EQ(spectra.frequency_hz[255], 50.0);
  // One-sided, 9 over 50 Hz.
  EXPECT_NEAR(spectra.densities.row(0).head(255).mean(), 9.0 / 50.0, 0.003);
  // Two channels without correlation have about equal values.
  EXPECT_GT(spectra.singular_values.row(1).mean(),
            0.7 * spectra.singular_values.row(0).mean());
}

TEST(SpectraTest, FirstSingularValueRisesAtModes) {
  const TestChain chain(3, 4000.0);
  const Spectra spectra =
      EstimateSpectra(SimulateChain(chain, 0.01, 40000, 1), 0, 3);
  for (int m = 0; m < 3; ++m) {
    Eigen::Index nearest = 0;
    (spectra.frequency_hz.array() - chain.frequency_hz[m])
        .abs()
        .minCoeff(&nearest);
    EXPECT_GT(spectra.singular_values.row(0).segment(nearest - 1, 3).maxCoeff(),
              10.0 * spectra.singular_values(1, nearest));
  }
}

}  // namespace
}  // namespace pinode
