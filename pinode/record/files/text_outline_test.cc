// Outlines: which column of a text file is the time, and which are channels.

#include <algorithm>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/record/files/text_table.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TextOutline OutlineOf(const std::string& text) {
  const TemporaryFolder folder;
  const std::string path = folder.Write("outline.csv", text);
  TextOutline outline;
  std::string error;
  EXPECT_TRUE(ReadTextOutline(path, {}, &outline, &error)) << error;
  return outline;
}

// Two loggers side by side: which channel is whose, the file does not say.
TEST(TextOutlineTest, SecondClock) {
  const std::string rows = "0;1;5.1;3\n0.1;2;5.2;1\n0.2;0;5.3;2\n0.3;4;5.4;9\n";
  for (const char* names :
       {"t1;a;t2;b\n", "Time [s];a;Time [s];b\n", "Zeit 1;a;Zeit 2;b\n"}) {
    const TextOutline outline = OutlineOf(names + rows);
    EXPECT_EQ(outline.time_column, 0) << names;
    EXPECT_THAT(outline.other_clocks, ElementsAre(2)) << names;
    EXPECT_THAT(outline.is_channel, ElementsAre(false, true, false, true));
  }
  // The same times twice are one clock, and temperatures are none.
  const TextOutline same =
      OutlineOf("t1;a;t2;b\n0;1;0;3\n0.1;2;0.1;1\n0.2;0;0.2;2\n");
  EXPECT_THAT(same.other_clocks, IsEmpty());
  EXPECT_THAT(same.is_channel, ElementsAre(false, true, false, true));
  const TextOutline warm =
      OutlineOf("t;a;T1;T2\n0;1;20.1;19\n0.1;2;20.1;18\n0.2;0;20.3;18\n");
  EXPECT_THAT(warm.other_clocks, IsEmpty());
  EXPECT_THAT(warm.is_channel, ElementsAre(false, true, true, true));
}

// A slower clock ends before the other one, within the rows that are looked at.
TEST(TextOutlineTest, SecondClockEndsEarlier) {
  std::string two = "Time 1;a;Time 2;b\n";
  std::string one = "Time 1;a;Time 2;b\n";
  for (int i = 0; i < 8; ++i) {
    const std::string begin =
        "0." + std::to_string(i) + ";" + std::to_string(i * i % 5) + ";";
    const std::string value = ";" + std::to_string(i * i % 3);
    two += begin + (i < 4 ? "0." + std::to_string(2 * i) + value : ";") + "\n";
    one += begin + (i < 4 ? "0." + std::to_string(i) + value : ";") + "\n";
  }
  EXPECT_THAT(OutlineOf(two).other_clocks, ElementsAre(2));
  EXPECT_THAT(OutlineOf(two).is_channel, ElementsAre(false, true, false, true));
  EXPECT_THAT(OutlineOf(one).other_clocks, IsEmpty());
  EXPECT_THAT(OutlineOf(one).is_channel, ElementsAre(false, true, false, true));
}

// One clock in two units, roundings or forms is one clock.
TEST(TextOutlineTest, OneClockTwice) {
  for (const char* text :
       {"Time;Time [s];a\n12:00:00;0;3\n12:00:01;1;1\n12:00:02;2;2\n",
        "Time [s];Time [ms];a\n0.1;100;3\n0.2;200;1\n0.3;300;2\n",
        "Time;Time [ms];a\n0.1;100;3\n0.2;200;1\n0.3;300;2\n",
        "t1;t2;a\n0.1;0.10;3\n0.2;0.20;1\n0.3;0.30;2\n"}) {
    const TextOutline outline = OutlineOf(text);
    EXPECT_THAT(outline.other_clocks, IsEmpty()) << text;
    EXPECT_THAT(outline.is_channel, ElementsAre(false, false, true)) << text;
  }
  const TextOutline other =
      OutlineOf("Time [s];Time [ms];a\n0.1;150;3\n0.2;250;1\n0.3;350;2\n");
  EXPECT_THAT(other.other_clocks, ElementsAre(1));
}

