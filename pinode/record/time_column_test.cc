#include "pinode/record/time_column.h"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "tests/support/measured_data_testing.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

// Columns t and a; row i stands on line i + 2.
Table MakeTable(
    const std::vector<double>& times,
    const std::function<double(double)>& a = [](double t) { return t; }) {
  Table table;
  table.path = "r.csv";
  table.columns = {"t", "a"};
  table.values.resize(static_cast<Eigen::Index>(times.size()), 2);
  for (size_t i = 0; i < times.size(); ++i) {
    table.values.row(static_cast<Eigen::Index>(i)) << times[i], a(times[i]);
    table.line_numbers.push_back(static_cast<int>(i) + 2);
  }
  return table;
}

// Times of n samples at `rate`, rounded to `digits` decimals.
std::vector<double> RoundedTimes(int n, double rate, int digits) {
  const double scale = std::pow(10.0, digits);
  std::vector<double> times;
  for (int i = 0; i < n; ++i) {
    times.push_back(std::round(i / rate * scale) / scale);
  }
  return times;
}

TimeGrid Find(const Table& table, const TimeColumnOptions& options = {}) {
  TimeGrid grid;
  std::string error;
  EXPECT_TRUE(FindTimeGrid(table, "t", options, &grid, &error)) << error;
  return grid;
}

std::string Refusal(const Table& table, const TimeColumnOptions& options = {}) {
  TimeGrid grid;
  std::string error;
  EXPECT_FALSE(FindTimeGrid(table, "t", options, &grid, &error));
  EXPECT_THAT(error, StartsWith("r.csv:"));
  EXPECT_EQ(grid.num_samples(), 0);
  return error;
}

TEST(TimeColumnTest, CleanTimesNeedNoRemark) {
  const Table table = MakeTable(RoundedTimes(3001, 100.0, 9));
  const TimeGrid grid = Find(table);
  EXPECT_EQ(grid.num_samples(), 3001);
  EXPECT_EQ(grid.start_time, 0.0);
  EXPECT_EQ(grid.step, 0.01);
  EXPECT_THAT(grid.remarks, IsEmpty());
  EXPECT_EQ(OnTimeGrid(table, 1, grid), table.values.col(1));
}

TEST(TimeColumnTest, RoundedTimesDoNotDetuneTheRate) {
  // The rounded differences alone would be off by up to 4e-4.
  for (const double rate : {120.0, 75.0, 300.0, 1024.0}) {
    const Table table = MakeTable(RoundedTimes(12001, rate, 5));
    const TimeGrid grid = Find(table);
    EXPECT_EQ(grid.num_samples(), 12001);
    EXPECT_NEAR(grid.step * rate, 1.0, 1e-15) << rate;
    EXPECT_EQ(OnTimeGrid(table, 1, grid), table.values.col(1));
  }
  const TimeGrid grid = Find(MakeTable(RoundedTimes(1000, 120.0, 5)));
  EXPECT_THAT(grid.remarks, ElementsAre(AllOf(HasSubstr("% of the step"),
                                              HasSubstr("120 samples per s"))));
}

TEST(TimeColumnTest, OtherUnitsAndStarts) {
  std::vector<double> milliseconds;
  for (int i = 0; i < 100; ++i) milliseconds.push_back(5000.0 + 20.0 * i);
  TimeColumnOptions options;
  options.factor = 1e-3;
  const TimeGrid grid = Find(MakeTable(milliseconds), options);
  EXPECT_DOUBLE_EQ(grid.start_time, 5.0);
  EXPECT_DOUBLE_EQ(grid.step, 0.02);
}

TEST(TimeColumnTest, EpochTimes) {
  // Seconds since 1970 leave a double 2e-7 s.
  std::vector<double> times;
  for (int i = 0; i < 5000; ++i) times.push_back(1.7e9 + 0.005 * i);
  const TimeGrid grid = Find(MakeTable(times));
  EXPECT_EQ(grid.num_samples(), 5000);
  EXPECT_NEAR(grid.step, 0.005, 1e-12);
}

TEST(TimeColumnTest, GapsBecomeMissingSamples) {
  std::vector<double> times = RoundedTimes(2000, 120.0, 5);
  times.erase(times.begin() + 500, times.begin() + 503);
  // Long enough that the rounded step alone would give a count wrong by two.
  times.erase(times.begin() + 700, times.begin() + 1696);
  const Table table = MakeTable(times);
  const TimeGrid grid = Find(table);
  ASSERT_EQ(grid.num_samples(), 2000);
  const Vector values = OnTimeGrid(table, 1, grid);
  for (int i = 0; i < 2000; ++i) {
    const bool missing = (i >= 500 && i < 503) || (i >= 703 && i < 1699);
    EXPECT_EQ(std::isnan(values[i]), missing) << i;
    if (!missing) {
      EXPECT_NEAR(values[i], i / 120.0, 1e-5);
    }
  }
  ASSERT_EQ(grid.remarks.size(), 3u);
  EXPECT_THAT(grid.remarks[1],
              AllOf(StartsWith("3 samples are missing from 4.1666"),
                    HasSubstr("to 4.1833"), HasSubstr("lines 501 and 502")));
  EXPECT_THAT(grid.remarks[2], StartsWith("996 samples are missing"));
}

