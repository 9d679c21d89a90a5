#include "pinode/record/column_scales.h"

#include <cmath>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

TEST(ColumnScalesTest, OneForAll) {
  ColumnScales scales;
  std::string error;
  EXPECT_EQ(scales.FactorOf("a"), 1.0);
  ASSERT_TRUE(scales.Parse("-0.001", &error)) << error;
  EXPECT_EQ(scales.FactorOf("a"), -0.001);
  EXPECT_TRUE(scales.AreOf({}, &error));
  ASSERT_TRUE(scales.Parse("", &error)) << error;
  EXPECT_EQ(scales.FactorOf("a"), 1.0);
}

TEST(ColumnScalesTest, OneForEach) {
  ColumnScales scales;
  std::string error;
  ASSERT_TRUE(scales.Parse("a=2, b [mg]=3e-3,c=d=4", &error)) << error;
  EXPECT_EQ(scales.FactorOf("a"), 2.0);
  EXPECT_EQ(scales.FactorOf("b"), 1.0);
  EXPECT_EQ(scales.FactorOf("b [mg]", "b"), 3e-3);
  EXPECT_EQ(scales.FactorOf("a [mg]", "a"), 2.0);
  EXPECT_EQ(scales.FactorOf("c=d"), 4.0);
  EXPECT_TRUE(scales.AreOf({"c=d", "b [mg]", "a", "e"}, &error));
  EXPECT_FALSE(scales.AreOf({"c=d", "b [mg]", "aa"}, &error));
  EXPECT_THAT(error, HasSubstr("no channel 'a'"));
}

TEST(ColumnScalesTest, NumbersInPlaceOfText) {
  ColumnScales scales;
  std::string error;
  ASSERT_TRUE(scales.Set(2.0, {{"a,b", -3.0}}, &error)) << error;
  EXPECT_EQ(scales.FactorOf("a,b"), -3.0);
  EXPECT_EQ(scales.FactorOf("c"), 2.0);
  EXPECT_FALSE(scales.Set(0.0, {}, &error));
  EXPECT_FALSE(scales.Set(1.0, {{"a", std::nan("")}}, &error));
  EXPECT_THAT(error, HasSubstr("not finite"));
  // Factors that were set before stay.
  EXPECT_EQ(scales.FactorOf("c"), 2.0);
}

TEST(ColumnScalesTest, RefusesWhatIsNoFactor) {
  ColumnScales scales;
  std::string error;
  for (const char* text : {"0", "nan", "inf", "x", "a=", "=2", "a=2,3", "0,5",
                           "a=0", "a=1,b", "a=2,"}) {
    EXPECT_FALSE(scales.Parse(text, &error)) << text;
    EXPECT_THAT(error, HasSubstr("expected one factor for all columns"));
  }
  EXPECT_FALSE(scales.Parse("a=2,a=3", &error));
  EXPECT_THAT(error, HasSubstr("'a' is named twice"));
}

}  // namespace
}  // namespace pinode
