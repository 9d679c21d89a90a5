// data/three_storey_ambient: storeys from wind that nobody measured, by
// default, and what happens where the wind is taken for something that it is
// not.

#include <cmath>
#include <string>

#include "gtest/gtest.h"
#include "pinode/base/figure_testing.h"
#include "tests/cases/measure.h"

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
  ASSERT_TRUE(run.summary.usable) << run.summary.message;
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
  EXPECT_FALSE(run.summary.usable);
  EXPECT_NE(run.summary.message.find("spectra of ambient record 'wind'"),
            std::string::npos)
      << run.summary.message;
}

}  // namespace
}  // namespace testing
}  // namespace pinode
