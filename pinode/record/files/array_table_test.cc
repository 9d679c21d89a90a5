#include "pinode/record/files/array_table.h"

#include <cmath>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string Sample(const std::string& name) {
  return std::string(PINODE_SOURCE_DIR) + "/tests/fuzz/corpus/arrays/" + name;
}

std::string ErrorOf(const std::string& name,
                    const std::vector<std::string>& wanted) {
  Table table;
  std::string error;
  EXPECT_FALSE(ReadTable(Sample(name), wanted, {}, &table, &error));
  EXPECT_THAT(error, HasSubstr(name));
  return error;
}

TEST(ArrayTableTest, ColumnsOfArrays) {
  for (const char* name : {"record.npz", "record.mat", "record.h5"}) {
    const std::string y = name[7] == 'h' ? "setup1/y" : "y";
    Table table;
    std::string error;
    ASSERT_TRUE(ReadTable(Sample(name), {y + "[3]", "t", y + "[1]", "t"}, {},
                          &table, &error))
        << error;
    EXPECT_THAT(table.columns, ElementsAre(y + "[3]", "t", y + "[1]"));
    ASSERT_EQ(table.num_rows(), 7);
    for (int k = 0; k < 7; ++k) {
      EXPECT_NEAR(table.values(k, 0), 3.0 * std::sin(0.5 * k + 2.0), 1e-14);
      EXPECT_NEAR(table.values(k, 1), 0.01 * k, 1e-15);
      EXPECT_NEAR(table.values(k, 2), std::sin(0.5 * k), 1e-14);
      EXPECT_EQ(table.line_numbers[static_cast<size_t>(k)], k + 1);
    }
  }
}

TEST(ArrayTableTest, AllColumnsOfTheLongestArrays) {
  Table table;
  std::string error;
  ASSERT_TRUE(ReadTable(Sample("record.npz"), {}, {}, &table, &error)) << error;
  EXPECT_THAT(table.columns, ElementsAre("a", "t", "y[1]", "y[2]", "y[3]"));
  EXPECT_TRUE(std::isnan(table.values(2, 0)));
}

TEST(ArrayTableTest, TimesOfStructures) {
  EXPECT_EQ(TimeOfArrays({"a", "data.time", "t"}), "t");
  EXPECT_EQ(TimeOfArrays({"time", "data.t"}), "time");
  EXPECT_EQ(TimeOfArrays({"data.acc[1]", "data.Time"}), "data.Time");
  EXPECT_EQ(TimeOfArrays({"setup1/t", "setup1/acc"}), "setup1/t");
  // Several clocks, and names that are none.
  EXPECT_EQ(TimeOfArrays({"run(1).time", "run(2).time"}), "");
  EXPECT_EQ(TimeOfArrays({"data.t2", "time.acc", "data.rate"}), "");
  EXPECT_TRUE(IsTimeOfArrays("run(1).time"));
  EXPECT_FALSE(IsTimeOfArrays("time.acc"));
}

TEST(ArrayTableTest, SaysWhatIsWrong) {
  EXPECT_THAT(ErrorOf("record.npz", {"x"}),
              HasSubstr("no array is called 'x'"));
  EXPECT_THAT(ErrorOf("record.npz", {"y"}),
              HasSubstr("expected 'y[1]' to 'y[3]'"));
  EXPECT_THAT(ErrorOf("record.mat", {"y[4]"}), HasSubstr("none of them"));
  EXPECT_THAT(ErrorOf("record.mat", {"y[0]"}), HasSubstr("none of them"));
  EXPECT_THAT(ErrorOf("record.mat", {"a[2]"}), HasSubstr("expected 'a[1]'"));
  EXPECT_THAT(ErrorOf("record.mat", {"z[1]"}), HasSubstr("complex"));
  EXPECT_THAT(ErrorOf("record.mat", {"cube[1]"}), HasSubstr("3 dimensions"));
  EXPECT_THAT(ErrorOf("record.h5", {"t", "rate"}),
              HasSubstr("'rate' has 1 samples and 't' 7"));
}

}  // namespace
}  // namespace pinode
