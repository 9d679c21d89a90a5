#include "pinode/case/text/csv_file.h"

#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

TEST(WriteCsv, WritesEveryRowOfALongFile) {
  // More than is written at a time.
  constexpr int kRows = 150000;
  const Vector time = Vector::LinSpaced(kRows, 0.0, 1.0 / 3.0);
  Vector gaps = Vector::LinSpaced(kRows, -1.0, 1.0);
  for (int i = 0; i < kRows; i += 7) {
    gaps[i] = std::numeric_limits<double>::quiet_NaN();
  }
  const TemporaryFolder folder;
  const std::string path = folder.Path("long.csv");
  std::string error;
  const std::vector<CsvColumn> columns = {
      {"t", time},
      {"x, m", kRows, [&gaps](Eigen::Index i) { return gaps[i]; }}};
  ASSERT_TRUE(WriteCsv(path, columns, &error)) << error;
  const std::string text = folder.Read("long.csv");
  EXPECT_GT(text.size(), size_t{2} << 20);
  std::istringstream lines(text);
  std::string line;
  ASSERT_TRUE(std::getline(lines, line));
  EXPECT_EQ(line, "t,\"x, m\"");
  int row = 0;
  for (; std::getline(lines, line); ++row) {
    const size_t comma = line.find(',');
    ASSERT_NE(comma, std::string::npos) << row;
    ASSERT_EQ(std::stod(line.substr(0, comma)), time[row]) << row;
    if (std::isnan(gaps[row])) {
      ASSERT_EQ(comma + 1, line.size()) << row;
    } else {
      ASSERT_EQ(std::stod(line.substr(comma + 1)), gaps[row]) << row;
    }
  }
  EXPECT_EQ(row, kRows);
}

TEST(CsvCell, FormulasAreText) {
  EXPECT_EQ(CsvCell("a1"), "a1");
  EXPECT_EQ(CsvCell("=1+1"), "'=1+1");
  EXPECT_EQ(CsvCell("=HYPERLINK(\"x\",1)"), "\"'=HYPERLINK(\"\"x\"\",1)\"");
  EXPECT_EQ(CsvCell("@sum"), "'@sum");
  EXPECT_EQ(CsvCell("+u1"), "'+u1");
  EXPECT_EQ(CsvCell("-u1"), "'-u1");
  EXPECT_EQ(CsvCell("\t=1"), "\"'\t=1\"");
  // Numbers stay numbers.
  EXPECT_EQ(CsvCell("-1051.2"), "-1051.2");
  EXPECT_EQ(CsvCell(std::string("+3e5")), "+3e5");
  EXPECT_EQ(CsvCell("u2-u1"), "u2-u1");
  EXPECT_EQ(CsvText("=1,1"), "'=1,1");
}

TEST(WriteCsv, WritesAHeaderWhereThereAreNoRows) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("empty.csv");
  std::string error;
  ASSERT_TRUE(WriteCsv(path, {{"t", Vector()}}, &error)) << error;
  const std::string text = folder.Read("empty.csv");
  EXPECT_EQ(text, "t\n");
}

}  // namespace
}  // namespace pinode
