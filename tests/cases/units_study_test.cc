// Every case without networks in other units (ctest label `study`); the figures
// stand in data/README.md.

#include <algorithm>
#include <cstdio>
#include <string>

#include "gtest/gtest.h"
#include "pinode/base/figure_testing.h"
#include "tests/cases/case_text.h"
#include "tests/cases/measure.h"
#include "tests/cases/other_units.h"

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
      EXPECT_EQ(there.summary.usable, here.summary.usable)
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
