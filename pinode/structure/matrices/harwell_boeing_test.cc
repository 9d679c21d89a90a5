#include "pinode/structure/matrices/harwell_boeing.h"

#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A lower triangle of two DOFs, with one part to replace.
std::string Small(const std::string& from = "", const std::string& to = "") {
  std::string content =
      "two DOFs\n"
      "             3             1             1             1\n"
      "RSA                        2             2             3             0\n"
      "(3I4)           (3I4)           (3E10.3)\n"
      "   1   3   4\n"
      "   1   2   2\n"
      " 4.000E+00-1.000E+00 3.000E+00\n";
  const size_t at = content.find(from);
  if (!from.empty() && at != std::string::npos) {
    content.replace(at, from.size(), to);
  }
  return content;
}

std::string HarwellBoeingErrorOf(const std::string& content) {
  SparseMatrix matrix;
  std::string error;
  EXPECT_FALSE(
      ReadHarwellBoeingText("K.matrix", content, 100, &matrix, &error));
  return error;
}

TEST(HarwellBoeing, SymmetricTriangleStandsForBoth) {
  SparseMatrix matrix;
  std::string error;
  ASSERT_TRUE(ReadHarwellBoeingText("K.matrix", Small(), 100, &matrix, &error))
      << error;
  Matrix expected(2, 2);
  expected << 4.0, -1.0, -1.0, 3.0;
  EXPECT_EQ(Matrix(matrix), expected);
}

TEST(HarwellBoeing, WholeNumbersMayHaveAFormatOfTheirOwn) {
  std::string content = Small("RSA", "ISA");
  content.replace(content.find("(3E10.3)"), 8, "(3I10)  ");
  content.replace(content.find(" 4.000E+00"), 30,
                  "         4        -1         3");
  SparseMatrix matrix;
  std::string error;
  ASSERT_TRUE(ReadHarwellBoeingText("K.hb", content, 100, &matrix, &error))
      << error;
  EXPECT_EQ(matrix.coeff(0, 1), -1.0);
  EXPECT_EQ(matrix.coeff(1, 1), 3.0);
}

TEST(HarwellBoeing, BadFilesAreRefusedByLine) {
  EXPECT_THAT(HarwellBoeingErrorOf(""),
              HasSubstr("K.matrix:1: the file ends here"));
  EXPECT_THAT(HarwellBoeingErrorOf(std::string("a\0b\n", 4)),
              HasSubstr("ASCII"));
  EXPECT_THAT(HarwellBoeingErrorOf("title\nno numbers\n"),
              HasSubstr(":2: the line is"));
  EXPECT_THAT(HarwellBoeingErrorOf(Small("RSA", "PSA")),
              HasSubstr("without values"));
  EXPECT_THAT(HarwellBoeingErrorOf(Small("RSA", "CSA")), HasSubstr("complex"));
  EXPECT_THAT(HarwellBoeingErrorOf(Small("RSA", "RSE")), HasSubstr("elements"));
  EXPECT_THAT(HarwellBoeingErrorOf(Small("RSA", "RZA")),
              HasSubstr("expected RSA"));
  EXPECT_THAT(HarwellBoeingErrorOf(Small("             2             2 ",
                                         "             2             3 ")),
              HasSubstr("2 x 3"));
  EXPECT_THAT(HarwellBoeingErrorOf(Small("             2             2 ",
                                         "           200           200 ")),
              HasSubstr("at most 100 rows"));
  EXPECT_THAT(HarwellBoeingErrorOf(Small("(3I4)", "(3A4)")),
              HasSubstr(":4: the format 1"));
  EXPECT_THAT(HarwellBoeingErrorOf(Small("(3E10.3)", "(3I10)")),
              HasSubstr("the format 3"));
  EXPECT_THAT(HarwellBoeingErrorOf(Small("   1   3   4", "   1   4   3")),
              HasSubstr(":5: the beginning of column 3 is '3'"));
  EXPECT_THAT(HarwellBoeingErrorOf(Small("   1   3   4", "   2   3   4")),
              HasSubstr("the beginning of column 1 is '2'"));
  EXPECT_THAT(HarwellBoeingErrorOf(Small("   1   2   2", "   1   3   2")),
              HasSubstr(":6: row 2 of the list is '3'"));
  EXPECT_THAT(HarwellBoeingErrorOf(Small("   1   2   2", "   1   1   2")),
              HasSubstr("entry (1, 1)"));
  EXPECT_THAT(HarwellBoeingErrorOf(Small("-1.000E+00", "-1.000E+0x")),
              HasSubstr(":7: entry (2, 1) is '-1.000E+0x'"));
  EXPECT_THAT(HarwellBoeingErrorOf(Small("-1.000E+00", "       nan")),
              HasSubstr("finite number"));
  EXPECT_THAT(HarwellBoeingErrorOf(Small(" 3.000E+00", "")),
              HasSubstr("entry (2, 2)"));
}

TEST(RowMapping, NamesRowsInTheirOrder) {
  std::vector<std::string> names;
  std::string error;
  ASSERT_TRUE(ReadRowMappingText("K.mapping",
                                 "  Matrix Eqn   Node   DOF\n"
                                 "  2  12  ROTY\n  1  12  UX\n  3  7  TEMP\n",
                                 &names, &error))
      << error;
  EXPECT_THAT(names, ElementsAre("12.1", "12.5", "7.TEMP"));
}

TEST(RowMapping, EachRowOnce) {
  const auto error_of = [](const std::string& content) {
    std::vector<std::string> names;
    std::string error;
    EXPECT_FALSE(ReadRowMappingText("K.mapping", content, &names, &error));
    return error;
  };
  EXPECT_THAT(error_of("title\n"), HasSubstr("no rows"));
  EXPECT_THAT(error_of("1 4 UX\n1 4 UY\n"), HasSubstr(":2: row 1 was given"));
  EXPECT_THAT(error_of("1 4 UX\n3 4 UY\n"), HasSubstr("row 2 is missing"));
  EXPECT_THAT(error_of("1 4 UX\n2 UY\n"), HasSubstr(":2: the line is"));
  EXPECT_THAT(error_of("1 4 UX\n0 4 UY\n"), HasSubstr(":2: the line is"));
}

}  // namespace
}  // namespace pinode