TEST(TimeColumnTest, ManyGapsAreSummedUp) {
  std::vector<double> times;
  for (int i = 0; i < 400; ++i) {
    if (i % 10 != 5) times.push_back(0.01 * i);
  }
  const TimeGrid grid = Find(MakeTable(times));
  EXPECT_THAT(grid.remarks.back(),
              HasSubstr("40 samples are missing in 40 gaps"));
  EXPECT_LT(grid.remarks.size(), 15u);
}

TEST(TimeColumnTest, RepeatedRowsAreDropped) {
  const Table table = MakeTable({0.0, 0.1, 0.1, 0.2, 0.3, 0.3, 0.3, 0.4});
  const TimeGrid grid = Find(table);
  EXPECT_EQ(grid.num_samples(), 5);
  EXPECT_NEAR(grid.step, 0.1, 1e-15);
  EXPECT_THAT(grid.remarks, ElementsAre(AllOf(StartsWith("3 rows repeat"),
                                              HasSubstr("(lines 4, 7, 8)"))));
  EXPECT_EQ(OnTimeGrid(table, 1, grid)[3], 0.3);

  // Two missing values count as the same value too.
  Table missing = MakeTable({0.0, 0.1, 0.1, 0.2});
  missing.values(1, 1) = missing.values(2, 1) = kNaN;
  EXPECT_TRUE(std::isnan(OnTimeGrid(missing, 1, Find(missing))[1]));
}

TEST(TimeColumnTest, RefusesWhatIsNoTime) {
  EXPECT_THAT(Refusal(MakeTable({})), HasSubstr("has 0 sample"));
  EXPECT_THAT(Refusal(MakeTable({1.0})), HasSubstr("has 1 sample"));
  EXPECT_THAT(Refusal(MakeTable({1.0, 1.0})), HasSubstr("has 1 sample"));
  EXPECT_THAT(Refusal(MakeTable({0.0, 0.1, kNaN, 0.3})),
              StartsWith("r.csv:4: column 't': the time is missing"));
  EXPECT_THAT(Refusal(MakeTable({kNaN, 0.1})), StartsWith("r.csv:2: "));
  EXPECT_THAT(Refusal(MakeTable({0.0, 0.1, 0.2, 0.15, 0.3})),
              StartsWith("r.csv:5: column 't': time decreases from 0.2 to "
                         "0.15 s"));
  Table twice = MakeTable({0.0, 0.1, 0.1, 0.2});
  twice.values(2, 1) = 7.0;
  EXPECT_THAT(Refusal(twice),
              AllOf(StartsWith("r.csv:4: time 0.1 s occurs again"),
                    HasSubstr("column 'a': 0.1 on line 3, 7 here")));
  EXPECT_THAT(Refusal(MakeTable({0.0, 0.01, 0.02, 1e9})),
              HasSubstr("has gaps"));
}

TEST(TimeColumnTest, RefusesIrregularAndDriftingClocks) {
  EXPECT_THAT(Refusal(MakeTable({0.0, 0.1, 0.2, 0.34, 0.4, 0.5, 0.6})),
              AllOf(StartsWith("r.csv:"), HasSubstr("irregular"),
                    HasSubstr("ask for resampling")));
  std::vector<double> drift;
  for (int i = 0; i < 1000; ++i) drift.push_back(0.01 * i * (1 + 1e-5 * i));
  EXPECT_THAT(Refusal(MakeTable(drift)), HasSubstr("step drifts"));
  // A restart after a time that is not a whole number of steps.
  std::vector<double> restart;
  for (int i = 0; i < 200; ++i) {
    restart.push_back(0.01 * i + (i < 100 ? 0.0 : 0.504));
  }
  EXPECT_THAT(Refusal(MakeTable(restart)), StartsWith("r.csv:102: "));
  // The caller sets the limit.
  TimeColumnOptions options;
  options.largest_jitter = 0.3;
  EXPECT_EQ(Find(MakeTable(restart), options).num_samples(), 250);
}

