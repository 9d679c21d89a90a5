// Every case in other units (ctest label `study`); the figures stand in
// data/README.md.

#include <algorithm>
#include <cstdio>
#include <string>

#include "gtest/gtest.h"
#include "tests/cases/case_text.h"
#include "tests/cases/measure.h"
#include "tests/cases/other_units.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace testing {
namespace {

class UnitsOfEveryCase : public ::testing::TestWithParam<const char*> {};

TEST_P(UnitsOfEveryCase, ChangeNoResult) {
  Case c = ReadCaseOrFail(std::string("data/") + GetParam() + ".toml");
  // What is left of records without noise is rounding.
  if (std::string(GetParam()).rfind("duffing", 0) == 0) AddNoise(0.01, 7, &c);
  const CaseRun here = RunCase(c);
  double exact = 0.0;
  double rounded = 0.0;
  for (const double factor : {8192.0, 1.0 / 8192.0, 1e4, 1e-4}) {
    for (int which = 0; which < 3; ++which) {
      UnitFactors unit;
      (which == 0 ? unit.force : which == 1 ? unit.length : unit.time) = factor;
      Case other = c;
      other.problem = InOtherUnits(c.problem, unit);
      const CaseRun there = RunCase(std::move(other));
      EXPECT_EQ(there.summary.usable(), here.summary.usable())
          << unit.force << " " << unit.length << " " << unit.time << ": "
          << there.summary.message;
      const double change = LargestChange(here, there);
      std::printf("%s, force %g, length %g, time %g: %.2g\n", GetParam(),
                  unit.force, unit.length, unit.time, change);
      const bool power_of_two = factor == 8192.0 || factor == 1.0 / 8192.0;
      double& largest = power_of_two ? exact : rounded;
      largest = std::max(largest, change);
    }
  }
  const std::string what = GetParam() + std::string(" in other units, by ");
  ExpectFigure(what + "2^13: largest change", 1e-12, exact);
  ExpectFigure(what + "1e4: largest change", 1e-6, rounded);
}

class UnitsOfNetworks : public ::testing::TestWithParam<const char*> {};

// Learning goes by chance: errors within a tenth, and the same verdict.
TEST_P(UnitsOfNetworks, ChangeNoVerdict) {
  const Case c = ReadCaseOrFail(std::string("data/") + GetParam() + ".toml");
  const CaseRun here = RunCase(c);
  EXPECT_TRUE(here.summary.usable()) << here.summary.message;
  double largest = 0.0;
  for (const UnitFactors& unit :
       {UnitFactors{"2^13 lengths", 1.0, 8192.0, 1.0},
        UnitFactors{"2^-13 times", 1.0, 1.0, 1.0 / 8192.0},
        UnitFactors{"1e4 forces", 1e4, 1.0, 1.0},
        UnitFactors{"1e-4 lengths", 1.0, 1e-4, 1.0},
        UnitFactors{"1e-4 times", 1.0, 1.0, 1e-4}}) {
    Case other = c;
    other.problem = InOtherUnits(c.problem, unit);
    const CaseRun there = RunCase(std::move(other));
    EXPECT_EQ(there.summary.usable(), here.summary.usable())
        << unit.name << ": " << there.summary.message;
    for (size_t r = 0; r < here.summary.records.size(); ++r) {
      const double ratio =
          there.summary.records[r].nrmse / here.summary.records[r].nrmse;
      std::printf("%s, %s, %s: error %.3g times as large\n", GetParam(),
                  unit.name.c_str(), here.summary.records[r].name.c_str(),
                  ratio);
      largest = std::max(largest, std::abs(std::log(ratio)));
    }
  }
  ExpectFigure(GetParam() + std::string(" in other units: error grows by"), 1.1,
               std::exp(largest));
}

INSTANTIATE_TEST_SUITE_P(Networks, UnitsOfNetworks,
                         ::testing::Values("four_dof_free/scheme2",
                                           "four_dof_free/scheme3"));

INSTANTIATE_TEST_SUITE_P(
    Cases, UnitsOfEveryCase,
    ::testing::Values(
        "three_storey/three_storey", "three_storey/noisy_ground",
        "duffing/single", "duffing/multiple", "three_storey_force/temperature",
        "three_storey_force/degrading", "three_storey_force/impact",
        "three_storey_force/impact_pulse", "three_storey_force/sweep",
        "three_storey_force/sweep_displacement"));

}  // namespace
}  // namespace testing
}  // namespace pinode
