#include "pinode/record/table.h"

#include <cmath>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/measured_data_testing.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

Table Parse(const std::string& text,
            const std::vector<std::string>& wanted = {}) {
  Table table;
  std::string error;
  EXPECT_TRUE(ParseCsvTable(text, "r.csv", wanted, &table, &error)) << error;
  return table;
}

Matrix Numbers(int rows, int cols, const std::vector<double>& values) {
  Matrix result(rows, cols);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < cols; ++j) {
      result(i, j) = values[static_cast<size_t>(i * cols + j)];
    }
  }
  return result;
}

TEST(CsvTableTest, RowsThatAreCommentedOutAreLeftOut) {
  Table table;
  std::string error;
  ASSERT_TRUE(ParseCsvTable("t,a1,a2\n0.00,1.5,2\n#0.01,7,7\n0.02,2.5,3\n",
                            "x.csv", {"a2"}, &table, &error))
      << error;
  ASSERT_EQ(table.num_rows(), 2);
  EXPECT_EQ(table.values(1, 0), 3.0);
  EXPECT_EQ(table.line_numbers[1], 4);
}

TEST(CsvTableTest, ReadsWhatLoggersWrite) {
  const Matrix expected = Numbers(2, 3, {0, 1.5, -2, 0.01, 1e-3, 3});
  for (const char* text :
       {"t,a,b\n0,1.5,-2\n0.01,1e-3,3\n",                // plain
        "t,a,b\n0,1.5,-2\n0.01,1e-3,3",                  // no last line end
        "t,a,b\r\n0,1.5,-2\r\n0.01,1e-3,3\r\n",          // CRLF
        "t,a,b\r0,1.5,-2\r0.01,1e-3,3\r",                // CR
        "\xEF\xBB\xBFt,a,b\n0,1.5,-2\n0.01,1e-3,3\n",    // byte order mark
        "t;a;b\n0;1.5;-2\n0.01;1e-3;3\n",                // semicolons
        "t\ta\tb\n0\t1.5\t-2\n0.01\t1e-3\t3\n",          // tabs
        " t , a , b \n 0 , +1.5 , -2 \n0.01,1D-3, 3\n",  // blanks, Fortran
        "\"t\",\"a\",\"b\"\n\"0\",\"1.5\",-2\n0.01,1e-3,3\n",  // quotes
        "# logger 7, \"north\n\n# rate\nt,a,b\n\n0,1.5,-2\n# pause\n"
        "0.01,1e-3,3\n\n"}) {  // comments and blank lines
    const Table table = Parse(text);
    EXPECT_THAT(table.columns, ElementsAre("t", "a", "b")) << text;
    ASSERT_EQ(table.num_rows(), 2) << text;
    EXPECT_EQ(table.values, expected) << text;
  }
}

TEST(CsvTableTest, KnowsTheLineOfEachRow) {
  const Table table =
      Parse("# one\nt,note\n\n0,\"two\nlines\"\n# five\n1,x\n", {"t"});
  EXPECT_THAT(table.line_numbers, ElementsAre(4, 7));
  EXPECT_EQ(table.path, "r.csv");
}

TEST(CsvTableTest, EmptyCellsAreMissing) {
  for (const char* text :
       {"t,a,b\n0,,2\n1,nan,\n", "t\ta\tb\n0\t\t2\n1\tNaN\t\n",
        "t;a;b\n0; ;2\n1;\"\";\n"}) {
    const Table table = Parse(text);
    ASSERT_EQ(table.values.rows(), 2);
    ASSERT_EQ(table.values.cols(), 3);
    EXPECT_EQ(table.values(0, 0), 0.0);
    EXPECT_TRUE(std::isnan(table.values(0, 1))) << text;
    EXPECT_EQ(table.values(0, 2), 2.0);
    EXPECT_TRUE(std::isnan(table.values(1, 1)));
    EXPECT_TRUE(std::isnan(table.values(1, 2)));
  }
}

TEST(CsvTableTest, KeepsTheColumnsAskedFor) {
  const Table table = Parse(
      "date,t,\"acc, north\",a,a\nMon,0,1,2,3\nTue,1,inf,4,5\nWed,2,6,7,8\n",
      {"t"});
  EXPECT_THAT(table.columns, ElementsAre("t"));
  EXPECT_EQ(table.values, Numbers(3, 1, {0, 1, 2}));

  const Table order = Parse("a,b,c,\n1,2,3,\n", {"c", "a", "c"});
  EXPECT_THAT(order.columns, ElementsAre("c", "a"));
  EXPECT_EQ(order.values, Numbers(1, 2, {3, 1}));
  EXPECT_EQ(order.FindColumn("a"), 1);
  EXPECT_EQ(order.FindColumn("b"), -1);
}

