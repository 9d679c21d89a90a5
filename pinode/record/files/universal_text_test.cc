#include "pinode/record/files/universal_text.h"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>

#include "gtest/gtest.h"

namespace pinode {
namespace {

TEST(UniversalTextTest, NumbersTakeTheirColumnsAndAPoint) {
  EXPECT_EQ(UniversalNumber(0.0, 13), "           0.");
  EXPECT_EQ(UniversalNumber(-1.0, 13), "          -1.");
  EXPECT_EQ(UniversalNumber(0.01, 13), "         0.01");
  EXPECT_EQ(UniversalNumber(1e22, 13), "        1.e22");
  EXPECT_EQ(UniversalNumber(1.0 / 3.0, 13), " 0.3333333333");
  EXPECT_EQ(UniversalNumber(-1.0 / 3.0, 13), " -0.333333333");
  EXPECT_EQ(UniversalNumber(-200.0 / 3.0, 13), " -66.66666667");
  EXPECT_EQ(UniversalNumber(2e-7 / 3.0, 13), " 6.6666667e-8");
  EXPECT_EQ(UniversalNumber(-2e-100 / 3.0, 13), " -6.6667e-101");
  // Rounded up to one digit more.
  EXPECT_EQ(UniversalNumber(9.99999999999999, 13), " 10.000000000");
}

TEST(UniversalTextTest, NumbersAreNear) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> exponent(-307.0, 307.0);
  std::uniform_real_distribution<double> small(-10.0, 10.0);
  for (int i = 0; i < 20000; ++i) {
    const double any =
        std::pow(10.0, exponent(random)) * (i % 2 == 0 ? 1.0 : -1.0);
    const double usual = small(random);
    for (const double value : {any, usual}) {
      for (const size_t width : {13u, 20u, 25u}) {
        const std::string text = UniversalNumber(value, width);
        ASSERT_EQ(text.size(), width) << value;
        ASSERT_EQ(text[0], ' ') << value;
        ASSERT_NE(text.find('.'), std::string::npos) << value;
        const double error =
            std::abs(std::strtod(text.c_str(), nullptr) - value);
        ASSERT_LE(error, width == 25   ? 0.0
                         : width == 20 ? 5e-12 * std::abs(value)
                                       : 5e-5 * std::abs(value))
            << text;
        if (width == 13 && value == usual) {
          ASSERT_LE(error, 5.0001e-10) << text;
        }
      }
    }
    const double large = std::pow(10.0, std::abs(usual) * 0.8 + 1.0);
    ASSERT_LE(
        std::abs(std::strtod(UniversalNumber(-large, 13).c_str(), nullptr) +
                 large),
        5e-10 * large);
  }
}

TEST(UniversalTextTest, WhatIsNoNumberStaysSo) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(UniversalNumber(nan, 13).size(), 13u);
  EXPECT_TRUE(
      std::isnan(std::strtod(UniversalNumber(nan, 13).c_str(), nullptr)));
}

}  // namespace
}  // namespace pinode
