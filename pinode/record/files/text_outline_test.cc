// Outlines: which column of a text file is the time, and which are channels.

#include <fstream>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/record/files/text_table.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TextOutline OutlineOf(const std::string& text) {
  const std::string path = ::testing::TempDir() + "outline.csv";
  std::ofstream(path) << text;
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
