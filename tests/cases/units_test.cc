// Cases in other units: the same results. All cases and factors:
// units_study_test.cc.

#include <string>

#include "gtest/gtest.h"
#include "tests/cases/case_text.h"
#include "tests/cases/measure.h"
#include "tests/cases/other_units.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace testing {
namespace {

void ExpectSameResults(const std::string& name, const Case& c) {
  const CaseRun here = RunCase(c);
  EXPECT_TRUE(here.summary.usable()) << here.summary.message;
  for (const UnitFactors& unit :
       {UnitFactors{"2^13 lengths", 1.0, 8192.0, 1.0},
        UnitFactors{"1e-4 lengths and forces", 1e-4, 1e-4, 1.0},
        UnitFactors{"1e4 times", 1.0, 1.0, 1e4}}) {
    Case other = c;
    other.problem = InOtherUnits(c.problem, unit);
    const CaseRun there = RunCase(std::move(other));
    EXPECT_EQ(there.summary.usable(), here.summary.usable())
        << unit.name << ": " << there.summary.message;
    ExpectFigure(name + " in " + unit.name + ": largest change",
                 unit.name[1] == '^' ? 1e-12 : 1e-6,
                 LargestChange(here, there));
  }
}

TEST(UnitsOfCases, ChangeNoResultOfTheFrame) {
  ExpectSameResults("three_storey",
                    ReadCaseOrFail("data/three_storey/three_storey.toml"));
}

// The oscillator with a library in place of its cubic spring.
TEST(UnitsOfCases, ChangeNoResultOfALibrary) {
  Case c = CaseOfText(
      WithTables(CaseText("data/duffing/single.toml"), "element", R"([[library]]
name = "spring"
inputs = ["x[y]", "v[y]"]
output = "y"
acts_as = "force"
terms = ["x[y]^3", "x[y]^2", "x[y]^2*v[y]", "tanh(x[y]/0.05)*v[y]"]

)"));
  AddNoise(0.01, 7, &c);
  ExpectSameResults("duffing with a library", c);
}

}  // namespace
}  // namespace testing
}  // namespace pinode
