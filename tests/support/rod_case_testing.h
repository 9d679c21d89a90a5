// A finite-element model small enough for closed forms, and a case with it.

#ifndef TESTS_SUPPORT_ROD_CASE_TESTING_H_
#define TESTS_SUPPORT_ROD_CASE_TESTING_H_

#include <string>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/structure/matrices/matrix_market.h"
#include "tests/support/case_testing.h"
#include "tests/support/rod_testing.h"

namespace pinode {

inline std::string DofList(int first = 1) {
  std::string text;
  for (int i = 0; i < kNodes; ++i) text += std::to_string(first + i) + ".1\n";
  return text;
}

inline constexpr char kRodCase[] = R"([units]
force = "kN"
[model]
damping = {ratios = [0.02]}
[model.finite_element]
mass = "M.mtx"
stiffness = {file = "K.mtx"}
dofs = "dofs.txt"
remove_dofs = ["1.1"]
[model.reduction]
method = "guyan"
[[group]]
name = "lower"
adds_to = "stiffness"
changed_export = "K_lower.mtx"
factor = 1.25
lower = -0.9
[[group]]
name = "upper"
adds_to = "stiffness"
set_export = "K_upper.mtx"
present = 2.0
[[group]]
name = "brace"
adds_to = "stiffness"
between = ["4.1", "8.1"]
scale = 100.0
[[record]]
name = "quake"
file = "quake.csv"
time = "t"
interpolation = "linear"
start = "rest"
substeps = 4
  [[record.ground]]
  direction = "x"
  column = "ag"
  unit = "m/s^2"
  [[record.channel]]
  column = "a1"
  quantity = "absolute_acceleration"
  dof = "8.1"
  unit = "m/s^2"
  [[record.channel]]
  column = "d2"
  quantity = "displacement"
  dof = "4.1"
  unit = "mm"
)";

class RodCaseTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string error;
    SparseMatrix mass(kNodes, kNodes);
    mass.setIdentity();
    mass *= 2.0;
    for (const auto& [name, matrix] :
         std::vector<std::pair<std::string, SparseMatrix>>{
             {"M.mtx", mass},
             {"K.mtx", Rod(1.0, 1.0)},
             {"K_lower.mtx", Rod(1.25, 1.0)},
             {"K_upper.mtx", Rod(0.0, 1.0)}}) {
      ASSERT_TRUE(WriteMatrixMarket(folder_.Path(name), matrix, &error))
          << error;
    }
    folder_.Write("dofs.txt", DofList());
    folder_.Write("quake.csv", SmallRecord());
  }

  Case ReadOrFail(const std::string& text) {
    Case c;
    std::string error;
    EXPECT_TRUE(ReadCase(folder_.Write("case.toml", text), &c, &error))
        << error;
    return c;
  }

  // Returns the error of the case with `from` replaced by `to`. Checks that it
  // names a file in one line.
  std::string Refusal(const std::string& from, const std::string& to) {
    Case c;
    std::string error;
    EXPECT_FALSE(ReadCase(
        folder_.Write("case.toml", Replaced(kRodCase, from, to)), &c, &error));
    EXPECT_THAT(error, ::testing::StartsWith(folder_.Path("")));
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    return error;
  }

  TemporaryFolder folder_;
};

}  // namespace pinode

#endif  // TESTS_SUPPORT_ROD_CASE_TESTING_H_
