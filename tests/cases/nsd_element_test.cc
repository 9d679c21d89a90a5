// The frame with the negative stiffness device, data/nsd: the device by an
// element. What instantiates these tests says on which ground motions.

#include <memory>
#include <string>
#include <utility>

#include "gtest/gtest.h"
#include "tests/cases/nsd_testing.h"

namespace pinode {
namespace testing {
namespace {

TEST_P(NsdElement, ElementFindsTheDeviceFromStarts50PercentOff) {
  const Case read = ReadPhase2("phase2_element");
  for (const double k : {0.5, 1.5}) {
    Case c = read;
    auto dynamics = std::make_shared<StructuralDynamics>(*c.problem.dynamics);
    // The element is the first block; its parameters are k and gap.
    ASSERT_EQ(dynamics->blocks()[0].parameters[0].name, "device.k");
    ASSERT_EQ(dynamics->blocks()[0].parameters[1].name, "device.gap");
    Vector theta = dynamics->Parameters();
    theta[0] = k * TrueDevice("k");
    theta[1] = (2.0 - k) * TrueDevice("gap");
    dynamics->SetParameters(theta);
    c.problem.dynamics = dynamics;
    const CaseRun run = RunCase(std::move(c));
    EXPECT_EQ(run.summary.termination, Termination::kConverged);
    ExpectDevice(
        run,
        What(std::string("element, slope ") + (k < 1 ? "half" : "1.5") +
             ", gap " + (k < 1 ? "1.5" : "half")),
        0.004, 0.02);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

TEST_P(NsdElement, ElementAndMatricesTogether) {
  const CaseRun run = RunCase(ReadPhase2("phase2_joint"));
  const std::string what = What("element, K and C refitted");
  ExpectDevice(run, what, 0.004, 0.002);
  const FoldedMatrices folded = Folded(run);
  ReportFigure(what + "K, worst entry in parts of the largest", Nothing(),
               WorstEntry(folded.stiffness, TrueMatrix("stiffness")));
  ReportFigure(what + "C, worst entry in parts of the largest", Nothing(),
               WorstEntry(folded.damping, TrueMatrix("damping")));
}

}  // namespace
}  // namespace testing
}  // namespace pinode