// Names that microcontrollers give to their counters.
TEST(TextOutlineTest, NamesOfCounters) {
  struct Counter {
    const char* name;
    const char* step;
    const char* unit;
  };
  for (const Counter& counter :
       {Counter{"millis", "10", "ms"}, Counter{"micros", "10000", "us"},
        Counter{"timestamp_ns", "10000000", "ns"}}) {
    std::string text = std::string(counter.name) + ",a\n";
    for (int i = 1; i < 7; ++i) {
      text += std::to_string(i) + (counter.step + 1) + "," +
              std::to_string(i * i % 5) + "\n";
    }
    const TextOutline outline = OutlineOf(text);
    EXPECT_EQ(outline.time_column, 0) << counter.name;
    TextFormat format;
    format.time_column = counter.name;
    Table table;
    std::string error;
    ASSERT_TRUE(ParseTextTable(text, "r.csv", {}, format, &table, &error))
        << error;
    EXPECT_EQ(table.time_unit, counter.unit);
  }
}

TEST(TextOutlineTest, BracketThatDoesNotBegin) {
  const TextOutline outline = OutlineOf("s];a\n0;1\n0.1;2\n0.2;4\n");
  EXPECT_EQ(outline.time_column, 0);
  EXPECT_THAT(outline.is_channel, ElementsAre(false, true));
}

// A channel that rises evenly beside the time is a channel.
TEST(TextOutlineTest, RisingChannelBesideTime) {
  const TextOutline ticks = OutlineOf(
      "Time;a;b\n1709294400000;0.5;3\n1709294400001;1;1\n1709294400002;1.5;"
      "2\n");
  EXPECT_THAT(ticks.is_channel, ElementsAre(false, true, true));
  const TextOutline ms = OutlineOf("Time [ms];a\n0;0.5\n1;1\n2;1.5\n");
  EXPECT_EQ(ms.time_column, 0);
  EXPECT_THAT(ms.is_channel, ElementsAre(false, true));
}

// A word of the time in the name of numbers that rise evenly.
TEST(TextOutlineTest, SecondFormOfTheTime) {
  std::string ticks = "time,seconds_elapsed,z\n";
  std::string travel = "t,Travel time,z\n";
  std::string late = "a,Sample time,z\n";
  for (int i = 0; i < 6; ++i) {
    const std::string digit = std::to_string(i);
    const std::string value = "," + std::to_string(i * i % 5) + "\n";
    ticks += "17147313001" + digit + "0000000,0.12" + digit + value;
    travel += "0.0" + digit + ",0.12" + std::to_string(i * i % 7) + value;
    late += std::to_string(i * i % 7) + ",0." + digit + value;
  }
  const TextOutline outline = OutlineOf(ticks);
  EXPECT_EQ(outline.time_column, 0);
  EXPECT_THAT(outline.is_channel, ElementsAre(false, false, true));
  EXPECT_THAT(outline.UnusedTimes("time"), ElementsAre("seconds_elapsed"));
  EXPECT_THAT(OutlineOf(travel).is_channel, ElementsAre(false, true, true));
  EXPECT_EQ(OutlineOf(late).time_column, 1);
  EXPECT_THAT(OutlineOf(late).is_channel, ElementsAre(true, false, true));
}

