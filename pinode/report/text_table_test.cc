#include "pinode/report/text_table.h"

#include <gtest/gtest.h>

namespace pinode {
namespace {

using Align = TextTable::Align;

TEST(TextTable, PutsDecimalPointsBelowEachOther) {
  TextTable table({{"name", Align::kLeft},
                   {"value", Align::kDecimal},
                   {"unit", Align::kLeft}});
  table.AddRow({"k1", "10.02", "N/m"});
  table.AddRow({"damper", "-0.12345", ""});
  table.AddRow({"count", "4000", "1"});
  table.AddRow({"c", "5.6e-06", "m/s\u00b2"});
  EXPECT_EQ(table.ToText(1),
            " name         value  unit\n"
            " ------  ----------  ----\n"
            " k1        10.02     N/m\n"
            " damper    -0.12345\n"
            " count   4000        1\n"
            " c          5.6e-06  m/s\u00b2\n");
}

TEST(TextTable, CountsCharactersAndNotBytes) {
  EXPECT_EQ(DisplayWidth("m/s\u00b2"), 4);
  TextTable table({{"\u00b1", Align::kDecimal}, {"next", Align::kLeft}});
  table.AddRow({"1.5", "x"});
  EXPECT_EQ(table.ToText(0),
            "  \u00b1  next\n"
            "---  ----\n"
            "1.5  x\n");
}

TEST(TextTable, PutsWordsAmongNumbersAtTheRight) {
  TextTable table({{"MAC", Align::kDecimal}, {"", Align::kLeft}});
  table.AddRow({"0.99", ""});
  table.AddRow({"-", "lost"});
  EXPECT_EQ(table.ToText(0),
            " MAC\n"
            "----\n"
            "0.99\n"
            "   -  lost\n");
}

TEST(TextTableDeathTest, WantsACellPerColumn) {
  TextTable table({{"a", Align::kLeft}});
  EXPECT_DEATH(table.AddRow({"1", "2"}), "one cell per column");
}

}  // namespace
}  // namespace pinode
