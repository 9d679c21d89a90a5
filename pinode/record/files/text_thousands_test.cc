// Numbers whose thousands are separated.

#include "pinode/record/files/text_thousands.h"

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/record/files/text_table.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

TEST(JoinThousandsTest, Numbers) {
  struct Number {
    const char* cell;
    char decimal;
    const char* joined;
  };
  for (const Number& number : {
           Number{"1'340.07", '.', "1340.07"},
           Number{"-12\u2019345\u2019678", '.', "-12345678"},
           Number{"1\u00A0340,07", ',', "1340.07"},
           Number{"+1\u202F340", ',', "+1340"},
           Number{"1.340,07", ',', "1340.07"},
           Number{"1.340.070", ',', "1340070"},
           Number{"1,340.07", '.', "1340.07"},
           Number{"1 340,5", ',', "1340.5"},
           Number{"\u22120,621", ',', "-0.621"},
       }) {
    std::string joined;
    EXPECT_TRUE(JoinThousands(number.cell, number.decimal, false, &joined))
        << number.cell;
    EXPECT_EQ(joined, number.joined);
  }
}

TEST(JoinThousandsTest, OtherTexts) {
  std::string joined;
  for (const char* cell :
       {"", "-", "1.340", "1 340", "1234", "0.123,5", "1234.567,8", "1.34,5",
        "1'34", "1'3400", "1.340'070", "01.03.2024", "1.340,", "1.340,5e3",
        "1.340,5 g", "'340", "12:30"}) {
    EXPECT_FALSE(JoinThousands(cell, ',', false, &joined)) << cell;
  }
  EXPECT_TRUE(JoinThousands("1.340", ',', true, &joined));
  EXPECT_EQ(joined, "1340");
  EXPECT_FALSE(JoinThousands("0.340", ',', true, &joined));
}

bool Read(const std::string& text, const TextFormat& format, Table* table,
          std::string* error) {
  return ParseTextTable(text, "r.csv", {}, format, table, error);
}

// Each country writes the same three numbers.
TEST(TextThousandsTest, FilesOfSeveralCountries) {
  for (const char* text :
       {"t;a\n0.5;950.25\n0.6;-1'340.50\n0.7;12'345'678.00\n",
        "t;a\n0,5;950,25\n0,6;-1.340,50\n0,7;12.345.678,00\n",
        "t;a\n0,5;950,25\n0,6;-1\u00A0340,50\n0,7;12\u00A0345\u00A0678,00\n",
        "t,a\n0.5,\"950.25\"\n0.6,\"-1,340.50\"\n0.7,\"12,345,678.00\"\n"}) {
    Table table;
    std::string error;
    ASSERT_TRUE(Read(text, {}, &table, &error)) << error;
    ASSERT_EQ(table.num_rows(), 3);
    EXPECT_EQ(table.values(0, 1), 950.25) << text;
    EXPECT_EQ(table.values(1, 1), -1340.5) << text;
    EXPECT_EQ(table.values(2, 1), 12345678.0) << text;
  }
}

// Whole numbers with German separators of thousands look like fractions.
TEST(TextThousandsTest, PointsThatMayPartThousandsAreRefused) {
  const std::string text = "Zeit;Kraft [N]\n1;850\n2;1.250\n3;-3.400\n";
  Table table;
  std::string error;
  EXPECT_FALSE(Read(text, {}, &table, &error));
  EXPECT_THAT(error, HasSubstr("set `decimal` to \".\" or \",\""));
  TextFormat format;
  format.decimal = ',';
  ASSERT_TRUE(Read(text, format, &table, &error)) << error;
  EXPECT_EQ(table.values(2, 1), -3400.0);
  format.decimal = '.';
  ASSERT_TRUE(Read(text, format, &table, &error)) << error;
  EXPECT_EQ(table.values(2, 1), -3.4);
}

// Any number of another form shows that the points are decimal.
TEST(TextThousandsTest, PointsThatAreDecimal) {
  for (const char* text :
       {"t;a\n1;850\n2;1.250\n3;-3.4\n", "t;a\n1;850\n2;1.250\n3;0.400\n",
        "t;a\n1;850.000\n2;1.250\n3;3.400\n", "t;a\n1;0\n2;1.250\n3;3.400\n",
        "t;a\n0.1;850\n0.2;1.250\n0.3;3.400\n",
        "t;a\n1;8500\n2;1.250\n3;3.400\n"}) {
    Table table;
    std::string error;
    ASSERT_TRUE(Read(text, {}, &table, &error)) << error;
    EXPECT_EQ(table.values(1, 1), 1.25) << text;
  }
}

}  // namespace
}  // namespace pinode