// A displacement in real time is none, though it rises in the first rows.
TEST(TextOutlineTest, OtherUnitsThanThoseOfTimes) {
  for (const double step : {0.25, 1.0}) {
    std::string behind = "t [s];Real-time disp [mm];a [g]\n";
    std::string before = "Real-time disp [mm];t [s];a [g]\n";
    std::string alone = "a [g];Real-time disp [mm]\n";
    std::string seconds = "t [s];Sample time [ms];a [g]\n";
    std::string number = "Sample [1];t [s];a [g]\n";
    for (int i = 0; i < 8; ++i) {
      const std::string time = "0.0" + std::to_string(i) + ";";
      const std::string rising = std::to_string(step * i);
      const std::string value = std::to_string(i * i % 5);
      behind += time + rising + ";" + value + "\n";
      before += rising + ";" + time + value + "\n";
      alone += value + ";" + rising + "\n";
      seconds += time + rising + ";" + value + "\n";
      number += std::to_string(i) + ";" + time + value + "\n";
    }
    EXPECT_EQ(OutlineOf(behind).time_column, 0);
    EXPECT_THAT(OutlineOf(behind).is_channel, ElementsAre(false, true, true));
    EXPECT_THAT(OutlineOf(behind).UnusedTimes("t"), IsEmpty());
    EXPECT_EQ(OutlineOf(before).time_column, 1);
    EXPECT_THAT(OutlineOf(before).is_channel, ElementsAre(true, false, true));
    EXPECT_EQ(OutlineOf(alone).time_column, -1);
    EXPECT_THAT(OutlineOf(alone).is_channel, ElementsAre(true, true));
    EXPECT_THAT(OutlineOf(seconds).is_channel, ElementsAre(false, false, true));
    EXPECT_THAT(OutlineOf(number).is_channel, ElementsAre(false, false, true));
  }
}

// Years, days, hours and minutes beside seconds are parts of a clock.
TEST(TextOutlineTest, PartsOfAClockAreNoChannels) {
  const TextOutline days = OutlineOf(
      "Year,DOY,Sec,a\n2024,65,0.1,3\n2024,65,0.2,1\n2024,65,0.3,2\n");
  EXPECT_EQ(days.time_column, 2);
  EXPECT_THAT(days.is_channel, ElementsAre(false, false, false, true));
  const std::string rows =
      "Hour;Minute;Second;a\n12;59;59.8;3\n12;59;59.9;1\n13;0;0.0;2\n13;0;0."
      "1;4\n";
  const TextOutline clock = OutlineOf(rows);
  EXPECT_EQ(clock.time_column, 2);
  EXPECT_THAT(clock.is_channel, ElementsAre(false, false, false, true));
  TextFormat format;
  format.time_column = "Second";
  Table table;
  std::string error;
  ASSERT_TRUE(ParseTextTable(rows, "r.csv", {}, format, &table, &error))
      << error;
  EXPECT_NEAR(table.values(3, 2), 0.3, 1e-9);
  // Alone it may be the second of two sensors.
  EXPECT_THAT(OutlineOf("t;first;second\n0;1;3\n0.1;2;1\n0.2;0;2\n").is_channel,
              ElementsAre(false, true, true));
}

// Hour, minute and second that say the same as the time are no channels.
TEST(TextOutlineTest, PartsThatRepeatTheTime) {
  struct Repeated {
    const char* header;
    // Rows; %s is the second.
    const char* row;
    bool are_repeated;
  };
  for (const Repeated& names :
       {Repeated{"Timestamp,Hour,Min,Sec,a", "2024-03-01 12:30:0%s.5,12,30,%s",
                 true},
        {"Time,hh,mm,ss,a", "12:30:0%s,12,30,%s", true},
        {"Time,hh,mm,ss,ms,a", "12:30:0%s.250,12,30,%s,250", true},
        // Local hours beside UTC, with quarters of an hour.
        {"Timestamp,Hour,Min,Sec,a", "2024-03-01T22:30:0%sZ,4,15,%s", true},
        {"Timestamp,Hour,Min,Sec,a", "170929620%s000,12,30,%s", true},
        {"Time [s],Hour,Min,Sec,a", "0%s.25,8,17,3%s", true},
        // Other times, and numbers that are no times.
        {"Timestamp,Hour,Min,Sec,a", "2024-03-01 12:30:0%s,12,31,%s", false},
        {"Timestamp,Hour,Min,Sec,a", "2024-03-01 12:30:0%s,12,30,0", false},
        {"Time [s],Hour,Min,Sec,a", "0.%s,8,17,30", false},
        {"Time [s],hh,min,ss,a", "0.%s,8,17.5,30", false}}) {
    std::string text = std::string(names.header) + "\n";
    for (int i = 0; i < 6; ++i) {
      std::string row = names.row;
      for (size_t at = row.find("%s"); at != std::string::npos;
           at = row.find("%s")) {
        row.replace(at, 2, std::to_string(i));
      }
      text += row + "," + std::to_string(i % 3) + "\n";
    }
    const TextOutline outline = OutlineOf(text);
    EXPECT_EQ(outline.time_column, 0) << text;
    EXPECT_EQ(outline.is_channel[2], !names.are_repeated) << text;
    EXPECT_TRUE(outline.is_channel.back()) << text;
    EXPECT_EQ(outline.repeated_parts.size(),
              names.are_repeated ? outline.columns.size() - 2 : 0)
        << text;
    const std::vector<std::string> unused =
        outline.UnusedTimes(outline.columns[0].name);
    const std::string& minute = outline.columns[2].name;
    EXPECT_EQ(std::count(unused.begin(), unused.end(), minute),
              names.are_repeated ? 1 : 0)
        << text;
  }
}

