#include "pinode/base/strings.h"

#include <clocale>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "gtest/gtest.h"

namespace pinode {
namespace {

TEST(NearestNameTest, FindsWhatWasMeant) {
  const std::vector<std::string> known = {"stiffness", "damping", "mass",
                                          "influence"};
  EXPECT_EQ(NearestName("stifness", known), "stiffness");
  EXPECT_EQ(NearestName("Damping", known), "damping");
  EXPECT_EQ(NearestName("msas", known), "mass");
  EXPECT_EQ(NearestName("influences", known), "influence");
  EXPECT_EQ(NearestName("temperature", known), "");
  EXPECT_EQ(NearestName("mass", {}), "");
  // The first of several equal names wins. A one-letter name is not a hint for
  // another.
  EXPECT_EQ(NearestName("u9", {"u1", "u2"}), "u1");
  EXPECT_EQ(NearestName("x", {"y"}), "");
}

TEST(NearestNameTest, Hints) {
  EXPECT_EQ(NameHint("u_1", {"u1", "u2"}), "; did you mean 'u1'?");
  EXPECT_EQ(NameHint("wind", {"u1", "u2"}), "; known are: u1, u2");
  EXPECT_EQ(NameHint("wind", {}), "");
}

TEST(ParseDoubleTest, ReadsNumbers) {
  const struct {
    const char* text;
    double value;
  } cases[] = {
      {"0", 0.0},        {"-1.5", -1.5},    {"+2", 2.0},
      {" 3\t\r\n", 3.0}, {".5", 0.5},       {"5.", 5.0},
      {"1e3", 1000.0},   {"1E+03", 1000.0}, {"-1.25D-2", -0.0125},
      {"2d0", 2.0},      {"1e-400", 0.0},   {"-.4486975E-03", -0.4486975e-3}};
  for (const auto& c : cases) {
    double value = 99.0;
    EXPECT_TRUE(ParseDouble(c.text, &value)) << c.text;
    EXPECT_EQ(value, c.value) << c.text;
  }
  double value = 0.0;
  EXPECT_TRUE(ParseDouble("NaN", &value));
  EXPECT_TRUE(std::isnan(value));
  EXPECT_TRUE(ParseDouble("-Inf", &value));
  EXPECT_EQ(value, -std::numeric_limits<double>::infinity());
}

TEST(ParseDoubleTest, RefusesTheRest) {
  for (const char* text :
       {"", " ", "abc", "1,5", "1.5x", "+-1", "++1", "+", "1 2", "0x10",
        "1e400", "1e", "--1", "d5", "1d2d3"}) {
    double value = 99.0;
    EXPECT_FALSE(ParseDouble(text, &value)) << text;
    EXPECT_EQ(value, 99.0) << text;
  }
}

TEST(ParseIntTest, WholeTextOnly) {
  int value = 0;
  EXPECT_TRUE(ParseInt(" +4096 ", &value));
  EXPECT_EQ(value, 4096);
  EXPECT_TRUE(ParseInt("-3", &value));
  EXPECT_EQ(value, -3);
  for (const char* text : {"", "4.0", "4a", "99999999999", "1 2"}) {
    EXPECT_FALSE(ParseInt(text, &value)) << text;
  }
  EXPECT_EQ(value, -3);
}

TEST(ParseIntTest, OfTheSizeAskedFor) {
  int value = 7;
  EXPECT_FALSE(ParseInt("5000000000", &value));
  EXPECT_EQ(value, 7);
  int64_t long_value = 0;
  EXPECT_TRUE(ParseInt("5000000000", &long_value));
  EXPECT_EQ(long_value, 5000000000);
  EXPECT_FALSE(ParseInt("9223372036854775808", &long_value));
}

TEST(FormatNumberTest, RoundTripsAndIsPlain) {
  EXPECT_EQ(FormatNumber(0.1), "0.1");
  EXPECT_EQ(FormatNumber(-2.0), "-2");
  EXPECT_EQ(FormatNumber(1.0 / 3.0, 4), "0.3333");
  EXPECT_EQ(FormatNumber(0.1, 17), "0.10000000000000001");
  EXPECT_EQ(FormatNumber(1e22, 3), "1e+22");
  EXPECT_EQ(FormatNumber(std::nan("")), "nan");
  for (const double value :
       {1.0 / 3.0, -4.9406564584124654e-324, std::numeric_limits<double>::max(),
        6.02214076e23, 0.0083333333}) {
    for (const int digits : {0, 17}) {
      double parsed = 0.0;
      ASSERT_TRUE(ParseDouble(FormatNumber(value, digits), &parsed));
      EXPECT_EQ(parsed, value);
    }
  }
}

TEST(ReplaceAllTest, LeavesWhatItPutsIn) {
  std::string text = "a*b**";
  ReplaceAll("*", "**", &text);
  EXPECT_EQ(text, "a**b****");
  ReplaceAll("a", "", &text);
  ReplaceAll("none", "x", &text);
  EXPECT_EQ(text, "**b****");
}

TEST(JoinTest, JoinsAndStrips) {
  EXPECT_EQ(Join({}, ", "), "");
  EXPECT_EQ(Join({"a"}, ", "), "a");
  EXPECT_EQ(Join({"a", "", "c"}, ", "), "a, , c");
  EXPECT_EQ(StripBlanks(" \t a b\r\n"), "a b");
  EXPECT_EQ(StripBlanks(" \n"), "");
}

}  // namespace
}  // namespace pinode
