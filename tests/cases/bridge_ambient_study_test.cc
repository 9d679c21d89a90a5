// data/bridge_ambient: what a long-span girder is made of, from wind and
// traffic that nobody measured. Minutes, so run by hand (ctest --preset study).

#include <cmath>
#include <string>

#include "gtest/gtest.h"
#include "tests/cases/measure.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace testing {
namespace {

TEST(BridgeAmbientStudy, GroupsWithinTheirIntervals) {
  const CaseRun run =
      RunCase(ReadCaseOrFail("data/bridge_ambient/bridge_ambient.toml"));
  ASSERT_TRUE(run.summary.usable()) << run.summary.message;
  ASSERT_EQ(run.summary.ambient.size(), 2u);
  for (const ParameterEstimate& found : run.summary.parameters) {
    const double truth =
        Truth("data/bridge_ambient/truth.json", "/groups/" + found.name);
    ReportFigure("bridge_ambient: " + found.name + ", deviations", AtMost(3.5),
                 std::abs(found.value - truth) / found.sigma);
    EXPECT_NEAR(found.value, truth, 3.5 * found.sigma) << found.name;
  }
}

}  // namespace
}  // namespace testing
}  // namespace pinode
