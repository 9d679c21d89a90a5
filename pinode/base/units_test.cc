#include "pinode/base/units.h"

#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

double Factor(const std::string& unit, Dimension dimension,
              const UnitSystem& system) {
  double factor = 0.0;
  std::string error;
  EXPECT_TRUE(UnitFactor(unit, dimension, system, &factor, &error)) << error;
  return factor;
}

TEST(UnitsTest, Converts) {
  const UnitSystem si;
  EXPECT_EQ(Factor("g", Dimension::kAcceleration, si), 9.80665);
  EXPECT_DOUBLE_EQ(Factor("gal", Dimension::kAcceleration, si), 0.01);
  EXPECT_DOUBLE_EQ(Factor("ft/s^2", Dimension::kAcceleration, si), 0.3048);
  EXPECT_DOUBLE_EQ(Factor("mm/ms", Dimension::kVelocity, si), 1.0);
  EXPECT_DOUBLE_EQ(Factor("kip", Dimension::kForce, si), 4448.2216152605);
  EXPECT_EQ(Factor("1", Dimension::kNumber, si), 1.0);
  EXPECT_EQ(Factor("um/m", Dimension::kNumber, si), 1e-6);
  EXPECT_EQ(Factor("%", Dimension::kNumber, si), 1e-2);
  EXPECT_EQ(Factor("mV", Dimension::kVoltage, si), 1e-3);

  const UnitSystem us = {"lbf", "in", "s"};
  EXPECT_NEAR(Factor("g", Dimension::kAcceleration, us), 386.0886, 1e-4);
  EXPECT_DOUBLE_EQ(Factor("ft", Dimension::kLength, us), 12.0);
  EXPECT_DOUBLE_EQ(Factor("kip", Dimension::kForce, us), 1000.0);

  const UnitSystem fast = {"kN", "mm", "ms"};
  EXPECT_DOUBLE_EQ(Factor("s", Dimension::kTime, fast), 1000.0);
  EXPECT_DOUBLE_EQ(Factor("m/s^2", Dimension::kAcceleration, fast), 1e-3);
}

TEST(UnitsTest, TheModelsOwnUnitsAreOne) {
  for (const char* force : {"N", "kN", "MN", "lbf", "kip"}) {
    for (const char* length : {"m", "cm", "mm", "in", "ft"}) {
      for (const char* time : {"s", "ms", "us"}) {
        const UnitSystem system = {force, length, time};
        std::string error;
        ASSERT_TRUE(system.IsValid(&error)) << error;
        for (const Dimension dimension :
             {Dimension::kNumber, Dimension::kTime, Dimension::kLength,
              Dimension::kVelocity, Dimension::kAcceleration, Dimension::kForce,
              Dimension::kVoltage}) {
          EXPECT_EQ(Factor(UnitName(dimension, system), dimension, system),
                    1.0);
          // Every documented unit converts.
          for (const std::string& unit : KnownUnits(dimension)) {
            EXPECT_GT(Factor(unit, dimension, system), 0.0) << unit;
          }
        }
      }
    }
  }
}

TEST(UnitsTest, NamesOfDerivedUnits) {
  EXPECT_EQ(UnitName(Dimension::kAcceleration, UnitSystem()), "m/s^2");
  EXPECT_EQ(StiffnessUnitName(UnitSystem()), "N/m");
  EXPECT_EQ(DampingUnitName(UnitSystem()), "N*s/m");
  EXPECT_EQ(MassUnitName(UnitSystem()), "kg");
  EXPECT_EQ(MassUnitName({"kip", "in", "s"}), "kip*s^2/in");
}

TEST(UnitsTest, SaysWhatIsWrong) {
  const UnitSystem si;
  double factor = 7.0;
  std::string error;
  EXPECT_FALSE(UnitFactor("kN", Dimension::kAcceleration, si, &factor, &error));
  EXPECT_THAT(error, HasSubstr("'kN' is that of a force"));
  EXPECT_THAT(error, HasSubstr("expected that of an acceleration"));
  EXPECT_FALSE(
      UnitFactor("m/s^3", Dimension::kAcceleration, si, &factor, &error));
  EXPECT_THAT(error, HasSubstr("'m/s^3' is not known"));
  EXPECT_THAT(error, HasSubstr("did you mean 'm/s^2'?"));
  EXPECT_FALSE(UnitFactor("", Dimension::kForce, si, &factor, &error));
  EXPECT_EQ(factor, 7.0);

  UnitSystem bad;
  bad.length = "km";
  EXPECT_FALSE(bad.IsValid(&error));
  EXPECT_THAT(error, HasSubstr("'km' is not known, expected that of a length"));
  bad = UnitSystem();
  bad.time = "m";
  EXPECT_FALSE(bad.IsValid(&error));
  EXPECT_THAT(error, HasSubstr("'m' is that of a length"));
}

// The page on case files lists the units of the table, and no others.
TEST(UnitsTest, AreDocumented) {
  std::ifstream file(std::string(PINODE_SOURCE_DIR) + "/pinode/case/README.md");
  const std::string page((std::istreambuf_iterator<char>(file)),
                         std::istreambuf_iterator<char>());
  const size_t begin = page.find("\n## Units\n");
  ASSERT_NE(begin, std::string::npos);
  const std::string section =
      page.substr(begin, page.find("Usual spellings", begin) - begin);
  // Words between backticks.
  std::set<std::string> listed;
  bool inside = false;
  std::string word;
  for (const char c : section) {
    if (c == '`' || (inside && c == ' ')) {
      if (inside && !word.empty()) listed.insert(word);
      word.clear();
      if (c == '`') inside = !inside;
    } else if (inside) {
      word += c;
    }
  }
  for (const char* name : {"model", "length/time", "length/time^2"}) {
    EXPECT_EQ(listed.erase(name), 1u) << name;
  }
  std::set<std::string> known;
  for (const Dimension dimension :
       {Dimension::kNumber, Dimension::kTime, Dimension::kLength,
        Dimension::kAcceleration, Dimension::kForce, Dimension::kVoltage}) {
    for (const std::string& unit : KnownUnits(dimension)) {
      const bool composed = dimension == Dimension::kAcceleration &&
                            unit.find('/') != std::string::npos;
      if (!composed) known.insert(unit);
    }
  }
  EXPECT_EQ(listed, known);
}

}  // namespace
}  // namespace pinode