struct BadTable {
  const char* what;
  const char* text;
  std::vector<std::string> wanted;
  const char* error;
};

class BadTableTest : public ::testing::TestWithParam<BadTable> {};

TEST_P(BadTableTest, IsRefused) {
  Table table;
  table.path = "untouched";
  std::string error;
  EXPECT_FALSE(ParseCsvTable(GetParam().text, "r.csv", GetParam().wanted,
                             &table, &error));
  EXPECT_THAT(error, StartsWith("r.csv:"));
  EXPECT_THAT(error, HasSubstr(GetParam().error));
  EXPECT_EQ(table.path, "untouched");
}

INSTANTIATE_TEST_SUITE_P(
    CsvTable, BadTableTest,
    ::testing::ValuesIn(std::vector<BadTable>{
        BadTable{"empty", "", {}, ": is empty"},
        BadTable{"blank", "\n# nothing\n\n", {}, ": is empty"},
        BadTable{"no_rows", "\nt,a\n# end\n", {}, ":2: no rows"},
        BadTable{"no_header", "# t,a\n0,1\n1,2\n", {}, ":2: the first line"},
        BadTable{"text",
                 "t,a\n0,1\n1,OVER\n",
                 {},
                 ":3: column 'a': 'OVER' is not a number"},
        BadTable{
            "text_in_time", "t,a\n12:30,1\n", {"t"}, ":2: column 't': '12:30'"},
        BadTable{"infinite", "t,a\n0,-inf\n", {}, ":2: column 'a': '-inf'"},
        BadTable{
            "short_row", "t,a,b\n0,1,2\n1,2\n", {}, ":3: 2 cells, expected 3"},
        BadTable{
            "long_row", "t,a\n0,1\n\n1,2.5,3\n", {}, ":4: 3 cells, expected 2"},
        BadTable{"unknown_column",
                 "t,acc_north,acc_east\n0,1,2\n",
                 {"t", "acc_nort"},
                 ":1: no column is named 'acc_nort'; did "
                 "you mean 'acc_north'?"},
        BadTable{"no_such_column",
                 "t,a\n0,1\n",
                 {"wind_speed"},
                 "; known are: t, a"},
        BadTable{"repeated_column",
                 "t,a,b,a\n0,1,2,3\n",
                 {"t", "a"},
                 ":1: the name 'a' occurs twice, in columns 2 and 4"},
        BadTable{"repeated_column_all", "t,a,a\n0,1,2\n", {}, "occurs twice"},
        BadTable{"decimal_comma",
                 "t;a\n0,00;1,5\n",
                 {},
                 ":2: column 't': '0,00' has a decimal comma, expected a "
                 "decimal point ('0.00')"},
        BadTable{"decimal_comma_among_commas",
                 "t,a\n0,00,1,5\n",
                 {},
                 "decimal commas"},
        BadTable{"stray_quote", "t,a\n0,1\n1,2\"5\n", {}, ":3: stray quote"},
        BadTable{"open_quote",
                 "t,a\n0,1\n\"1,2\n2,3\n",
                 {},
                 ":3: a quoted cell begins here"}}),
    [](const ::testing::TestParamInfo<BadTable>& bad) {
      return std::string(bad.param.what);
    });

TEST(CsvTableTest, BadFiles) {
  Table table;
  std::string error;
  EXPECT_FALSE(ReadCsvTable("no/such.csv", {}, &table, &error));
  EXPECT_THAT(error, StartsWith("no/such.csv: cannot open"));

  const TemporaryFolder folder;
  const std::string path = folder.Write("latin1.csv", "t,a\n0,1\n1,\xB5\n");
  EXPECT_FALSE(ReadCsvTable(path, {"t"}, &table, &error));
  EXPECT_THAT(error, HasSubstr(":3: byte 0xB5 is not valid UTF-8"));
}

TEST(CsvTableTest, ReadsAMeasuredFile) {
  PINODE_FIND_MEASURED_DATA(path, "silverbox/SNLS80mV.csv");
  Table table;
  std::string error;
  ASSERT_TRUE(ReadCsvTable(path, {"output_V", "input_V"}, &table, &error))
      << error;
  EXPECT_EQ(table.num_rows(), 131072);
  EXPECT_EQ(table.values(0, 0), 0.0093978);
  EXPECT_EQ(table.values(0, 1), 0.0057756);
  EXPECT_TRUE(table.values.allFinite());
}

}  // namespace
}  // namespace pinode
