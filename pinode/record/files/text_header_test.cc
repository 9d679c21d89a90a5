// Header lines with more than names and units, and marks around the rows.

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/record/files/text_table.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Table ParseWithHeader(const std::string& text) {
  Table table;
  std::string error;
  EXPECT_TRUE(ParseTextTable(text, "r.csv", {}, {}, &table, &error)) << error;
  return table;
}

// Campbell's TOA5: station, names, units, kinds of averages.
TEST(TextHeaderTest, FourLinesOfCampbell) {
  std::string text =
      "\"TOA5\",\"CR6\",\"CR6\",\"1234\",\"CR6.Std.07\",\"bridge\",\"5\"\n"
      "\"TIMESTAMP\",\"RECORD\",\"Acc(1)\",\"Acc(2)\"\n"
      "\"TS\",\"RN\",\"g\",\"mm\"\n\"\",\"\",\"Smp\",\"Avg\"\n";
  for (int i = 0; i < 30; ++i) {
    text += "\"2024-03-01 12:00:" + std::to_string(10 + i) + "\"," +
            std::to_string(100 + i) + "," + std::to_string(i % 7) +
            ".25,\"NAN\"\n";
  }
  const Table table = ParseWithHeader(text);
  EXPECT_THAT(table.columns, ElementsAre("RECORD", "Acc(1)", "Acc(2)"));
  EXPECT_THAT(table.units, ElementsAre("", "g", "mm"));
  EXPECT_EQ(table.values(1, 1), 1.25);
}

// A line of slots below the names does not cost the units.
TEST(TextHeaderTest, NamesWithUnitsAboveOthers) {
  const Table table = ParseWithHeader(
      "Halle\nZeit [s];Kraft [kN];Weg [mm]\n;Slot 1;Slot 2\n"
      "0,5;1,5;2,5\n0,6;1,6;2,6\n0,7;1,7;2,7\n");
  EXPECT_THAT(table.columns, ElementsAre("Zeit [s]", "Kraft [kN]", "Weg [mm]"));
  EXPECT_THAT(table.units, ElementsAre("s", "kN", "mm"));
  EXPECT_THAT(
      ParseWithHeader("Range [g];Range [g]\nA;B\n0,5;1,5\n0,6;1,6\n0,7;1,7\n")
          .columns,
      ElementsAre("A", "B"));
  // Names next to the rows stay if no line above them has units.
  EXPECT_THAT(
      ParseWithHeader("a;b;c\nd;e;f\n0,5;1,5;2,5\n0,6;1,6;2,6\n").columns,
      ElementsAre("d", "e", "f"));
}

// Names above the units, and start times and modules below them, as catman
// writes them.
TEST(TextHeaderTest, NamesAboveUnitsAndModules) {
  const Table table = ParseWithHeader(
      "File: bridge.bin\nZeit 1\tBeschl_1\tBeschl_2\ns\tm/s²\tm/s²\n"
      "Start 03.05.2024\tMX440B\tMX440B\n"
      "0,0\t1,5\t2,5\n0,1\t1,6\t2,6\n0,2\t1,7\t2,7\n");
  EXPECT_THAT(table.columns, ElementsAre("Zeit 1", "Beschl_1", "Beschl_2"));
  EXPECT_THAT(table.units, ElementsAre("s", "m/s^2", "m/s^2"));
  // Units above the names.
  EXPECT_THAT(ParseWithHeader("s;g;mm\nt;a;b\n0;1,5;2,5\n0,1;1,6;2,6\n0,2;1,"
                              "7;2,7\n")
                  .columns,
              ElementsAre("t", "a", "b"));
  EXPECT_THAT(ParseWithHeader("Run 1;Run 2;Run 3\ns;g;mm\nt;a;b\n0;1,5;2,5\n"
                              "0,1;1,6;2,6\n0,2;1,7;2,7\n")
                  .columns,
              ElementsAre("t", "a", "b"));
}

