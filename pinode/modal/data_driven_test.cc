#include "pinode/modal/data_driven.h"

#include <cmath>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/modal/mode_estimate.h"
#include "tests/support/modal_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// Left singular vectors of the projection itself, the future's rows times the
// orthonormal rows of the past, against those of H T^(-1/2).
TEST(DataDrivenTest, SpansWhatTheProjectionSpans) {
  const ResponseRecord record =
      SimulateChain(TestChain(2, 900.0), 0.02, 60000, 1);
  constexpr int kRows = 6;
  const std::vector<int> references = {0, 1};
  const WindowedCorrelations correlations =
      CorrelateWindows(record.samples, references, 2 * kRows - 1, 200, 1);
  const HankelWindows hankel =
      DataDrivenHankel(correlations, references, kRows);
  const Eigen::Index count = record.num_samples() - 2 * kRows;
  Matrix past(2 * kRows, count);
  Matrix future(2 * kRows, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    for (int i = 0; i < kRows; ++i) {
      past.col(k).segment(2 * i, 2) = record.samples.col(k + kRows - 1 - i);
      future.col(k).segment(2 * i, 2) = record.samples.col(k + kRows + i);
    }
  }
  const Matrix gram = past * past.transpose();
  const Matrix cross = future * past.transpose();
  const Matrix projected =
      cross * gram.ldlt().solve(cross.transpose()) / static_cast<double>(count);
  const Matrix own = hankel.mean * hankel.mean.transpose();
  EXPECT_LT((own - projected).norm(), 0.02 * projected.norm());
}

TEST(DataDrivenFigures, FindsTheModesOfAChain) {
  const TestChain chain(3, 4000.0);
  const ResponseRecord record = SimulateChain(chain, 0.01, 60000, 7);
  ModeIdentificationOptions options;
  options.method = ModalMethod::kDataDriven;
  ModesOfRecord result;
  std::string error;
  ASSERT_TRUE(IdentifyModes(record, options, &result, &error)) << error;
  EXPECT_EQ(DifferenceFromChain(chain, result, 4.0), "");
  // The other method finds the same modes, and uses this one as a check.
  ModesOfRecord other;
  ASSERT_TRUE(IdentifyModes(record, {}, &other, &error)) << error;
  ASSERT_EQ(other.modes.size(), result.modes.size());
  for (size_t m = 0; m < result.modes.size(); ++m) {
    const double sigma = result.modes[m].frequency_sigma;
    EXPECT_NEAR(other.modes[m].frequency_hz, result.modes[m].frequency_hz,
                2.0 * sigma);
    EXPECT_NEAR(other.modes[m].check_frequency_hz, result.modes[m].frequency_hz,
                sigma);
    EXPECT_NEAR(other.modes[m].check_damping_ratio,
                result.modes[m].damping_ratio, result.modes[m].damping_sigma);
  }
  EXPECT_THAT(other.remarks,
              Not(::testing::Contains(HasSubstr("Data-driven"))));
}

TEST(DataDrivenTest, AModeThatOtherPolesDoNotSeeIsNotChecked) {
  PoleCluster cluster;
  cluster.mean.s = {-0.1, 10.0};
  cluster.mean.shape = Eigen::VectorXcd::Ones(2);
  std::vector<SubspacePole> poles;
  for (int order = 2; order <= 20; order += 2) {
    SubspacePole pole = cluster.mean;
    pole.order = order;
    pole.s = {-0.2, 10.05};
    poles.push_back(pole);
  }
  IdentifiedMode mode;
  CheckMode(cluster, poles, 20, {}, &mode);
  EXPECT_NEAR(mode.check_frequency_hz, poles[0].frequency(), 1e-12);
  EXPECT_NEAR(mode.check_damping_ratio, poles[0].damping_ratio(), 1e-12);
  mode = {};
  poles.resize(2);
  CheckMode(cluster, poles, 20, {}, &mode);
  EXPECT_TRUE(std::isnan(mode.check_frequency_hz));
}

}  // namespace
}  // namespace pinode
