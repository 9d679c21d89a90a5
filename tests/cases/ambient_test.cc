// data/three_storey_ambient: storeys from wind that nobody measured, by
// default, and what happens where the wind is taken for something that it is
// not.

#include <cmath>
#include <string>

#include "gtest/gtest.h"
#include "pinode/case/run/fit_case.h"
#include "tests/cases/measure.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace testing {
namespace {

constexpr char kCase[] = "data/three_storey_ambient/three_storey_ambient.toml";

double TruthOf(const std::string& name) {
  if (name == "k1") return 0.25;
  if (name == "k2") return -3.0 / 23.0;
  if (name == "k3") return -1.0 / 11.0;
  return 3.0 / 7.0;
}

TEST(AmbientCase, StoreysUnderWind) {
  const CaseRun run = RunCase(ReadCaseOrFail(kCase));
  ASSERT_TRUE(run.summary.usable()) << run.summary.message;
  for (const ParameterEstimate& found : run.summary.parameters) {
    ReportFigure("three_storey_ambient: " + found.name + ", deviations",
                 AtMost(3.5),
                 std::abs(found.value - TruthOf(found.name)) / found.sigma);
    EXPECT_NEAR(found.value, TruthOf(found.name), 3.5 * found.sigma);
    // Cramer-Rao: 0.0018, 0.0011, 0.0012.
    EXPECT_LT(found.sigma, found.name[0] == 'k' ? 0.0025 : 0.2);
  }
  ASSERT_EQ(run.summary.ambient.size(), 1u);
  EXPECT_GT(run.summary.ambient[0].probability, 0.01);
  EXPECT_EQ(run.summary.covariance_method, "plain");
}

// White forces that have nothing in common: the spectra say that it is not so.
TEST(AmbientCase, WindIsNotWhite) {
  Case c = ReadCaseOrFail(kCase);
  c.problem.ambient[0].knots = 1;
  c.problem.ambient[0].correlated = false;
  const CaseRun run = RunCase(std::move(c));
  EXPECT_FALSE(run.summary.usable());
  EXPECT_NE(run.summary.message.find("spectra of ambient record 'wind'"),
            std::string::npos)
      << run.summary.message;
}

// Loads that come twice, the second time weaker and a twentieth of a second
// later: their spectrum has a knee finer than an octave. A case that does not
// say how fine it is is fitted all the same, and by finer knots alone.
TEST(AmbientCase, AnEchoOfTheWindAsksForFinerSpectra) {
  constexpr Eigen::Index kDelay = 5;  // samples
  Case c = ReadCaseOrFail(kCase);
  Matrix& samples = c.problem.ambient[0].samples;
  const Eigen::Index rest = samples.cols() - kDelay;
  const Matrix echo = 0.6 * samples.leftCols(rest);
  samples.rightCols(rest) += echo;
  const CaseRun coarse = RunCase(c);
  EXPECT_FALSE(coarse.summary.usable());
  EXPECT_FALSE(coarse.summary.learns_force);
  ASSERT_EQ(coarse.summary.ambient.size(), 1u);

  IdentificationSummary summary;
  IdentifiedModel model;
  std::string error;
  CaseWatch watch;
  ASSERT_TRUE(
      FitCase(ResultFolder(), nullptr, &watch, &c, &summary, &model, &error))
      << error;
  ASSERT_TRUE(summary.usable()) << summary.message;
  EXPECT_GT(summary.ambient[0].num_knots, coarse.summary.ambient[0].num_knots);
  EXPECT_EQ(c.problem.ambient[0].knots, summary.ambient[0].num_knots);
  for (const ParameterEstimate& found : summary.parameters) {
    EXPECT_NEAR(found.value, TruthOf(found.name), 3.5 * found.sigma)
        << found.name;
  }
}

}  // namespace
}  // namespace testing
}  // namespace pinode
