#include "pinode/record/number_rows.h"

#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Returns the number of characters that were taken; 0: none.
size_t Taken(const std::string& text, double* value, char decimal = '.') {
  const char* begin = text.data();
  const char* end =
      ParseSimpleNumber(begin, begin + text.size(), decimal, value);
  return end == nullptr ? 0 : static_cast<size_t>(end - begin);
}

TEST(NumberRowsTest, NumbersAreTheNearestDoubles) {
  std::mt19937 random(7);
  int simple = 0;
  for (int i = 0; i < 200000; ++i) {
    char text[64];
    const double value =
        std::ldexp(static_cast<double>(random()) - 2147483648.0,
                   static_cast<int>(random() % 60) - 50);
    std::snprintf(text, sizeof text, "%.*f", static_cast<int>(random() % 16),
                  value);
    double expected = 0.0;
    ASSERT_TRUE(ParseDouble(text, &expected));
    double found = 0.0;
    const size_t taken = Taken(text, &found);
    if (taken == 0) continue;
    ++simple;
    EXPECT_EQ(taken, std::string(text).size());
    EXPECT_EQ(found, expected) << text;
    EXPECT_EQ(std::signbit(found), std::signbit(expected)) << text;
  }
  // Others have more than 19 digits, or a mantissa of more than 53 bits.
  EXPECT_GT(simple, 120000);
}

TEST(NumberRowsTest, Forms) {
  double value = 0.0;
  EXPECT_EQ(Taken("+.5;", &value), 3U);
  EXPECT_EQ(value, 0.5);
  EXPECT_EQ(Taken("-12,25", &value, ','), 6U);
  EXPECT_EQ(value, -12.25);
  EXPECT_EQ(Taken("12,25", &value), 2U);
  EXPECT_EQ(Taken("9007199254740992", &value), 16U);
  EXPECT_EQ(value, 9007199254740992.0);
  for (const char* other : {"", "-", ".", "+.", "5.", "x", "nan", " 1",
                            "9007199254740993", "0.00000000000000000001",
                            "99999999999999999999999999999999999999999"}) {
    EXPECT_EQ(Taken(other, &value), 0U) << other;
  }
}

TEST(NumberRowsTest, Rows) {
  // The second cell is passed over; columns are two values apart.
  const NumberRow row(';', ',', {1, -1, 0});
  std::vector<double> values(4, 0.0);
  ASSERT_TRUE(row.Parse("1,5; some text ;-2\r", values.data(), 2));
  EXPECT_EQ(values[2], 1.5);
  EXPECT_EQ(values[0], -2.0);
  EXPECT_TRUE(row.Parse(" 1,5 ;; 3 ", values.data(), 2));
  for (const char* other :
       {"", "1,5;x", "1,5;x;", "1,5;x;2;", "1.5;x;2", "1,5;\"x\";2", "1;x;2e3",
        "#1;x;2", "\"1\";x;2", "1;x;2 3", "nan;x;2"}) {
    EXPECT_FALSE(row.Parse(other, values.data(), 2)) << other;
  }
  // A row that is commented out is none, though its first cell is not wanted.
  EXPECT_FALSE(NumberRow(',', '.', {-1, 0}).Parse("#1,2", values.data(), 2));
  EXPECT_FALSE(NumberRow(',', '.', {-1, 0}).Parse(" # 1,2", values.data(), 2));
  EXPECT_TRUE(NumberRow(',', '.', {-1, 0}).Parse("a #1,2", values.data(), 2));
  const NumberRow blanks(' ', '.', {0, -1, 1});
  ASSERT_TRUE(blanks.Parse("  4  abc\t-5.5  ", values.data(), 1));
  EXPECT_EQ(values[0], 4.0);
  EXPECT_EQ(values[1], -5.5);
  for (const char* other : {"4 5", "4 5 6 7", "4,5 6 7", ""}) {
    EXPECT_FALSE(blanks.Parse(other, values.data(), 1)) << other;
  }
  const NumberRow tabs('\t', '.', {0, 1});
  ASSERT_TRUE(tabs.Parse("1\t 2", values.data(), 1));
  EXPECT_FALSE(tabs.Parse("1\t\t2", values.data(), 1));
}

}  // namespace
}  // namespace pinode
