// Header lines with more than names and units.

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/record/files/text_table.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;

Table Parse(const std::string& text) {
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
  const Table table = Parse(text);
  EXPECT_THAT(table.columns, ElementsAre("RECORD", "Acc(1)", "Acc(2)"));
  EXPECT_THAT(table.units, ElementsAre("", "g", "mm"));
  EXPECT_EQ(table.values(1, 1), 1.25);
}

// A line of slots below the names does not cost the units.
TEST(TextHeaderTest, NamesWithUnitsAboveOthers) {
  const Table table = Parse(
      "Halle\nZeit [s];Kraft [kN];Weg [mm]\n;Slot 1;Slot 2\n"
      "0,5;1,5;2,5\n0,6;1,6;2,6\n0,7;1,7;2,7\n");
  EXPECT_THAT(table.columns, ElementsAre("Zeit [s]", "Kraft [kN]", "Weg [mm]"));
  EXPECT_THAT(table.units, ElementsAre("s", "kN", "mm"));
  EXPECT_THAT(
      Parse("Range [g];Range [g]\nA;B\n0,5;1,5\n0,6;1,6\n0,7;1,7\n").columns,
      ElementsAre("A", "B"));
  // Names next to the rows stay if no line above them has units.
  EXPECT_THAT(Parse("a;b;c\nd;e;f\n0,5;1,5;2,5\n0,6;1,6;2,6\n").columns,
              ElementsAre("d", "e", "f"));
}

}  // namespace
}  // namespace pinode