// The samples of one motion, several a line, are no rows of channels.
TEST(TextHeaderTest, WrappedMotions) {
  const std::string rows = "0.1 0.2 0.1\n0.3 0.2 0.4\n0.1 0.5 0.2\n";
  for (const char* line :
       {"NPTS=  9, DT= .0050", "NPTS= 9, DT= .005 SEC", "9 0.005 NPTS, DT",
        "TIMESERIES XX_A__BHZ_R, 9 samples, 40 sps, 2003-05-29T02:13:22.043400,"
        " SLIST, INTEGER, Counts"}) {
    const std::string text = "PEER\n" + std::string(line) + "\n" + rows;
    Table table;
    std::string error;
    EXPECT_FALSE(ParseTextTable(text, "r.txt", {}, {}, &table, &error)) << line;
    EXPECT_THAT(error,
                HasSubstr("r.txt:2: '" + std::string(line).substr(0, 4)));
    EXPECT_THAT(error, HasSubstr("samples of one motion, 3 a line"));
    EXPECT_THAT(error, HasSubstr("`header_lines = 2`"));
    TextFormat format;
    format.header_lines = 2;
    EXPECT_TRUE(ParseTextTable(text, "r.txt", {}, format, &table, &error))
        << error;
  }
  // A comment, and a size above the names, say nothing about the rows.
  EXPECT_EQ(ParseWithHeader("# npts 9, dt 0.005\n" + rows).columns.size(), 3u);
  EXPECT_THAT(ParseWithHeader("NPTS 9, DT .005\nt x y\n" + rows).columns,
              ElementsAre("t", "x", "y"));
}

// Names with blanks stand two or more of them apart.
TEST(TextHeaderTest, NamesWithBlanksBetweenBlanks) {
  const std::string rows =
      "  0.00    0.1    -0.2\n  0.01    0.3     0.4\n  0.02   -0.1     0.2\n";
  const Table table =
      ParseWithHeader("Time (s)   Acc 1 (g)   Acc 2 (g)\n" + rows);
  EXPECT_THAT(table.columns, ElementsAre("Time (s)", "Acc 1 (g)", "Acc 2 (g)"));
  EXPECT_THAT(table.units, ElementsAre("s", "g", "g"));
  EXPECT_EQ(table.values(2, 1), -0.1);
  EXPECT_THAT(ParseWithHeader("t   a   b\n" + rows).columns,
              ElementsAre("t", "a", "b"));
  EXPECT_THAT(ParseWithHeader("Time (s)  Acc X  Acc Y\n" + rows).columns,
              ElementsAre("Time (s)", "Acc X", "Acc Y"));
  // As many pieces as columns, but the names of others, or a title.
  for (const char* line :
       {"Time (s) Acc 1 (g)  Acc 2 (g)", "Time Acc X  Acc Y  (g)",
        "Time  Acc X Acc Y  (g)", "Bridge test  north span  channel list"}) {
    Table unused;
    std::string error;
    EXPECT_FALSE(ParseTextTable(std::string(line) + "\n" + rows, "r.txt", {},
                                {}, &unused, &error))
        << line;
  }
}

// The name of row numbers is no mark of a comment alone.
TEST(TextHeaderTest, NumberSignOverRowNumbers) {
  const std::string rows = "1,0.00,0.3\n2,0.01,0.1\n3,0.02,0.5\n";
  EXPECT_THAT(ParseWithHeader("#,Time,Acc\n" + rows).columns,
              ElementsAre("#", "Time", "Acc"));
  EXPECT_THAT(ParseWithHeader("# n,Time,Acc\n" + rows).columns,
              ElementsAre("n", "Time", "Acc"));
}

// Pairs of time and value below the line of ObsPy.
TEST(TextHeaderTest, PairsOfObsPy) {
  TextFormat format;
  format.time_column = "column_1";
  const std::string text =
      "TIMESERIES XX_A__BHZ_R, 3 samples, 40 sps, 2003-05-29T02:13:22.043400, "
      "TSPAIR, INTEGER, Counts\n2003-05-29T02:13:22.043400  -7\n"
      "2003-05-29T02:13:22.068400  2\n2003-05-29T02:13:22.093400  5\n";
  Table table;
  std::string error;
  ASSERT_TRUE(ParseTextTable(text, "r.txt", {"column_1", "column_2"}, format,
                             &table, &error))
      << error;
  EXPECT_NEAR(table.values(2, 0), 0.05, 1e-9);
  EXPECT_EQ(table.values(0, 1), -7.0);
}

