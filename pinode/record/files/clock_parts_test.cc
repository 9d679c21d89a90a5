#include "pinode/record/files/clock_parts.h"

#include <algorithm>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/record/files/text_table.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Reads a text by its own outline.
bool ReadByOutline(const std::string& text, Table* table, TextOutline* outline,
                   std::string* error) {
  TextFormat format;
  if (!ParseTextOutline(text, "r.csv", format, outline, error)) return false;
  EXPECT_GE(outline->time_column, 0);
  if (outline->time_column < 0) return false;
  format.time_column =
      outline->columns[static_cast<size_t>(outline->time_column)].name;
  return ParseTextTable(text, "r.csv", {format.time_column, "a"}, format, table,
                        error);
}

std::string Error(const std::string& text) {
  Table table;
  TextOutline outline;
  std::string error;
  EXPECT_FALSE(ReadByOutline(text, &table, &outline, &error)) << text;
  return error;
}

// Columns of a whole clock become seconds from the first row, with its date.
TEST(ClockPartsTest, WholeClocks) {
  struct Clock {
    const char* header;
    const char* first;
    const char* second;
    double seconds;
    double origin;  // since 1970
  };
  for (const Clock& clock :
       {// 2024-12-31 is day 366.
        Clock{"Year,DOY,Hour,Minute,Second", "2024,366,23,59,59.995",
              "2025,1,0,0,0", 0.005, 1735689599.995},
        {"Year,Month,Day,Hour,Minute,Second", "2024,2,28,23,59,59.5",
         "2024,2,29,0,0,0.0", 0.5, 1709164799.5},
        {"Jahr,Monat,Tag,Stunde,Minute,Sekunde", "23,3,1,0,0,1",
         "23,3,1,0,1,0.5", 59.5, 1677628801.0},
        {"YYYY,MM,DD,hh,mm,ss", "2024,3,1,12,0,0.25", "2024,3,1,12,0,0.5", 0.25,
         1709294400.25},
        {"Year,Month,Day,DOY,Hour,Minute,Second", "2023,3,1,60,0,0,0.5",
         "2023,3,1,60,0,0,1.25", 0.75, 1677628800.5},
        {"Date,Hour,Minute,Second", "2024-03-01,12,0,0.25",
         "2024-03-01,12,0,0.5", 0.25, 1709294400.25},
        {"Year,DOY,Hour,Minute,Second,ms", "2024,61,12,0,0,995",
         "2024,61,12,0,1,0", 0.005, 1709294400.995}}) {
    Table table;
    TextOutline outline;
    std::string error;
    ASSERT_TRUE(ReadByOutline(std::string(clock.header) + ",a\n" + clock.first +
                                  ",3\n" + clock.second + ",1\n",
                              &table, &outline, &error))
        << clock.header << ": " << error;
    EXPECT_NEAR(table.values(1, 0), clock.seconds, 1e-6) << clock.header;
    EXPECT_EQ(table.time_unit, "s");
    EXPECT_EQ(table.time_origin.kind, TimeOrigin::Kind::kDate);
    EXPECT_NEAR(table.time_origin.seconds, clock.origin, 1e-6) << clock.header;
    EXPECT_THAT(table.reading, HasSubstr("parts of a clock"));
    for (size_t i = 0; i + 1 < outline.columns.size(); ++i) {
      EXPECT_FALSE(outline.is_channel[i]) << outline.columns[i].name;
    }
    EXPECT_TRUE(outline.is_channel.back());
  }
}

TEST(ClockPartsTest, TimesOfDayPassMidnight) {
  Table table;
  TextOutline outline;
  std::string error;
  ASSERT_TRUE(
      ReadByOutline("Hour;Minute;Second;a\n23;59;59,9;3\n23;59;59,95;3\n"
                    "0;0;0,0;1\n0;0;0,05;2\n",
                    &table, &outline, &error))
      << error;
  EXPECT_NEAR(table.values(3, 0), 0.15, 1e-9);
  EXPECT_EQ(table.time_origin.kind, TimeOrigin::Kind::kTimeOfDay);
  EXPECT_THAT(outline.time_parts, ElementsAre(0, 1, 2));
}

