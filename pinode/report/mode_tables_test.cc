#include "pinode/report/mode_tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "pinode/base/types.h"
#include "tests/support/report_testing.h"

namespace pinode {
namespace {

using ::testing::ContainsRegex;

std::vector<std::string> RowsOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(ModeTables, ModesAndMissingOnes) {
  const auto example = testing::MakeReportExample();
  example->input.prior.modes.resize(2);
  example->input.prior.modes[0].initial_frequency = 2.0;
  example->input.prior.modes[0].updated_frequency = 2.1;
  example->input.prior.modes[0].initial_damping = 0.02;
  example->input.prior.modes[0].updated_damping = 0.035;
  example->input.prior.modes[0].mac = 0.9987;
  example->input.prior.modes[1] = ModePair();
  const std::vector<std::string> lines =
      RowsOf(MakeModeTable(example->input).ToText());
  EXPECT_THAT(lines[2], ContainsRegex("1 +2\\.0000 +2\\.1000 +\\+5\\.00 "
                                      "+2\\.00 +3\\.50 +0\\.9987"));
  EXPECT_THAT(lines[3], ContainsRegex("2 +- +- +- +- +- +-"));
}

TEST(ModeTables, MeasuredModesBesideTheModels) {
  const auto example = testing::MakeReportExample();
  // In a model whose time is in milliseconds.
  example->problem.description.units.time = "ms";
  ModeScore mode;
  mode.name = "bending";
  mode.frequency = 2e-3;
  mode.initial = {0, 2.2e-3, 0.91};
  mode.updated = {0, 1.99e-3, 0.9987};
  example->summary.modes.push_back(mode);
  mode.name = "sway";
  mode.updated.mac = std::numeric_limits<double>::quiet_NaN();
  example->summary.modes.push_back(mode);
  const std::vector<std::string> lines =
      RowsOf(MakeMeasuredModeTable(example->input).ToText());
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_THAT(lines[2],
              ContainsRegex("bending +2\\.0000 +2\\.2000 +10\\.0+ +1\\.9900 "
                            "+-0\\.50+ +0\\.9100+ +0\\.9987"));
  EXPECT_THAT(lines[3], ContainsRegex("sway .* -$"));
}

// The sum goes on over modes, and the table ends when the mass is complete.
TEST(ModeTables, ModalMassesAndTheirSums) {
  const auto example = testing::MakeReportExample();
  ASSERT_EQ(example->problem.dynamics->model().num_directions(), 1);
  example->input.prior.modes.assign(4, ModePair());
  const std::vector<double> shares = {0.85, 0.12, 0.03, 0.0};
  // The first two have changed places.
  const std::vector<size_t> places = {1, 0, 2, 3};
  for (size_t i = 0; i < shares.size(); ++i) {
    ModePair& mode = example->input.prior.modes[places[i]];
    mode.updated_mode = static_cast<int>(i);
    mode.updated_frequency = 2.0 + static_cast<double>(i);
    mode.updated_mass_shares = Vector::Constant(1, shares[i]);
  }
  const std::vector<std::string> lines =
      RowsOf(MakeModalMassTable(example->input).ToText());
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_THAT(lines[2], ContainsRegex("1 +2\\.0000 +85\\.0 +85\\.0"));
  EXPECT_THAT(lines[4], ContainsRegex("3 +4\\.0000 +3\\.0+ +100"));
}

TEST(ModeTables, ModesWithoutPartnersHaveNoMass) {
  const auto example = testing::MakeReportExample();
  example->input.prior.modes.assign(2, ModePair());
  EXPECT_TRUE(MakeModalMassTable(example->input).empty());
}

}  // namespace
}  // namespace pinode
