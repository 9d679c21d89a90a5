#include "pinode/record/files/text_time.h"

#include <cstdio>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/strings.h"
#include "pinode/record/files/text_table.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

constexpr double kSampleStep = 0.01;

// A column `t` that begins at `first`, and another one.
std::string TextOf(const std::string& header, double first, double step) {
  std::string text = header;
  for (int i = 0; i < 300; ++i) {
    text += FormatNumber(first + i * step, 15) + ",0.5\n";
  }
  return text;
}

// Hours, minutes and seconds in one number, `first` seconds after midnight.
std::string PackedText(double first, int form) {
  std::string text = "t,a\n";
  for (int i = 0; i < 300; ++i) {
    const int ticks = static_cast<int>(100.0 * first) + i;
    char cell[64];
    std::snprintf(cell, sizeof(cell), "%s%d%02d%02d.%02d,0.5\n",
                  form == 2 ? "20240301" : "", ticks / 360000,
                  ticks / 6000 % 60, ticks / 100 % 60, ticks % 100);
    text += cell;
  }
  return text;
}

std::string Read(const std::string& text, TextFormat format, Table* table) {
  format.time_column = "t";
  std::string error;
  return ParseTextTable(text, "r.csv", {"t", "a"}, format, table, &error)
             ? ""
             : error;
}

TEST(TextTimeTest, PackedClocksAreNoSeconds) {
  Table table;
  // Over a minute, and over an hour.
  for (const double first : {45598.0, 46798.0}) {
    EXPECT_THAT(Read(PackedText(first, 1), {}, &table),
                HasSubstr("`time_format`, such as \"%H%M%S\""));
    EXPECT_THAT(Read(PackedText(first, 2), {}, &table),
                HasSubstr("such as \"%Y%m%d%H%M%S\""));
    TextFormat format;
    format.time_format = "%H%M%S";
    EXPECT_EQ(Read(PackedText(first, 1), format, &table), "");
    EXPECT_NEAR(table.values(299, 0), 299 * kSampleStep, 1e-6);
    format.time_format = "%Y%m%d%H%M%S";
    EXPECT_EQ(Read(PackedText(first, 2), format, &table), "");
    EXPECT_NEAR(table.values(299, 0), 299 * kSampleStep, 1e-6);
  }
  // Seconds stay seconds, with a gap of another length or past 60.
  EXPECT_EQ(Read(TextOf("t,a\n", 115958.0, kSampleStep), {}, &table), "");
  EXPECT_NEAR(table.values(299, 0) - table.values(0, 0), 299 * kSampleStep,
              1e-6);
  EXPECT_EQ(Read("t,a\n59.98,1\n59.99,2\n90,3\n90.01,4\n", {}, &table), "");
  TextFormat format;
  format.time_unit = "s";
  EXPECT_EQ(Read(PackedText(45598.0, 1), format, &table), "");
}

TEST(TextTimeTest, PartsOfADayAreNoSeconds) {
  const std::string text = TextOf("t,a\n", 0.5, kSampleStep / 86400.0);
  Table table;
  EXPECT_THAT(Read(text, {}, &table), HasSubstr("parts of a day"));
  TextFormat format;
  format.time_unit = "day";
  EXPECT_EQ(Read(text, format, &table), "");
  EXPECT_EQ(table.time_unit, "day");
  // Down to a step of 8 s, and with a last time that is missing.
  for (const double step : {0.5, 1.0, 8.0}) {
    EXPECT_THAT(Read(TextOf("t,a\n", 0.5, step / 86400.0), {}, &table),
                HasSubstr("parts of a day"))
        << step;
  }
  EXPECT_THAT(Read(text + ",0.5\n", {}, &table), HasSubstr("parts of a day"));
  // Shocks that begin some steps after 0, and slower rates.
  EXPECT_EQ(Read(TextOf("t,a\n", 1e-3, 2e-5), {}, &table), "");
  EXPECT_EQ(Read(TextOf("t,a\n", 0.5, 2e-4), {}, &table), "");
  EXPECT_EQ(Read(TextOf("t,a\n", 0.1, 1e-4), {}, &table), "");
  // Shocks at 100 kHz.
  EXPECT_EQ(Read(TextOf("t,a\n", 0.0, 1e-5), {}, &table), "");
}

TEST(TextTimeTest, UnitAboveTheNames) {
  Table table;
  for (const char* line :
       {"# time in ms", "Time unit: ms", "Zeit [\u00B5s]", "# Time (msec)",
        "X unit: none, time: ns", "# Time in ms, acceleration in g",
        "Time [ ms ]", "# time in ms and acceleration in g",
        "# Time in ms - acceleration in g", "# Time in ms\tacc in g"}) {
    const std::string error = Read(
        TextOf("# Rate: 100 Hz\n" + std::string(line) + "\nt,a\n", 0.0, 0.2),
        {}, &table);
    EXPECT_THAT(error, HasSubstr("r.csv:2: this line may state")) << line;
    EXPECT_THAT(error, HasSubstr("set `time_unit`"));
  }
  for (const char* line :
       {"# time in s", "# Sampling time: 10 ms", "# Sampling time [ms]: 10",
        "# Start time 12:00, range 5 mg", "# ms", "# timer; ms",
        "# Start time (ms resolution)", "# t: time, ms: strain",
        "# Zero time, us standard"}) {
    EXPECT_EQ(Read(TextOf(std::string(line) + "\nt,a\n", 0.0, 0.2), {}, &table),
              "")
        << line;
  }
  TextFormat format;
  format.time_unit = "s";
  EXPECT_EQ(Read(TextOf("# time in ms\nt,a\n", 0.0, 0.4), format, &table), "");
  // The column's own unit, and a column of that name.
  EXPECT_EQ(Read(TextOf("# time in ms\nt [s],a\n", 0.0, 0.4), {}, &table), "");
  EXPECT_EQ(Read("Time,ms,t,a\n0,1,0,1\n1,2,0.1,2\n2,3,0.2,1\n", {}, &table),
            "");
}

}  // namespace
}  // namespace pinode