// Short names are those of channels if another column is the time.
TEST(ClockPartsTest, ShortNamesBesideAnotherTime) {
  struct Names {
    const char* header;
    const char* row;
    std::vector<bool> is_channel;
    std::vector<std::string> unused;
  };
  for (const Names& names :
       {Names{"Time,hh,mm,ss,a", "12:00:0%,1,2,3,4", {0, 1, 1, 1, 1}, {}},
        {"Time [s],min,hour,sec,a",
         "0.%,1,2,3,4",
         {0, 1, 0, 0, 1},
         {"hour", "sec"}},
        {"hh,mm,ss,a", "12,0,0.%,4", {0, 0, 0, 1}, {}},
        {"hh,mm,ss,ms,a", "12,0,%,5,4", {0, 0, 0, 0, 1}, {}},
        {"Date,Time,a", "2024-03-01,12:00:0%,4", {0, 0, 1}, {}}}) {
    std::string text = std::string(names.header) + "\n";
    for (int i = 0; i < 4; ++i) {
      std::string row = names.row;
      row.replace(row.find('%'), 1, std::to_string(i));
      text += row + "\n";
    }
    TextOutline outline;
    std::string error;
    ASSERT_TRUE(ParseTextOutline(text, "r.csv", {}, &outline, &error)) << error;
    EXPECT_EQ(outline.is_channel, names.is_channel) << names.header;
    ASSERT_GE(outline.time_column, 0);
    const auto place = static_cast<size_t>(outline.time_column);
    EXPECT_EQ(outline.UnusedTimes(outline.columns[place].name), names.unused)
        << names.header;
  }
  // A clock whose parts are left out is named.
  TextOutline outline;
  std::string error;
  ASSERT_TRUE(ParseTextOutline("hh,mm,ss,a\n12,0,0.0,4\n12,0,0.5,4\n", "r.csv",
                               {}, &outline, &error));
  EXPECT_THAT(outline.UnusedTimes("a"), ElementsAre("hh", "mm", "ss"));
}

// Hours without a date may have elapsed since the start.
TEST(ClockPartsTest, ElapsedHours) {
  Table table;
  TextOutline outline;
  std::string error;
  ASSERT_TRUE(
      ReadByOutline("Hour;Minute;Second;a\n23;59;59.9;3\n23;59;59.95;3"
                    "\n24;0;0.0;1\n24;0;0.05;2\n",
                    &table, &outline, &error))
      << error;
  EXPECT_NEAR(table.values(3, 0), 0.15, 1e-9);
  ASSERT_TRUE(ReadByOutline("Hour;Minute;Second;a\n120;0;0;3\n120;0;0.5;3\n",
                            &table, &outline, &error))
      << error;
  EXPECT_NEAR(table.values(1, 0), 0.5, 1e-9);
  // Hours that have passed a day do not start anew at midnight.
  ASSERT_TRUE(
      ReadByOutline("Hour;Minute;Second;a\n47;59;59;3\n47;59;59.5;3\n"
                    "24;0;0;1\n24;0;0.5;2\n",
                    &table, &outline, &error))
      << error;
  EXPECT_LT(table.values(2, 0), 0.0);
}

