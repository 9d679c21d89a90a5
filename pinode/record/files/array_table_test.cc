#include "pinode/record/files/array_table.h"

#include <cmath>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

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

TEST(ArrayTableTest, NamesOfTimes) {
  for (const char* name : {"t", "time", "Time", "run(1).time", "setup1/t"}) {
    EXPECT_TRUE(IsTimeOfArrays(name)) << name;
  }
  // Transverse, or a temperature.
  for (const char* name : {"T", "acc.T", "time.acc", "data.t2", "rate"}) {
    EXPECT_FALSE(IsTimeOfArrays(name)) << name;
  }
}

// A table of rising times of these names.
Table TableOfTimes(const std::vector<std::string>& names) {
  Table table;
  table.columns = names;
  table.values = Vector::LinSpaced(11, 0.0, 0.1)
                     .replicate(1, static_cast<Eigen::Index>(names.size()));
  return table;
}

TEST(ArrayTableTest, TimesOfStructures) {
  const auto time = [](const std::vector<std::string>& names) {
    return FindArrayTimes(TableOfTimes(names), "").time;
  };
  EXPECT_EQ(time({"a", "data.time", "time", "t"}), "t");
  EXPECT_EQ(time({"data.t", "time"}), "time");
  EXPECT_EQ(time({"data.acc[1]", "data.Time"}), "data.Time");
  EXPECT_EQ(time({"run(1).time", "run(2).time"}), "run(1).time");
  EXPECT_EQ(time({"data.t2", "time.acc", "acc.T"}), "");
  const ArrayTimes given = FindArrayTimes(TableOfTimes({"t", "a.t"}), "a.t");
  EXPECT_EQ(given.time, "a.t");
  EXPECT_THAT(given.others, ElementsAre("t"));
  EXPECT_EQ(given.other_clock, "");
  EXPECT_EQ(FindArrayTimes(TableOfTimes({"t"}), "x").time, "x");
}

// Times rise; a sensor called so does not.
TEST(ArrayTableTest, TimesRise) {
  Table table = TableOfTimes({"t", "b.time"});
  table.values(3, 0) = std::nan("");
  EXPECT_EQ(FindArrayTimes(table, "").time, "t");
  table.values(4, 0) = -1.0;
  EXPECT_EQ(FindArrayTimes(table, "").time, "b.time");
  EXPECT_THAT(FindArrayTimes(table, "").others, IsEmpty());
  // Rounded times repeat; a temperature that rises now and then is none.
  for (int i = 0; i < 11; ++i) table.values(i, 0) = std::floor(0.5 * i);
  EXPECT_EQ(FindArrayTimes(table, "").time, "t");
  for (int i = 0; i < 11; ++i) table.values(i, 0) = i < 9 ? 20.0 : 12.0 + i;
  EXPECT_EQ(FindArrayTimes(table, "").time, "b.time");
  table.values.col(0).setConstant(20.0);
  EXPECT_EQ(FindArrayTimes(table, "").time, "b.time");
}

TEST(ArrayTableTest, OtherClocks) {
  const auto other = [](double begin, double step) {
    Table table = TableOfTimes({"t", "b.t"});
    table.values.col(1) = Vector::LinSpaced(11, begin, begin + 10.0 * step);
    const ArrayTimes times = FindArrayTimes(table, "");
    EXPECT_EQ(times.time, "t");
    EXPECT_THAT(times.others, ElementsAre("b.t"));
    return times.other_clock;
  };
  EXPECT_EQ(other(0.0, 0.01), "");
  EXPECT_EQ(other(1e-4, 0.01), "");
  EXPECT_EQ(other(0.0, 0.005), "b.t");
  EXPECT_EQ(other(0.0, 0.0101), "b.t");
  // Another recorder that began later.
  EXPECT_EQ(other(5.37, 0.01), "b.t");
  // Seconds since 1970.
  EXPECT_EQ(other(1.7e9, 0.01), "");
  EXPECT_EQ(other(1.7e9, 0.005), "b.t");
  // A clock without a row in common.
  Table table = TableOfTimes({"t", "b.t"});
  table.values.col(0).tail(6).setConstant(std::nan(""));
  table.values.col(1).head(6).setConstant(std::nan(""));
  EXPECT_EQ(FindArrayTimes(table, "").other_clock, "b.t");
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
