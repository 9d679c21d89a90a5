#include "pinode/report/console.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <sstream>
#include <vector>

#include "tests/support/report_testing.h"

namespace pinode {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(Console, ShowsParametersWithIntervalsAndNotes) {
  const auto example = testing::MakeReportExample();
  auto& parameters = example->summary.parameters;
  ASSERT_EQ(parameters[0].name, "k1");
  parameters[0].value = 0.1994;
  parameters[0].lower95 = 0.1974;
  parameters[0].upper95 = 0.2014;
  parameters[1].at_bound = true;
  parameters[2].sigma = std::numeric_limits<double>::infinity();
  parameters[2].lower95 = -parameters[2].sigma;
  parameters[2].upper95 = parameters[2].sigma;
  const std::string text = MakeParameterTable(example->input).ToText();
  EXPECT_THAT(text, ContainsRegex("k1 +0 +0\\.1994 +0\\.0020"));
  EXPECT_THAT(text, ContainsRegex("k2 .*at bound"));
  EXPECT_THAT(text, ContainsRegex("k3 .*no interval"));
  EXPECT_THAT(text, ContainsRegex("spring1\\.k3 .*N/m\u00b3"));
  EXPECT_THAT(text, ContainsRegex("slip2\\.b +400\\.00 +400\\.00 +1/m +fixed"));

  // Decimal points of one column stand in one place.
  const std::vector<std::string> lines = Lines(text);
  const size_t column = lines[2].find("0.1994") + 1;
  for (const size_t row : {2, 3, 5, 9}) EXPECT_EQ(lines[row][column], '.');
}

TEST(Console, ShowsHoldoutRecordsFirst) {
  const auto example = testing::MakeReportExample();
  example->summary.records[1].nrmse = 0.0218;
  example->summary.records[1].prior_nrmse = 1.69;
  example->summary.records[1].first_scored_sample = 150;
  example->summary.records[0].finite = false;
  const std::vector<std::string> lines =
      Lines(MakeRecordTable(example->input).ToText());
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_THAT(lines[2], ContainsRegex("south_quake +hold-out +2\\.18 +169 "
                                      "+0\\.0129 +scored from 1\\.50 s"));
  EXPECT_THAT(lines[3], ContainsRegex("north_quake +train .*not finite"));
}

TEST(Console, ShowsSensorsInTheirUnits) {
  const auto example = testing::MakeReportExample();
  example->problem.records[0].channels[2].fit = false;
  const std::string text = MakeSensorTable(example->input).ToText();
  EXPECT_THAT(text, ContainsRegex("south_quake +a1 +absolute acceleration +u1 "
                                  "+0\\.0[0-9]+ +m/s\u00b2"));
  EXPECT_THAT(text, ContainsRegex("north_quake +a3 .*not fitted"));
  // 2 % noise was given.
  EXPECT_THAT(text, ContainsRegex("north_quake +a1 .* 2\\.00"));
}

TEST(Console, LeavesOutWhatAFailureLacks) {
  const auto example = testing::MakeReportExample();
  example->summary = IdentificationSummary();
  example->input.prior.modes.clear();
  example->problem.description.remarks.clear();
  const std::string text = ConsoleReport(example->input);
  EXPECT_EQ(text, "Not usable: the identification has not been started.\n");
}

TEST(Console, HasAllTables) {
  const auto example = testing::MakeReportExample();
  example->summary.remarks = {
      "Sensor 'a3' is mounted upside down: gain = -0.98."};
  const std::string text = ConsoleReport(example->input);
  EXPECT_EQ(Lines(text)[1], example->summary.remarks[0]);
  // Remarks found in the data before the fit.
  ASSERT_FALSE(example->problem.description.remarks.empty());
  EXPECT_EQ(Lines(text)[2], example->problem.description.remarks[0]);
  for (const char* heading :
       {"Good.", "Error of the simulation", "Parameters", "Modes", "Sensors"}) {
    EXPECT_THAT(text, HasSubstr(heading));
  }
  for (const std::string& line : Lines(text)) {
    EXPECT_THAT(line, Not(ContainsRegex(" $")));
  }
}

TEST(Console, ShowsChangesThatTheDataShow) {
  DamageResult damage;
  damage.options.threshold = 0.05;
  const ChangeKind kind = ChangeKind::kStiffness;
  testing::AddChange("k1", kind, -0.10004, -0.1213, -0.08, 0.99987, true,
                     &damage);
  testing::AddChange("k2", kind, 3e6, -1e12, 1e12, 0.5, false, &damage);
  const std::string text = MakeChangeTable(damage).ToText();
  EXPECT_THAT(text, HasSubstr("P(loss > 5 %)"));
  EXPECT_THAT(text, HasSubstr("-12.13 to -8"));
  EXPECT_THAT(text, HasSubstr("changed"));
  EXPECT_THAT(text, HasSubstr("not seen"));
  EXPECT_THAT(text, Not(HasSubstr("e+")));
  damage.judgement.reasons = {Reason::kUnexplained, Reason::kNone};
  EXPECT_THAT(MakeChangeTable(damage).ToText(),
              HasSubstr("may be a side effect"));
}

}  // namespace
}  // namespace pinode