// A part that counts on is the whole time by two keys, which are named.
TEST(ClockPartsTest, PartsThatCountOn) {
  struct Counter {
    std::string header;
    std::string rows;
    const char* name;
    const char* unit;
  };
  for (const Counter& counter :
       {Counter{"Hour,Minute,Second,a",
                "0,0,59.98,1\n0,1,60.00,2\n0,1,60.02,3\n0,1,60.04,1\n",
                "Second", "s"},
        {"Hour,Minute,Second,ms,a",
         "0,0,0,980,1\n0,0,1,1000,2\n0,0,1,1020,3\n0,0,1,1040,1\n", "ms",
         "ms"}}) {
    const std::string text = counter.header + "\n" + counter.rows;
    EXPECT_THAT(Error(text),
                HasSubstr("set `time = \"" + std::string(counter.name) +
                          "\"` and `time_unit = \"" + counter.unit + "\"`"));
    TextFormat format;
    format.time_column = counter.name;
    format.time_unit = counter.unit;
    Table table;
    std::string error;
    ASSERT_TRUE(ParseTextTable(text, "r.csv", {counter.name, "a"}, format,
                               &table, &error))
        << error;
    EXPECT_EQ(table.time_unit, counter.unit);
  }
}

// Any part names the clock.
TEST(ClockPartsTest, AnyPartIsTheTime) {
  const std::string text =
      "Year,DOY,Hour,Minute,Second,a\n2024,61,12,59,59.5,3\n"
      "2024,61,13,0,0.0,1\n2024,61,13,0,0.5,1\n";
  for (const char* name : {"Year", "DOY", "Hour", "Minute", "Second"}) {
    TextFormat format;
    format.time_column = name;
    Table table;
    std::string error;
    ASSERT_TRUE(
        ParseTextTable(text, "r.csv", {name, "a"}, format, &table, &error))
        << error;
    EXPECT_NEAR(table.values(2, 0), 1.0, 1e-9) << name;
  }
}

// A unit of the time says that the column is the whole of it.
TEST(ClockPartsTest, UnitOfTheTime) {
  TextFormat format;
  format.time_column = "Hour";
  format.time_unit = "h";
  Table table;
  std::string error;
  ASSERT_TRUE(ParseTextTable(
      "Hour,Minute,Second,a\n0.5,30,1800,3\n0.75,45,2700,1\n1,60,3600,1\n",
      "r.csv", {"Hour", "a"}, format, &table, &error))
      << error;
  EXPECT_EQ(table.time_unit, "h");
  EXPECT_NEAR(table.values(2, 0), 1.0, 1e-12);
}

// Parts that are not whole or not certain are no clock.
TEST(ClockPartsTest, IncompleteClocks) {
  for (const char* header :
       {"Year,DOY,Second,a", "DOY,Hour,Minute,Second,a",
        "Year,Day,Hour,Minute,Second,a", "Year,Month,Hour,Minute,Second,a",
        "Hour,Minute,Second,Second,a", "Hour,Minute,Second [ms],a",
        "Hour,Minute,a", "h,min,a", "h,min,s,a", "h,m,s,a", "std,min,sec,a",
        "Date,Hour,Minute,Second,a", "first,second,a"}) {
    std::string text = std::string(header) + "\n";
    const auto cells = std::count(text.begin(), text.end(), ',');
    for (int i = 0; i < 4; ++i) {
      for (auto j = 0; j < cells; ++j) text += "1,";
      text += "0." + std::to_string(i) + "\n";
    }
    TextOutline outline;
    std::string error;
    ASSERT_TRUE(ParseTextOutline(text, "r.csv", {}, &outline, &error)) << error;
    EXPECT_FALSE(FindClockParts(outline.columns).IsComplete()) << header;
    EXPECT_THAT(outline.time_parts, IsEmpty()) << header;
  }
}