TEST(TimeColumnTest, InterpolatesIrregularRowsOnRequest) {
  TimeColumnOptions options;
  options.interpolate_irregular = true;
  // A drifting 100 Hz clock with a hole, and a missing value.
  std::vector<double> times;
  for (int i = 0; i < 1000; ++i) {
    if (i >= 400 && i < 420) continue;
    times.push_back(0.01 * i * (1 + 2e-5 * i) + 0.001 * std::sin(1.7 * i));
  }
  const auto wave = [](double t) { return std::sin(2.0 * kPi * 3.0 * t); };
  Table table = MakeTable(times, wave);
  table.values(700, 1) = kNaN;
  const TimeGrid grid = Find(table, options);
  EXPECT_THAT(grid.remarks[0], HasSubstr("sampling is irregular"));
  const Vector values = OnTimeGrid(table, 1, grid);
  const double last_time =
      grid.start_time + static_cast<double>(grid.num_samples() - 1) * grid.step;
  EXPECT_LE(last_time, times.back());
  EXPECT_GT(last_time, times.back() - grid.step);
  int missing = 0;
  for (int i = 0; i < grid.num_samples(); ++i) {
    const double t = grid.start_time + i * grid.step;
    const bool in_gap = t > times[399] && t < times[400];
    const bool near_missing = t > times[699] && t < times[701];
    if (std::isnan(values[i])) {
      ++missing;
      EXPECT_TRUE(in_gap || near_missing) << t;
    } else {
      EXPECT_FALSE(in_gap) << t;
      // Linear beside the hole, cubic elsewhere: errors of (w h)^2 / 8 and far
      // less.
      const bool linear = std::abs(t - times[399]) < 0.03 ||
                          std::abs(t - times[400]) < 0.03 ||
                          std::abs(t - times[700]) < 0.05 || t < 0.03 ||
                          t > times.back() - 0.03;
      EXPECT_NEAR(values[i], wave(t), linear ? 8e-3 : 1e-3) << t;
    }
  }
  EXPECT_GE(missing, 20);
  // Cubics are exact only to the order of their slopes, straight lines exactly.
  const Table line = MakeTable(times, [](double t) { return 2.0 - 3.0 * t; });
  const TimeGrid line_grid = Find(line, options);
  const Vector on_line = OnTimeGrid(line, 1, line_grid);
  for (int i = 0; i < line_grid.num_samples(); ++i) {
    if (std::isnan(on_line[i])) continue;
    EXPECT_NEAR(on_line[i],
                2.0 - 3.0 * (line_grid.start_time + i * line_grid.step), 1e-12);
  }
}

TEST(TimeColumnTest, FromARateAlone) {
  const Table table = MakeTable({5.0, 3.0, 4.0});
  TimeGrid grid;
  std::string error;
  ASSERT_TRUE(TimeGridFromStep(table, 0.25, &grid, &error)) << error;
  EXPECT_EQ(grid.start_time, 0.0);
  EXPECT_EQ(grid.step, 0.25);
  EXPECT_EQ(OnTimeGrid(table, 0, grid), table.values.col(0));
  EXPECT_FALSE(TimeGridFromStep(table, 0.0, &grid, &error));
  EXPECT_THAT(error, HasSubstr("expected a positive one"));
  EXPECT_FALSE(TimeGridFromStep(MakeTable({1.0}), 0.1, &grid, &error));
  EXPECT_THAT(error, HasSubstr("has 1 sample"));
}

class ShakeTableClockTest : public ::testing::TestWithParam<const char*> {};

TEST_P(ShakeTableClockTest, IsRegular) {
  PINODE_FIND_MEASURED_DATA(
      path, std::string("mini_shake_table/") + GetParam() + ".csv");
  Table table;
  std::string error;
  ASSERT_TRUE(ReadCsvTable(path, {"t_s", "floor3_ax"}, &table, &error))
      << error;
  TimeGrid grid;
  ASSERT_TRUE(FindTimeGrid(table, "t_s", {}, &grid, &error)) << error;
  // 120 Hz, written with five decimals.
  EXPECT_EQ(grid.step, 1.0 / 120.0);
  EXPECT_EQ(grid.num_samples(), table.num_rows());
  for (int i = 0; i < grid.num_samples(); ++i) {
    ASSERT_NEAR(grid.start_time + i * grid.step, table.values(i, 0), 5.1e-6);
  }
  EXPECT_EQ(OnTimeGrid(table, 1, grid), table.values.col(1));
}

INSTANTIATE_TEST_SUITE_P(
    MiniShakeTable, ShakeTableClockTest,
    ::testing::Values("stiff3story_northridge", "stiff3story_sine_1p0",
                      "stiff3story_sine_1p5", "flexible3story_northridge",
                      "flexible3story_sine_1p0", "flexible3story_sine_1p5"));

}  // namespace
}  // namespace pinode
