#include "pinode/base/unit_names.h"

#include <string>
#include <utility>
#include <vector>

#include "gtest/gtest.h"

namespace pinode {
namespace {

TEST(UnitNamesTest, KnowsTheTableAndItsOtherNames) {
  const std::vector<std::pair<std::string, std::string>> names = {
      {"mg", "mg"},
      {"g", "g"},
      {"G", "g"},
      {"Gal", "gal"},
      {"mGal", "mgal"},
      {"m/s2", "m/s^2"},
      {"m/s\xC2\xB2", "m/s^2"},
      {"mm/sec^2", "mm/s^2"},
      {"mm/s/s", "mm/s^2"},
      {"m/(s^2)", "m/s^2"},
      {"m*s^-2", "m/s^2"},
      {"in/sec2", "in/s^2"},
      {"m/s**2", "m/s^2"},
      {"mm / s", "mm/s"},
      {"ips", "in/s"},
      {"in.", "in"},
      {"g's", "g"},
      {"milli-g", "mg"},
      {"milligal", "mgal"},
      {"m s-2", "m/s^2"},
      {"ms\u207B\u00B2", "m/s^2"},
      {"Sek.", "s"},
      {"millis", "ms"},
      {"micros", "us"},
      {"Sec", "s"},
      {"S", "s"},
      {"msec", "ms"},
      {"\xC2\xB5s", "us"},
      {"\xCE\xBCs", "us"},
      {"\xC2\xB5m/m", "um/m"},
      {"\xC2\xB5\xCE\xB5", "microstrain"},
      {"Volts", "V"},
      {"mV", "mV"},
      {"kN", "kN"},
      {"MN", "MN"},
      {"lbs", "lbf"},
      {"kips", "kip"},
      {"inches", "in"},
      {"m/m", "1"},
      {"%", "%"}};
  for (const auto& [text, unit] : names) {
    EXPECT_EQ(CanonicalUnit(text), unit) << text;
  }
}

TEST(UnitNamesTest, TakesNothingElseForAUnit) {
  for (const char* text : {"", "Hz", "top", "a", "x/y", "m/s^3", "mN", "MG",
                           "ch1", "s^2", "deg", "m/", "/s", "km", "N/m"}) {
    EXPECT_EQ(CanonicalUnit(text), "") << text;
  }
}

TEST(UnitNamesTest, SplitsNames) {
  struct Case {
    const char* text;
    const char* name;
    const char* unit;
  };
  for (const Case& c :
       {Case{"acc [mg]", "acc", "mg"}, Case{"acc(mg)", "acc", "mg"},
        Case{"a / (m/s^2)", "a", "m/s^2"}, Case{"t / s", "t", "s"},
        Case{"Zeit in ms", "Zeit", "ms"}, Case{"CH3 #3 [mg]", "CH3 #3", "mg"},
        Case{"[mg]", "[mg]", "mg"}, Case{"acc (top)", "acc (top)", ""},
        Case{"acc (1)", "acc (1)", ""},
        Case{"Sample rate [Hz]", "Sample rate [Hz]", ""}, Case{"in", "in", ""},
        Case{"", "", ""}}) {
    std::string name;
    std::string unit;
    SplitUnitOfName(c.text, &name, &unit);
    EXPECT_EQ(name, c.name) << c.text;
    EXPECT_EQ(unit, c.unit) << c.text;
  }
}

TEST(UnitNamesTest, KnowsSymbolsInOtherScripts) {
  for (const auto& [text, unit] :
       {std::pair("м/с²", "m/s^2"), std::pair("м/с^2", "m/s^2"),
        std::pair("м/с2", "m/s^2"), std::pair("мм/с", "mm/s"),
        std::pair("мм", "mm"), std::pair("мкм", "um"), std::pair("с", "s"),
        std::pair("мс", "ms"), std::pair("Гал", "gal"), std::pair("кН", "kN"),
        std::pair("МН", "MN"), std::pair("毫米", "mm"), std::pair("秒", "s"),
        std::pair("초", "s"), std::pair("㎨", "m/s^2")}) {
    EXPECT_EQ(CanonicalUnit(text), unit) << text;
  }
  // Millinewton is not in the table, and "г" is a gram.
  EXPECT_EQ(CanonicalUnit("мН"), "");
  EXPECT_EQ(CanonicalUnit("г"), "");
  std::string name;
  std::string unit;
  // Directions: upwards or to the east, and downwards.
  for (const char* direction : {"Ускорение, В", "Ускорение, Н "}) {
    SplitUnitOfName(direction, &name, &unit);
    EXPECT_EQ(unit, "") << direction;
  }
  SplitUnitOfName("Сила, кН", &name, &unit);
  EXPECT_EQ(unit, "kN");
  SplitUnitOfName("Напряжение [В]", &name, &unit);
  EXPECT_EQ(unit, "V");
  SplitUnitOfName("Время (ч)", &name, &unit);
  EXPECT_EQ(unit, "h");
  SplitUnitOfName("Ускорение, м/с²", &name, &unit);
  EXPECT_EQ(name, "Ускорение");
  EXPECT_EQ(unit, "m/s^2");
  // A direction, North.
  SplitUnitOfName("acc, N", &name, &unit);
  EXPECT_EQ(name, "acc, N");
  EXPECT_EQ(unit, "");
}

// A factor of 1000 lies between g and mg.
TEST(UnitNamesTest, FactorsOfLoggerUnits) {
  const UnitSystem si;
  double factor = 0.0;
  std::string error;
  for (const auto& [unit, expected] :
       {std::pair("mg", 9.80665e-3), std::pair("ug", 9.80665e-6),
        std::pair("mm/s2", 1e-3), std::pair("Gal", 1e-2),
        std::pair("mgal", 1e-5)}) {
    ASSERT_TRUE(UnitFactor(unit, Dimension::kAcceleration, si, &factor, &error))
        << error;
    EXPECT_NEAR(factor, expected, 1e-12) << unit;
  }
  ASSERT_TRUE(UnitFactor("min", Dimension::kTime, si, &factor, &error));
  EXPECT_EQ(factor, 60.0);
  UnitSystem minutes;
  minutes.time = "min";
  EXPECT_FALSE(minutes.IsValid(&error));
}

}  // namespace
}  // namespace pinode