TEST(ClockPartsTest, RefusesPartsThatCannotBe) {
  struct BadPart {
    const char* row;
    const char* message;
  };
  for (const BadPart& bad :
       {BadPart{"2023,366,12,0,0,3", "'366', expected a day of the year 2023"},
        {"2024,0,12,0,0,3", "column 'DOY': '0', expected a whole number"},
        {"2024,61.5,12,0,0,3", "'61.5', expected a whole number"},
        {"202,61,12,0,0,3", "'202', expected a year"},
        {"2024,61,24,0,0,3", "'24', expected a whole number from 0 to 23"},
        {"2024,61,12,60,0,3", "'60', expected a whole number from 0 to 59"},
        {"2024,61,12,0,60,3", "'60', expected a number from 0 to less than 60"},
        {"2024,61,12,0,-1,3", "'-1', expected"},
        {"2024,61,12,,0,3", "'', expected"}}) {
    const std::string error =
        Error("Year,DOY,Hour,Minute,Second,a\n2024,61,11,59,59.5,1\n" +
              std::string(bad.row) + "\n2024,61,12,0,0.5,2\n");
    EXPECT_THAT(error, HasSubstr("r.csv:3: "));
    EXPECT_THAT(error, HasSubstr(bad.message));
    EXPECT_THAT(error, HasSubstr("`time_unit"));
  }
  EXPECT_THAT(
      Error("Year,Month,Day,DOY,Hour,Minute,Second,a\n"
            "2024,3,1,60,12,0,0,1\n2024,3,1,60,12,0,1,1\n"),
      HasSubstr("column 'DOY': '60', expected the day of the date beside it"));
  EXPECT_THAT(Error("Year,Month,Day,Hour,Minute,Second,a\n"
                    "2023,2,29,12,0,0,1\n2023,2,29,12,0,1,1\n"),
              HasSubstr("is not a date"));
  // Counts of milliseconds are no fractions.
  EXPECT_THAT(Error("Hour,Minute,Second,ms,a\n12,0,0,995,1\n12,0,1,1000,2\n"),
              HasSubstr("column 'ms': '1000', expected a number from 0 to "
                        "less than 1000"));
  EXPECT_THAT(Error("Hour,Minute,Second,ms,a\n12,0,0.5,500,1\n12,0,0.6,600,2"
                    "\n"),
              HasSubstr("whole seconds"));
  EXPECT_THAT(Error("Hour,Minute,Second,a\n12,0,0,1\n12,0,0,2\n12,0,0,3\n"),
              HasSubstr("the clock is coarser than the rows"));
}

// Hours that count to 12 are no hours of the day.
TEST(ClockPartsTest, HalvesOfTheDay) {
  EXPECT_THAT(Error("Hour,Minute,Second,Half,a\n12,59,59.5,PM,1\n"
                    "1,0,0.0,PM,2\n1,0,0.5,PM,3\n"),
              HasSubstr("AM or PM stands in a column of its own"));
  EXPECT_THAT(Error("Time,Half,a\n10:59:59.0,p.m.,1\n10:59:59.5,p.m.,2\n"
                    "11:00:00.0,p.m.,3\n"),
              HasSubstr("`sampling_rate_hz`"));
  EXPECT_THAT(Error("Date,Time,a,AM/PM\n2024-03-01,01:30:00.0,1,PM\n"
                    "2024-03-01,01:30:00.5,2,PM\n2024-03-01,01:30:01.0,1,PM\n"),
              HasSubstr("AM or PM stands in a column of its own"));
  // A state of another kind: beside an hour above 12, or away from the time.
  for (const char* text :
       {"Time,state,a\n14:30:00.0,PM,1\n14:30:00.5,PM,2\n14:30:01.0,AM,3\n",
        "Time,a,state\n10:30:00.0,1,PM\n10:30:00.5,2,PM\n10:30:01.0,3,AM\n",
        "Hour,Minute,Second,a,state\n10,3,0,1,PM\n10,3,1,2,PM\n10,3,2,3,AM"
        "\n"}) {
    Table table;
    TextOutline outline;
    std::string error;
    ASSERT_TRUE(ReadByOutline(text, &table, &outline, &error)) << error;
    EXPECT_GT(table.values(1, 0), 0.4);
  }
}

