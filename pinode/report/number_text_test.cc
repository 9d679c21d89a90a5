#include "pinode/report/number_text.h"

#include <gtest/gtest.h>

#include <limits>

namespace pinode {
namespace {

TEST(ReadableNumber, ShowsSignificantDigitsWithoutNeedlessExponents) {
  EXPECT_EQ(ReadableNumber(3.14159265), "3.142");
  EXPECT_EQ(ReadableNumber(-0.00123456, 3), "-0.00123");
  EXPECT_EQ(ReadableNumber(4001234.4), "4001234");
  EXPECT_EQ(ReadableNumber(2.5e9, 3), "2.50e+09");
  EXPECT_EQ(ReadableNumber(5.6251e-6, 3), "5.63e-06");
  EXPECT_EQ(ReadableNumber(0.99999), "1.000");
  EXPECT_EQ(ReadableNumber(-99.996), "-100.0");
  EXPECT_EQ(ReadableNumber(0.9999), "0.9999");
  EXPECT_EQ(ReadableNumber(0.0), "0");
  EXPECT_EQ(ReadableNumber(std::numeric_limits<double>::quiet_NaN()), "-");
  EXPECT_EQ(ReadableNumber(std::numeric_limits<double>::infinity()), "-");
}

TEST(FormatEstimate, GivesTheDecimalsThatTheIntervalJustifies) {
  const EstimateText text = FormatEstimate(10.0, 10.02345, 0.00123);
  EXPECT_EQ(text.initial, "10.0000");
  EXPECT_EQ(text.value, "10.0235");
  EXPECT_EQ(text.half_width, "0.0012");
  EXPECT_EQ(FormatEstimate(0.0, 3.2, 4500.0).value, "3");
  EXPECT_EQ(FormatEstimate(0.0, 3.2, 4500.0).initial, "0");
}

TEST(FormatEstimate, SharesOneExponent) {
  const EstimateText small = FormatEstimate(5e-6, 5.6251e-6, 2.3e-9);
  EXPECT_EQ(small.initial, "5.0000e-06");
  EXPECT_EQ(small.value, "5.6251e-06");
  EXPECT_EQ(small.half_width, "0.0023e-06");
  const EstimateText large = FormatEstimate(1e9, -6.1234e11, 4.5e9);
  EXPECT_EQ(large.value, "-6.123e+11");
  EXPECT_EQ(large.half_width, "0.045e+11");
}

TEST(FormatEstimate, SurvivesMissingAndTinyIntervals) {
  EXPECT_EQ(FormatEstimate(1.0, 2.0, 0.0).half_width, "");
  EXPECT_EQ(FormatEstimate(1.0, 2.0, 0.0).value, "2.0000");
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(FormatEstimate(1.0, 2.0, infinity).half_width, "");
  const EstimateText sure = FormatEstimate(1.0, 2.0, 1e-15);
  EXPECT_EQ(sure.value, "2.00000000");
  EXPECT_EQ(sure.half_width, "1.0e-15");
  EXPECT_EQ(FormatEstimate(0.0, 0.0, 0.5).value, "0.00");
}

TEST(UnitText, WritesPowersAndProducts) {
  EXPECT_EQ(UnitText("m/s^2"), "m/s\u00b2");
  EXPECT_EQ(UnitText("N*s/m^3"), "N\u00b7s/m\u00b3");
  EXPECT_EQ(UnitText("1"), "");
}

TEST(Duration, IsReadable) {
  EXPECT_EQ(Duration(0.4213), "0.421 s");
  EXPECT_EQ(Duration(125.2), "2 min 05 s");
  EXPECT_EQ(Count(1, "sample") + ", " + Count(3, "sample"),
            "1 sample, 3 samples");
}

}  // namespace
}  // namespace pinode
