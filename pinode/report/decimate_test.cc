#include "pinode/report/decimate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pinode {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

int NumGaps(const Polyline& line) {
  return static_cast<int>(std::count_if(
      line.y.begin(), line.y.end(), [](double y) { return std::isnan(y); }));
}

TEST(DecimateHistory, KeepsEveryExtremeAndTheEnds) {
  const int size = 20000;
  const Vector x = Vector::LinSpaced(size, 0.0, 100.0);
  Vector y = (3.0 * x.array()).sin();
  // Spikes one sample wide, that picking every tenth sample would miss.
  y(7777) = 5.0;
  y(7778) = -6.0;
  y(13131) = 4.0;
  const Polyline line = DecimateHistory(x, y, 400);
  EXPECT_LE(line.x.size(), 802u);
  EXPECT_EQ(line.x.size(), line.y.size());
  for (const int i : {0, 7777, 7778, 13131, size - 1}) {
    const auto at = std::find(line.x.begin(), line.x.end(), x(i));
    ASSERT_NE(at, line.x.end()) << "sample " << i;
    EXPECT_EQ(line.y[static_cast<size_t>(at - line.x.begin())], y(i));
  }
  EXPECT_TRUE(std::is_sorted(line.x.begin(), line.x.end()));
  EXPECT_EQ(NumGaps(line), 0);
}

TEST(DecimateHistory, LeavesShortHistoriesWhole) {
  const Vector x = Vector::LinSpaced(50, 0.0, 4.9);
  const Vector y = x.array().cos();
  const Polyline line = DecimateHistory(x, y, 25);
  ASSERT_EQ(line.x.size(), 50u);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(line.y[static_cast<size_t>(i)], y(i));
}

TEST(DecimateHistory, KeepsAGapAGap) {
  const int size = 5000;
  const Vector x = Vector::LinSpaced(size, 0.0, 50.0);
  Vector y = x.array().sin();
  y.segment(2000, 300).setConstant(kNan);
  const Polyline line = DecimateHistory(x, y, 100);
  EXPECT_EQ(NumGaps(line), 1);
  // It also remains where a bucket spans it.
  y = x.array().sin();
  y.segment(2010, 5).setConstant(kNan);
  EXPECT_EQ(NumGaps(DecimateHistory(x, y, 100)), 1);
}

TEST(DecimateHistory, JoinsTheSamplesOfASlowerSensor) {
  const int size = 400;
  const Vector x = Vector::LinSpaced(size, 0.0, 4.0);
  Vector y = Vector::Constant(size, kNan);
  for (int i = 0; i < size; i += 4) y(i) = i;
  const Polyline line = DecimateHistory(x, y, 1000);
  EXPECT_EQ(line.x.size(), 100u);
  EXPECT_EQ(NumGaps(line), 0);
}

TEST(DecimateHistory, HasNothingToShowOfMissingValues) {
  EXPECT_TRUE(
      DecimateHistory(Vector::Zero(9), Vector::Constant(9, kNan), 3).x.empty());
  EXPECT_TRUE(DecimateHistory(Vector(), Vector(), 3).x.empty());
}

TEST(DecimateHistory, OfAUniformGrid) {
  const int size = 500;
  const Vector x = Vector::LinSpaced(size, 2.0, 2.0 + 0.25 * (size - 1));
  Matrix rows = Matrix::Random(3, size);
  rows(1, 250) = std::numeric_limits<double>::quiet_NaN();
  const Vector y = rows.row(1);
  const Polyline expected = DecimateHistory(x, y, 40);
  const Polyline line = DecimateHistory(2.0, 0.25, rows.row(1).transpose(), 40);
  EXPECT_EQ(line.x, expected.x);
  EXPECT_EQ(line.y, expected.y);
}

}  // namespace
}  // namespace pinode