// A fraction in two columns would count twice.
TEST(ClockPartsTest, FractionsStandInOneColumn) {
  EXPECT_THAT(Error("Time,ms,a\n12:00:00.00,0,1\n12:00:00.01,10,2\n"
                    "12:00:00.02,20,3\n"),
              HasSubstr("r.csv:3: column 'Time': '12:00:00.01' has a fraction "
                        "and so has 'ms' beside it"));
  EXPECT_THAT(Error("Time,ms,a\n12:00:00,990,1\n12:00:01,1000,2\n"
                    "12:00:02,1010,3\n"),
              HasSubstr("'1000' of 'ms' beside it is no fraction"));
  // With %f the time is read alone.
  TextFormat format;
  format.time_column = "Time";
  format.time_format = "%H:%M:%S.%f";
  Table table;
  std::string error;
  ASSERT_TRUE(
      ParseTextTable("Time,ms,a\n12:00:00.00,0,1\n12:00:00.01,10,2\n"
                     "12:00:00.02,20,3\n",
                     "r.csv", {"Time", "ms"}, format, &table, &error))
      << error;
  EXPECT_NEAR(table.values(2, 0), 0.02, 1e-9);
  EXPECT_EQ(table.values(2, 1), 20.0);
}

// A column in milliseconds is a fraction only by its name.
TEST(ClockPartsTest, DurationsAreNoFractions) {
  for (const char* name : {"dt [ms]", "Exposure [ms]", "t_ms"}) {
    Table table;
    TextOutline outline;
    std::string error;
    ASSERT_TRUE(ReadByOutline("Time;" + std::string(name) +
                                  ";a\n12:30:00.00;20;1\n12:30:00.02;20;2\n"
                                  "12:30:00.04;20;3\n",
                              &table, &outline, &error))
        << error;
    EXPECT_NEAR(table.values(2, 0), 0.04, 1e-9);
  }
  // North-south is a direction.
  {
    Table table;
    TextOutline outline;
    std::string error;
    ASSERT_TRUE(ReadByOutline(
        "Time,NS,a\n12:30:00,9.81,1\n12:30:01,9.82,2\n12:30:02,9.80,1\n",
        &table, &outline, &error))
        << error;
    EXPECT_NEAR(table.values(2, 0), 2.0, 1e-12);
    EXPECT_TRUE(outline.is_channel[1]);
  }
  for (const char* name :
       {"ms", "Milliseconds", "msec [ms]", "MS", "Fraction [ms]"}) {
    Table table;
    TextOutline outline;
    std::string error;
    ASSERT_TRUE(ReadByOutline("Time;" + std::string(name) +
                                  ";a\n12:30:00;980;1\n12:30:01;0;2\n"
                                  "12:30:01;20;3\n",
                              &table, &outline, &error))
        << error;
    EXPECT_NEAR(table.values(2, 0), 0.04, 1e-9);
  }
}

// A date and a time of day need not stand side by side.
TEST(ClockPartsTest, DateAwayFromTheTime) {
  Table table;
  TextOutline outline;
  std::string error;
  ASSERT_TRUE(
      ReadByOutline("Date,a,Time\n2024-02-29,1,23:59:59.5\n"
                    "2024-03-01,2,00:00:00.0\n2024-03-01,2,00:00:00.5\n",
                    &table, &outline, &error))
      << error;
  EXPECT_NEAR(table.values(2, 0), 1.0, 1e-9);
  EXPECT_EQ(table.time_origin.kind, TimeOrigin::Kind::kDate);
  // The date of a calibration is none of the time.
  ASSERT_TRUE(
      ReadByOutline("Calibrated,a,Time\n2024-02-29,1,23:59:59.5\n"
                    "2024-02-29,2,00:00:00.0\n2024-02-29,2,00:00:00.5\n",
                    &table, &outline, &error))
      << error;
  EXPECT_NEAR(table.values(2, 0), 1.0, 1e-9);
  EXPECT_EQ(table.time_origin.kind, TimeOrigin::Kind::kTimeOfDay);
}

}  // namespace
}  // namespace pinode
