#include "pinode/record/prepare.h"

#include <cmath>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

Vector Make(std::initializer_list<double> values) {
  Vector result(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double value : values) result[i++] = value;
  return result;
}

TEST(PrepareTest, RemovesTheOffset) {
  Vector values = Make({1.0, kNaN, 3.0});
  EXPECT_DOUBLE_EQ(RemoveOffset(&values), 2.0);
  EXPECT_DOUBLE_EQ(values[0], -1.0);
  EXPECT_TRUE(std::isnan(values[1]));
  Vector missing = Make({kNaN, kNaN});
  EXPECT_EQ(RemoveOffset(&missing), 0.0);
}

TEST(PrepareTest, FindsAndFillsGaps) {
  const Vector values = Make({kNaN, 1.0, kNaN, kNaN, 4.0, kNaN});
  const std::vector<Gap> gaps = FindGaps(values);
  ASSERT_EQ(gaps.size(), 3u);
  EXPECT_EQ(gaps[1].first, 2);
  EXPECT_EQ(gaps[1].size, 2);
  EXPECT_EQ(gaps[2].first, 5);
  Vector filled = FillMissing(values);
  EXPECT_LT((filled - Make({1.0, 1.0, 2.0, 3.0, 4.0, 4.0})).norm(), 1e-14);
  CopyMissing(values, &filled);
  EXPECT_EQ(FindGaps(filled).size(), 3u);
  EXPECT_EQ(filled[4], 4.0);
  EXPECT_TRUE(FindGaps(Make({1.0, 2.0})).empty());
}

TEST(PrepareTest, ConvertsUnitsAndSigns) {
  Channel channel = {"ag", "g", Make({1.0, kNaN, -0.5})};
  std::string error;
  ASSERT_TRUE(ConvertChannel(Dimension::kAcceleration, UnitSystem(), -1,
                             &channel, &error))
      << error;
  EXPECT_EQ(channel.unit, "m/s^2");
  EXPECT_DOUBLE_EQ(channel.values[0], -9.80665);
  EXPECT_TRUE(std::isnan(channel.values[1]));
  EXPECT_DOUBLE_EQ(channel.values[2], 4.903325);
  EXPECT_FALSE(
      ConvertChannel(Dimension::kForce, UnitSystem(), 1, &channel, &error));
  EXPECT_THAT(error, HasSubstr("channel 'ag': unit 'm/s^2' is that of an "
                               "acceleration, expected that of a force"));
  EXPECT_EQ(channel.unit, "m/s^2");
}

Record MakeRecord() {
  Record record;
  record.name = "r";
  record.start_time = 1.0;
  record.sampling_step = 0.1;
  record.channels = {{"a", "m", Vector::LinSpaced(101, 0.0, 100.0)}};
  return record;
}

TEST(PrepareTest, SelectsAWindow) {
  const Record record = MakeRecord();
  Record window;
  std::string error;
  ASSERT_TRUE(SelectWindow(record, 1.3, 2.0, &window, &error)) << error;
  EXPECT_EQ(window.name, "r");
  EXPECT_DOUBLE_EQ(window.start_time, 1.3);
  EXPECT_EQ(window.num_samples(), 8);
  EXPECT_EQ(window.channels[0].values[0], 3.0);
  // A window between samples contains the samples inside.
  ASSERT_TRUE(SelectWindow(record, 1.31, 1.99, &window, &error)) << error;
  EXPECT_EQ(window.channels[0].values, Make({4, 5, 6, 7, 8, 9}));
  // The whole record, also as [start, number of samples * step].
  ASSERT_TRUE(SelectWindow(record, 1.0, 11.1, &window, &error)) << error;
  EXPECT_EQ(window.num_samples(), 101);
  // In place.
  Record in_place = record;
  ASSERT_TRUE(SelectWindow(in_place, 2.0, 3.0, &in_place, &error)) << error;
  EXPECT_EQ(in_place.num_samples(), 11);
}

TEST(PrepareTest, RefusesBadWindows) {
  const Record record = MakeRecord();
  Record window;
  std::string error;
  EXPECT_FALSE(SelectWindow(record, 3.0, 2.0, &window, &error));
  EXPECT_THAT(error, HasSubstr("window [3, 2] is empty"));
  EXPECT_FALSE(SelectWindow(record, 1.0, 12.0, &window, &error));
  EXPECT_THAT(error, HasSubstr("lasts from 1 to 11"));
  EXPECT_FALSE(SelectWindow(record, 0.0, 5.0, &window, &error));
  EXPECT_FALSE(SelectWindow(record, 2.01, 2.15, &window, &error));
  EXPECT_THAT(error, HasSubstr("fewer than two samples"));
  EXPECT_FALSE(SelectWindow(record, kNaN, 2.0, &window, &error));
  EXPECT_EQ(window.num_samples(), 0);
}

}  // namespace
}  // namespace pinode
