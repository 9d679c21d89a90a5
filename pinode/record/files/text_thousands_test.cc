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

bool ReadThousands(const std::string& text, const TextFormat& format,
                   Table* table, std::string* error) {
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
    ASSERT_TRUE(ReadThousands(text, {}, &table, &error)) << error;
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
  EXPECT_FALSE(ReadThousands(text, {}, &table, &error));
  EXPECT_EQ(error,
            "r.csv:3: '1.250' may have a decimal point or a separator of "
            "thousands; set `decimal` to \".\" or \",\", or write 1.2500 or "
            "1250 in the file");
  // One number written in another way decides, as the message says.
  for (const char* other : {"1.2500", "1250"}) {
    std::string mended = text;
    mended.replace(mended.find("1.250"), 5, other);
    EXPECT_TRUE(ReadThousands(mended, {}, &table, &error)) << error;
  }
  TextFormat format;
  format.decimal = ',';
  ASSERT_TRUE(ReadThousands(text, format, &table, &error)) << error;
  EXPECT_EQ(table.values(2, 1), -3400.0);
  format.decimal = '.';
  ASSERT_TRUE(ReadThousands(text, format, &table, &error)) << error;
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
    ASSERT_TRUE(ReadThousands(text, {}, &table, &error)) << error;
    EXPECT_EQ(table.values(1, 1), 1.25) << text;
  }
}

// The first number above 999 may stand far below the rows that tell the layout.
TEST(TextThousandsTest, PointsFarBelowThatMayPartThousands) {
  std::string text = "Zeit;Kraft [N]\n";
  for (int i = 0; i < 2499; ++i) {
    text += std::to_string(i) + ";" + std::to_string(850 + i % 7) + "\n";
  }
  Table table;
  std::string error;
  EXPECT_FALSE(
      ReadThousands(text + "2499;1.250\n2500;860\n", {}, &table, &error));
  EXPECT_THAT(error, HasSubstr("r.csv:2501: '1.250' may have a decimal point"));
  ASSERT_TRUE(
      ReadThousands(text + "2499;1.250\n2500;86.5\n", {}, &table, &error))
      << error;
  EXPECT_EQ(table.values(2499, 1), 1.25);
}

// A comma before three digits stays doubtful behind a minus sign of
// typographers, too.
TEST(TextThousandsTest, CommasThatMayPartThousandsAreRefused) {
  for (const char* last : {"1,250", "-1,250", "- 1,250", "\u22121,250"}) {
    Table table;
    std::string error;
    EXPECT_FALSE(
        ReadThousands("a;b\n1,714;2,250\n1,715;" + std::string(last) + "\n", {},
                      &table, &error))
        << last;
    EXPECT_THAT(error, HasSubstr("1,250' may have a decimal comma"));
  }
  for (const char* last :
       {"1,25", "-0,250", "\u22120,250", "1234", "\u22121234,250"}) {
    Table table;
    std::string error;
    EXPECT_TRUE(
        ReadThousands("a;b\n1,714;2,250\n1,715;" + std::string(last) + "\n", {},
                      &table, &error))
        << last << ": " << error;
  }
}

// Separators of lakhs are refused, and the message says what to write.
TEST(TextThousandsTest, LakhsAreRefused) {
  EXPECT_TRUE(IsLakhNumber("3,61,725.00"));
  EXPECT_TRUE(IsLakhNumber("-12,34,56,789"));
  for (const char* other : {"361,725.00", "3,61,72", "1,23", "3,61.725", "",
                            "123,45,678", ",61,725", "3,61,725 N"}) {
    EXPECT_FALSE(IsLakhNumber(other)) << other;
  }
  EXPECT_THAT(WhyNoLakh("3,61,725.00"), ::testing::HasSubstr("(361725.00)"));
  std::string text = "Time [s],F [N]\n";
  for (int i = 10; i < 40; ++i) {
    text +=
        "0." + std::to_string(i) + ",\"3,61,7" + std::to_string(i) + ".50\"\n";
  }
  Table table;
  std::string error;
  EXPECT_FALSE(ParseTextTable(text, "r.csv", {}, {}, &table, &error));
  EXPECT_THAT(error, ::testing::HasSubstr(":2: '3,61,710.50' has separators"));
}

}  // namespace
}  // namespace pinode
