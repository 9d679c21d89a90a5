#include "pinode/case/draft/floor_weights.h"

#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

FloorMasses Parsed(const std::string& text, int storeys) {
  FloorMasses masses;
  std::string error;
  EXPECT_TRUE(ParseFloorWeights(text, storeys, &masses, &error)) << error;
  return masses;
}

TEST(FloorWeightsTest, WeightsAndMassesAreTheSameFloor) {
  // 980.665 kN weigh as much as 100 t.
  for (const char* text :
       {"980.665 kN", "980665N", "0.980665 MN", "100 t", "1e5 kg", "1e5kgf",
        "100,100, 100 t", "980.665, 980665 N, 100000 kg"}) {
    const FloorMasses masses = Parsed(text, 3);
    // In the unit of mass of its own system.
    const double tonne = masses.units.force == "kN" ? 1.0 : 1000.0;
    ASSERT_EQ(masses.masses.size(), 3u) << text;
    EXPECT_NEAR(masses.masses[2], 100.0 * tonne, 1e-9 * tonne) << text;
    EXPECT_EQ(masses.units.length, "m") << text;
  }
  const FloorMasses kips = Parsed("386.0886 kip", 1);
  EXPECT_EQ(kips.units.force, "kip");
  EXPECT_EQ(kips.units.length, "in");
  EXPECT_NEAR(kips.masses[0], 1.0, 1e-6);  // kip s^2 / in
  EXPECT_NEAR(Parsed("386088.6 lbs", 1).masses[0], 1.0, 1e-6);
  EXPECT_NEAR(Parsed("386088.6 lb", 1).masses[0], 1.0, 1e-6);
}

TEST(FloorWeightsTest, UnitServesValuesBeforeIt) {
  const FloorMasses masses = Parsed("10, 20, 30 t, 5000 kg", 4);
  EXPECT_EQ(masses.masses, (std::vector<double>{10.0, 20.0, 30.0, 5.0}));
}

TEST(FloorWeightsTest, RefusesWhatIsNotClear) {
  const std::pair<const char*, const char*> trials[] = {
      {"900", "900 has no unit"},
      {"900, 800", "has no unit"},
      {"900 kN, 800 kN", "2 values, the building has 3 storeys"},
      {"900 tons", "several meanings"},
      {"900 m", "not a unit of weight or mass"},
      {"-900 kN", "positive"},
      {"0 kN", "positive"},
      {"nan kN", "not a number"},
      {"1e400 kN", "not a number"},
      {"kN", "not a number"},
      {"900 kN,", "not a number"},
      {"4;5 kN", "not a unit"}};
  for (const auto& [text, message] : trials) {
    FloorMasses masses;
    std::string error;
    EXPECT_FALSE(ParseFloorWeights(text, 3, &masses, &error)) << text;
    EXPECT_THAT(error, AllOf(HasSubstr("--weights"), HasSubstr(message)));
    EXPECT_TRUE(masses.masses.empty());
  }
}

TEST(FloorWeightsTest, Stiffnesses) {
  UnitSystem units;
  units.force = "kN";
  std::vector<double> stiffnesses;
  std::string error;
  ASSERT_TRUE(ParseStoreyStiffnesses("150 kN/mm, 2e8 N/m", 2, units,
                                     &stiffnesses, &error))
      << error;
  EXPECT_NEAR(stiffnesses[0], 150000.0, 1e-6);
  EXPECT_NEAR(stiffnesses[1], 200000.0, 1e-6);
  for (const char* text : {"150 kN", "150", "150 mm/kN", "1 kN/m, 2 kN/m, 3"}) {
    EXPECT_FALSE(ParseStoreyStiffnesses(text, 2, units, &stiffnesses, &error))
        << text;
    EXPECT_THAT(error, HasSubstr("--stiffness"));
  }
}

}  // namespace
}  // namespace pinode