// Old programs end a text with the mark of DOS.
TEST(TextHeaderTest, MarkBehindTheLastLine) {
  Table table;
  std::string error;
  for (const char* text :
       {"t,a\n0,1\n0.1,2\n0.2,5\n\x1A", "t;a\n0;1\n0,1;2\n0,2;5\x1A"}) {
    ASSERT_TRUE(ParseTextTable(text, "r.csv", {}, {}, &table, &error)) << error;
    ASSERT_EQ(table.num_rows(), 3);
    EXPECT_EQ(table.values(2, 1), 5.0);
  }
}

// A label in front of the units is no name, and units that repeat are none.
TEST(TextHeaderTest, UnitsBehindALabel) {
  std::string rows;
  for (int i = 1; i < 30; ++i) {
    rows += std::to_string(i) + ",0." + std::to_string(i) + ",1.5\n";
  }
  for (const char* label : {"Unit", "Einheit", "Units:", "单位", "x"}) {
    const Table table =
        ParseWithHeader("Sampling Frequency,100 Hz\nChannel,A1,A2\n" +
                        std::string(label) + ",gal,gal\n" + rows);
    EXPECT_THAT(table.columns, ElementsAre("Channel", "A1", "A2")) << label;
    EXPECT_THAT(table.units, ElementsAre("", "gal", "gal")) << label;
    EXPECT_EQ(table.num_rows(), 29) << label;
  }
  const Table timed = ParseWithHeader("Kanal,A1,A2\nZeit,gal,gal\n" + rows);
  EXPECT_THAT(timed.columns, ElementsAre("Zeit", "A1", "A2"));
  // Different units without a label may be names.
  EXPECT_THAT(ParseWithHeader("a,b,c\nx,g,m\n" + rows).columns,
              ElementsAre("x", "g", "m"));
}

// Ranges with units above the names are no names.
TEST(TextHeaderTest, RangesAboveNames) {
  const std::string rows = "0,5;1,5;2,5\n0,6;1,6;2,6\n0,7;1,7;2,7\n";
  for (const char* ranges :
       {"2 [g];5 [g];2 [g]", "\u00B12 [g];\u00B15 [g];\u00B12 [g]",
        "Range [g];2 [g];5 [g]", "Low [g];High [g];Low [g]"}) {
    EXPECT_THAT(
        ParseWithHeader(std::string(ranges) + "\nAcc1;Acc2;Acc3\n" + rows)
            .columns,
        ElementsAre("Acc1", "Acc2", "Acc3"))
        << ranges;
    EXPECT_THAT(
        ParseWithHeader(std::string(ranges) + "\nTime;Acc1;Acc2\n" + rows)
            .columns,
        ElementsAre("Time", "Acc1", "Acc2"))
        << ranges;
  }
  // Only the higher line names the time.
  EXPECT_THAT(ParseWithHeader("Zeit [s];Kraft [kN];Weg [mm]\nK1;K2;K3\n" + rows)
                  .columns,
              ElementsAre("Zeit [s]", "Kraft [kN]", "Weg [mm]"));
}

// Words for kinds of averages are names elsewhere.
TEST(TextHeaderTest, NamesLikeAverages) {
  const std::string rows = "0,5;1,5;2,5\n0,6;1,6;2,6\n0,7;1,7;2,7\n";
  EXPECT_THAT(
      ParseWithHeader("Deck north;Deck south;Pier 3\nMax;Min;Avg\n" + rows)
          .columns,
      ElementsAre("Max", "Min", "Avg"));
  EXPECT_THAT(
      ParseWithHeader("North;South;Pier 3\nmm;mm;g\nMax;Min;Avg\n" + rows)
          .columns,
      ElementsAre("North", "South", "Pier 3"));
}

}  // namespace
}  // namespace pinode
