#include "pinode/estimate/ambient/ambient_loads.h"

#include <cmath>
#include <vector>

#include "gtest/gtest.h"

namespace pinode {
namespace {

constexpr double kSmallestNoise = 1e-7;

// Two loads at three knots, correlated as uncorrelated ones become, then moved.
AmbientLoads CorrelatedLoads() {
  const LoadSpectrum spectrum(1.0, 8.0, 3, 2, /*correlated=*/true);
  AmbientLoads loads(spectrum, Vector::Constant(2, kSmallestNoise));
  loads.MakeUncorrelated();
  loads.SetIntensities(
      (Matrix(2, 3) << 4.0, 2.0, 0.3, 1.0, 0.7, 0.2).finished(),
      Vector::Constant(2, -1.0));
  loads.SetPowers();
  loads.MakeCorrelated(spectrum);
  const Vector step = Vector::LinSpaced(loads.num_unknowns(), -0.05, 0.1);
  loads.SetUnknowns(loads.Moved(loads.unknowns(), step));
  return loads;
}

TEST(AmbientLoadsTest, PriorHasTheGradientOfItsCost) {
  AmbientLoads loads = CorrelatedLoads();
  ASSERT_TRUE(loads.has_prior());
  const Vector at = loads.unknowns();
  const Vector gradient = loads.PriorSums(nullptr).gradient;
  constexpr double kStep = 1e-5;
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    double slope = 0.0;
    for (const double side : {1.0, -1.0}) {
      loads.SetUnknowns(at + side * kStep * Vector::Unit(at.size(), i));
      double cost = 0.0;
      loads.AddPrior(&cost, nullptr);
      slope += side * cost / (2.0 * kStep);
    }
    EXPECT_NEAR(gradient[i], slope, 1e-6) << i;
  }
}

TEST(AmbientLoadsTest, RefinedLoadsAreTheSame) {
  const AmbientLoads loads = CorrelatedLoads();
  const AmbientLoads finer = loads.Refined();
  EXPECT_EQ(finer.spectrum().num_knots(), 5);
  EXPECT_TRUE(finer.has_prior());
  EXPECT_EQ(finer.Noise(), loads.Noise());
  const std::vector<Matrix> at_knots = loads.KnotCovariances();
  const std::vector<Matrix> at_finer_knots = finer.KnotCovariances();
  for (const double frequency : {1.0, 1.3, 2.5, 4.0, 7.0}) {
    const Matrix expected = loads.Covariance(frequency, at_knots);
    EXPECT_LT((finer.Covariance(frequency, at_finer_knots) - expected).norm(),
              1e-12 * expected.norm())
        << frequency;
  }
}

TEST(AmbientLoadsTest, SmallestNoiseDoesNotFall) {
  AmbientLoads loads = CorrelatedLoads();
  Vector unknowns = loads.unknowns();
  const Eigen::Index last = unknowns.size() - 1;
  unknowns[last] = 0.5 * std::log(kSmallestNoise);
  loads.SetUnknowns(unknowns);
  LikelihoodSums sums;
  sums.gradient = Vector::Ones(unknowns.size());
  sums.information = Matrix::Ones(unknowns.size(), unknowns.size());
  loads.HoldNoise(&sums);
  EXPECT_EQ(sums.gradient[last], 0.0);
  EXPECT_EQ(sums.gradient[last - 1], 1.0);
  EXPECT_EQ(sums.information(last, last), 1.0);
  EXPECT_EQ(sums.information(last, last - 1), 0.0);
}

}  // namespace
}  // namespace pinode
