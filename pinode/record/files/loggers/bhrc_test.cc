#include "pinode/record/files/loggers/bhrc.h"

#include <cmath>
#include <cstdio>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/strings.h"
#include "pinode/record/files/loggers/logger_table.h"
#include "pinode/record/table.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int kPoints = 23;

double Sample(int component, int i) {
  return 0.01 * std::sin(0.3 * i + component) * (component + 1);
}

// Returns one component as the centre writes it: 200 Hz, in tenths of g.
std::string Component(int component, const std::string& title = "VOL1DS") {
  const std::string letter(1, "LVT"[component]);
  std::string text = "* " + title + " FILE:  5523/01\nInst Type = SSA-2\n" +
                     "Origin Time : 2012/08/11   12:23:16\n\n" + letter +
                     "\n   \nCOMP " + letter + std::to_string(component + 1) +
                     "     \nAmand     Station   38.231 N 46.156 E\n"
                     "Epicenter 38.520 N 46.860 E   FD 12 Km\n"
                     "INSTR PERIOD =  .020 SEC   DAMPING =  .640\n"
                     "NO. OF POINTS =     23      DURATION =    .115\n"
                     "UNITS ARE SECONDS AND G/10\n     \n";
  for (int i = 0; i < 7; ++i) text += "    0    0    0    0    023    0\n";
  for (int i = 0; i < 7; ++i) {
    text += i == 1 ? "  .200000E+03  .000000E+00  .00\n"
                   : "  .199601E-01  .640000E+00  .00\n";
  }
  for (int i = 0; i < kPoints; ++i) {
    char number[32];
    std::snprintf(number, sizeof(number), "%13.5E",
                  10.0 * Sample(component, i));
    text += number;
    if (i % 10 == 9) text += "\n";
  }
  return text + "\n/&\n";
}

LoggedFile ReadOrFail(const std::string& text) {
  LoggedFile file;
  std::string error;
  EXPECT_TRUE(ParseBhrc(
      text, "5523-1.V1", [](const LoggerChannel&) { return true; }, &file,
      &error))
      << error;
  return file;
}

std::string Refusal(const std::string& text) {
  LoggedFile file;
  std::string error;
  EXPECT_FALSE(ParseBhrc(
      text, "x.V1", [](const LoggerChannel&) { return true; }, &file, &error));
  EXPECT_TRUE(file.channels.empty());
  return error;
}

std::string With(std::string text, const std::string& from,
                 const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

TEST(BhrcTest, ThreeComponentsInG) {
  const LoggedFile file =
      ReadOrFail(Component(0) + Component(1) + Component(2));
  ASSERT_EQ(file.channels.size(), 3u);
  const char* const names[] = {"L1", "V2", "T3"};
  for (int c = 0; c < 3; ++c) {
    const LoggerChannel& channel = file.channels[static_cast<size_t>(c)];
    EXPECT_EQ(channel.name, names[c]);
    EXPECT_EQ(channel.unit, "g");
    EXPECT_DOUBLE_EQ(channel.step, 0.005);
    EXPECT_FALSE(channel.is_dated);
    ASSERT_EQ(channel.values.size(), kPoints);
    for (int i = 0; i < kPoints; ++i) {
      EXPECT_NEAR(channel.values[i], Sample(c, i), 1e-7) << c << " " << i;
    }
  }
}

TEST(BhrcTest, ATableByItsBeginning) {
  TemporaryFolder folder;
  const std::string path =
      folder.Write("amand.txt", Component(0) + Component(2));
  EXPECT_EQ(FindLoggerFormat(path), LoggerFormat::kStrongMotion);
  Table table;
  std::string error;
  LoggedFile file;
  ASSERT_TRUE(ReadLoggedFile(
      path, LoggerFormat::kStrongMotion, "",
      [](const LoggerChannel&) { return true; }, &file, &error))
      << error;
  ASSERT_TRUE(MakeLoggerTable(file, path, {"t", "T3"}, &table, &error))
      << error;
  EXPECT_THAT(table.columns, ElementsAre("t", "T3"));
  EXPECT_NEAR(table.values(2, 0), 0.01, 1e-12);
  EXPECT_NEAR(table.values(2, 1), Sample(2, 2), 1e-7);
}

TEST(BhrcTest, RefusesWhatItCannotRead) {
  const std::string good = Component(0) + Component(1);
  EXPECT_THAT(Refusal(Component(0, "VOL2DS")),
              HasSubstr("Use the file of Volume 1"));
  EXPECT_THAT(Refusal(With(good, ".200000E+03", ".100000E+03")),
              HasSubstr("100 Hz in the header and 23 points in 0.115 s"));
  EXPECT_THAT(Refusal(With(good, ".200000E+03", ".000000E+00")),
              HasSubstr("contradict"));
  EXPECT_THAT(Refusal(With(good, "    23 ", "  2300 ")),
              HasSubstr("as many as the file holds"));
  EXPECT_THAT(Refusal(With(good, "COMP L1", "")), HasSubstr("'COMP L1'"));
  EXPECT_THAT(Refusal(With(good, "UNITS ARE", "")), HasSubstr("UNITS ARE"));
  for (size_t length :
       {good.size() / 4, good.size() / 2 + 100, good.size() - 40}) {
    EXPECT_THAT(Refusal(good.substr(0, length)), HasSubstr("x.V1:"));
  }
}

}  // namespace
}  // namespace pinode
