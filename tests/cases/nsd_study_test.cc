// The frame with the negative stiffness device, data/nsd: what takes minutes,
// the device by a network on six inputs, and elements on measured ground
// motions.

#include "gtest/gtest.h"
#include "tests/cases/nsd_testing.h"

namespace pinode {
namespace testing {
namespace {

TEST_P(Nsd, NetworkOnSixInputsFindsTheDevice) {
  ExpectDevice(RunCase(ReadPhase2("phase2_network6")), What("NN2, six inputs"),
               0.03, 0.08);
}

INSTANTIATE_TEST_SUITE_P(Grounds, Nsd,
                         ::testing::Values("synthetic", "measured"),
                         GroundName);
INSTANTIATE_TEST_SUITE_P(Grounds, NsdElement, ::testing::Values("measured"),
                         GroundName);

}  // namespace
}  // namespace testing
}  // namespace pinode
