// The laboratory frame of three set-ups, held against what others published of
// it.

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/modal/merge_setups.h"
#include "pinode/record/table.h"

namespace pinode {
namespace {

// Merged over 15 set-ups: Hz, and the standard deviation between these
// (pyOMA-dev/pyOMA, merged_setups.npz).
struct Published {
  double frequency_hz;
  double between;
};
constexpr std::array<Published, 10> kPublished = {{{1.2283, 0.0012},
                                                   {1.4358, 0.0015},
                                                   {2.1000, 0.0003},
                                                   {4.0175, 0.0020},
                                                   {4.7704, 0.0018},
                                                   {6.6824, 0.0022},
                                                   {7.6157, 0.0024},
                                                   {9.6653, 0.0017},
                                                   {12.1663, 0.0027},
                                                   {12.5979, 0.0004}}};

class LaboratoryFrameTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("PINODE_MEASURED_DATA");
    folder_ = (folder != nullptr
                   ? std::string(folder)
                   : std::string(PINODE_SOURCE_DIR) + "/../shared/data") +
              "/ambient";
    if (!std::filesystem::exists(folder_)) {
      GTEST_SKIP() << "no measured data; set PINODE_MEASURED_DATA to the "
                      "folder that holds ambient/";
    }
  }

  // Two accelerometers at node 24 are in all set-ups; a laser vibrometer looks
  // at one node along three oblique beams.
  SetupModes FindSetup(const std::string& number) {
    Table table;
    std::string error;
    EXPECT_TRUE(
        ReadCsvTable(folder_ + "/steel_frame_setup" + number + ".csv.gz",
                     {"vib_l_mps", "vib_r_mps", "vib_t_mps", "ref_x", "ref_y"},
                     &table, &error))
        << error;
    ResponseRecord record;
    record.name = number;
    record.sampling_step = 1.0 / 256.0;
    record.samples = table.values.transpose();
    record.channels = {{number + ".l", 1},
                       {number + ".r", 1},
                       {number + ".t", 1},
                       {"24.x", 2},
                       {"24.y", 2}};
    ModeIdentificationOptions options;
    options.num_threads = 2;
    ModesOfRecord modes;
    EXPECT_TRUE(IdentifyModes(record, options, &modes, &error)) << error;
    SetupModes setup;
    setup.name = number;
    for (const ResponseChannel& channel : record.channels) {
      setup.places.push_back(channel.name);
    }
    setup.modes = modes.modes;
    return setup;
  }

  std::string folder_;
};

TEST_F(LaboratoryFrameTest, TenPublishedModesByDefault) {
  std::vector<SetupModes> setups;
  for (const char* number : {"01", "02", "04"}) {
    setups.push_back(FindSetup(number));
    const std::vector<IdentifiedMode>& modes = setups.back().modes;
    ASSERT_GE(modes.size(), kPublished.size());
    for (size_t m = 0; m < kPublished.size(); ++m) {
      EXPECT_NEAR(modes[m].frequency_hz, kPublished[m].frequency_hz,
                  0.003 * kPublished[m].frequency_hz)
          << "set-up " << number;
    }
  }
  MergedModes merged;
  std::string error;
  ASSERT_TRUE(MergeSetups(setups, {}, &merged, &error)) << error;
  ASSERT_GE(merged.modes.size(), kPublished.size());
  for (size_t m = 0; m < kPublished.size(); ++m) {
    const IdentifiedMode& mode = merged.modes[m].mode;
    EXPECT_NEAR(mode.frequency_hz, kPublished[m].frequency_hz,
                std::max(2.0 * kPublished[m].between,
                         0.001 * kPublished[m].frequency_hz));
    // The lasers' velocities are displacements times i omega: turned back, all
    // places move in phase.
    EXPECT_GT(mode.phase_collinearity, 0.98);
    EXPECT_EQ(mode.shape.size(), 11);
    EXPECT_TRUE(mode.shape.allFinite());
  }
}

}  // namespace
}  // namespace pinode