// A part of a clock needs a unit to be the time: a DOY of 65.25 is no seconds.
TEST(TextOutlineTest, PartsOfAClockNeedAUnit) {
  const std::string text = "DOY,a\n65.25,3\n65.50,1\n65.75,2\n";
  TextFormat format;
  format.time_column = "DOY";
  Table table;
  std::string error;
  EXPECT_FALSE(ParseTextTable(text, "r.csv", {}, format, &table, &error));
  EXPECT_THAT(error, HasSubstr("`time_unit = \"day\"`"));
  format.time_unit = "day";
  ASSERT_TRUE(ParseTextTable(text, "r.csv", {}, format, &table, &error))
      << error;
  EXPECT_EQ(table.time_unit, "day");
  // Counts since 1970 are told by their size.
  format = TextFormat();
  format.time_column = "Date";
  ASSERT_TRUE(ParseTextTable(
      "Date,a\n1709640000000,3\n1709640000010,1\n1709640000020,2\n", "r.csv",
      {}, format, &table, &error))
      << error;
  EXPECT_NEAR(table.values(2, 0), 0.02, 1e-9);
  format.time_column = "Year";
  EXPECT_FALSE(ParseTextTable("Year,a\n2024.5,3\n2024.6,1\n2024.7,2\n", "r.csv",
                              {}, format, &table, &error));
  EXPECT_THAT(error, HasSubstr("`sampling_rate_hz`"));
}

// Clock times of an unusual form are the time by their name, and reading them
// names the key.
TEST(TextOutlineTest, ClocksOfAnUnusualForm) {
  const std::string text =
      "Time,a\n12h00m00.00,0.5\n12h00m00.01,1\n12h00m00.02,2\n";
  EXPECT_EQ(OutlineOf(text).time_column, 0);
  EXPECT_THAT(OutlineOf(text).is_channel, ElementsAre(false, true));
  TextFormat format;
  format.time_column = "Time";
  Table table;
  std::string error;
  EXPECT_FALSE(ParseTextTable(text, "r.csv", {}, format, &table, &error));
  EXPECT_THAT(error, HasSubstr(":2: column 'Time': '12h00m00.00' is neither"));
  EXPECT_THAT(error, HasSubstr("`time_format`"));
  format.time_format = "%Hh%Mm%S.%f";
  ASSERT_TRUE(ParseTextTable(text, "r.csv", {}, format, &table, &error))
      << error;
  EXPECT_NEAR(table.values(2, 0), 0.02, 1e-9);
  // A text beside a time of numbers stays a text.
  EXPECT_EQ(OutlineOf("t,Time,a\n0,x,3\n0.1,y,1\n0.2,z,2\n").time_column, 0);
}

}  // namespace
}  // namespace pinode
