// The frame on a shake table: fits of minutes, linear and with elements.

#include "gtest/gtest.h"
#include "tests/cases/shake_table_testing.h"

namespace pinode {
namespace testing {
namespace {

TEST_F(ShakeTable, StiffFrameLinear) {
  const CaseRun run = RunFrame(kStiff, false);
  EXPECT_TRUE(run.summary.usable()) << run.summary.message;
  const std::string what = "case 5, stiff, linear";
  ExpectFrequencies(run, what, {7.75, 24.8, 39.4}, {8.05, 25.3, 40.0});
  ExpectNrmseBesideOtherFit(run, what, {0.4282, 0.4086, 0.4140});
}

TEST_F(ShakeTable, FlexibleFrameLinear) {
  const CaseRun run = RunFrame(kFlexible, false);
  EXPECT_TRUE(run.summary.usable()) << run.summary.message;
  const std::string what = "case 5, flexible, linear";
  ExpectFrequencies(run, what, {3.65, 11.0, 16.4}, {3.80, 11.3, 16.8});
  ExpectNrmseBesideOtherFit(run, what, {0.2735, 0.2272, 0.2348});
}

TEST_F(ShakeTable, StiffFrameWithElements) {
  const CaseRun run = RunFrame(kStiff, true);
  EXPECT_TRUE(run.summary.usable()) << run.summary.message;
  const std::string what = "case 5, stiff, elements";
  ExpectNrmse(run, what, "second", {0.22, 0.18, 0.18});
  ExpectNrmse(run, what, "sine", {0.32, 0.28, 0.28});
  ReportBands(run, what);
}

TEST_F(ShakeTable, FlexibleFrameWithElements) {
  const CaseRun run = RunFrame(kFlexible, true);
  EXPECT_TRUE(run.summary.usable()) << run.summary.message;
  ExpectNrmse(run, "case 5, flexible, elements", "second", {0.29, 0.20, 0.20});
  ReportBands(run, "case 5, flexible, elements");
}

}  // namespace
}  // namespace testing
}  // namespace pinode
