#include "pinode/base/header_cells.h"

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;

TEST(CellsBeyondAsciiTest, LeavesOutCellsOfAscii) {
  EXPECT_EQ(CellsBeyondAscii("a;b\nt;W\xE4gung;x\r\n1;2;3\nT [\xB0];s\n"),
            "W\xE4gung;\nT [\xB0];\n");
  // The comma in front of a unit stays.
  EXPECT_EQ(CellsBeyondAscii("x;a, \xF1;b"), "a, \xF1;\n");
  EXPECT_EQ(CellsBeyondAscii("a;b\n"), "");
}

TEST(CellsBeyondAsciiTest, LongLinesAreCutBetweenCells) {
  std::string ascii;
  for (int i = 0; i < 3000; ++i) ascii += "channel;";
  EXPECT_EQ(CellsBeyondAscii(ascii + "\xE4;b\n"), "\xE4;\n");
  std::string cells;
  for (int i = 0; i < 3000; ++i) cells += "\xBC\xD3\xCB;";
  const std::string found = CellsBeyondAscii(cells + "\n");
  EXPECT_EQ(found.size() % 4, 1u);
  EXPECT_GT(found.size(), 8000u);
  EXPECT_LE(found.size(), 8193u);
  // A long comment without delimiters is cut at a blank.
  std::string words;
  for (int i = 0; i < 3000; ++i) words += "\xBC\xD3\xCB ";
  EXPECT_EQ(CellsBeyondAscii(words).size() % 4, 1u);
  EXPECT_GT(CellsBeyondAscii(words).size(), 8000u);
}

TEST(UnitsOfCellsTest, FindsBracketsCommasAndRows) {
  EXPECT_THAT(UnitsOfCells("Время [с];Сила (кН);a [g];T [°C]"),
              ElementsAre("s", "kN", ""));
  EXPECT_THAT(UnitsOfCells("Время, с;X, мм"), ElementsAre("s", "mm"));
  EXPECT_THAT(UnitsOfCells("t;X;Y\nс;мм;м\n"), ElementsAre("s", "mm", "m"));
  // One letter may be a name.
  EXPECT_THAT(UnitsOfCells("t;В;Канал"), ElementsAre());
  EXPECT_THAT(UnitsOfCells("t;В"), ElementsAre());
  EXPECT_THAT(UnitsOfCells("Сила [кН"), ElementsAre());
}

}  // namespace
}  // namespace pinode
