#include "pinode/discover/regression_problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/support/discover_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

RegressionProblem Example() {
  testing::Gaussian random(1);
  RegressionProblem problem =
      testing::Problem(random.Draw(10, 2), random.Draw(10, 1));
  problem.outputs.push_back(problem.outputs[0]);
  problem.outputs[0].name = "a[1]";
  problem.outputs[1].name = "a[2]";
  return problem;
}

TEST(RegressionProblem, NamesCoefficients) {
  RegressionProblem problem = Example();
  EXPECT_EQ(problem.num_coefficients(), 4);
  EXPECT_THAT(problem.CoefficientNames(),
              ElementsAre("a[1]: c0", "a[1]: c1", "a[2]: c0", "a[2]: c1"));
  problem.outputs.pop_back();
  EXPECT_THAT(problem.CoefficientNames(), ElementsAre("c0", "c1"));
  std::string error;
  CoefficientMap map;
  problem.constraints = {CoefficientConstraint::Given("c1", 1.0)};
  ASSERT_TRUE(problem.IsValid(&error, &map)) << error;
  EXPECT_EQ(map.num_free(), 1);
}

TEST(RegressionProblem, SaysWhatIsWrong) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  using Change = void (*)(RegressionProblem*);
  const std::vector<std::pair<Change, std::string>> examples = {
      {[](RegressionProblem* p) { p->outputs.clear(); }, "no output"},
      {[](RegressionProblem* p) {
         for (auto& output : p->outputs) output.y.resize(0);
       },
       "no sample"},
      {[](RegressionProblem* p) { p->outputs[1].y.conservativeResize(9); },
       "output 'a[2]': 9 values and 10 rows"},
      {[](RegressionProblem* p) { p->outputs[1].theta.resize(9, 2); },
       "output 'a[2]': 10 values and 9 rows"},
      {[](RegressionProblem* p) { p->outputs[0].candidates.pop_back(); },
       "output 'a[1]': 1 candidates and 2 columns"},
      {[](RegressionProblem* p) { p->outputs[0].y[3] = kNan; },
       "output 'a[1]': a value is not finite"},
      {[](RegressionProblem* p) { p->outputs[1].theta(3, 1) = kNan; },
       "candidate 'c1' is not finite"},
      {[](RegressionProblem* p) { p->outputs[1].sigma = 0.0; }, "sigma 0"},
      {[](RegressionProblem* p) { p->outputs[1].name = "a[1]"; },
       "coefficient 'a[1]: c0' twice"},
      {[](RegressionProblem* p) { p->record_starts = {1}; },
       "record 1 starts at sample 1"},
      {[](RegressionProblem* p) {
         p->record_starts = {0, 4, 4};
       },
       "record 3 starts at sample 4"},
      {[](RegressionProblem* p) {
         p->record_starts = {0, 10};
       },
       "record 2 starts at sample 10"},
      {[](RegressionProblem* p) {
         p->constraints = {CoefficientConstraint::Positive("c0")};
       },
       "unknown coefficient 'c0'"},
  };
  std::string error;
  ASSERT_TRUE(Example().IsValid(&error)) << error;
  for (const auto& [change, message] : examples) {
    RegressionProblem problem = Example();
    change(&problem);
    EXPECT_FALSE(problem.IsValid(&error));
    EXPECT_THAT(error, HasSubstr(message));
  }
}

TEST(RegressionProblem, BlocksCoverTheRecordsAndStayWithin) {
  RegressionProblem problem =
      testing::Problem(Matrix::Ones(103, 1), Vector::Ones(103));
  problem.record_starts = {0, 50, 53};
  for (int wanted : {1, 2, 5, 10, 1000}) {
    const std::vector<TimeBlock> blocks = DivideIntoBlocks(problem, wanted);
    Eigen::Index next = 0;
    for (const TimeBlock& block : blocks) {
      EXPECT_EQ(block.begin, next);
      EXPECT_GT(block.count, 0);
      for (int start : {50, 53}) {
        EXPECT_FALSE(block.begin < start && block.begin + block.count > start);
      }
      next = block.begin + block.count;
    }
    EXPECT_EQ(next, 103);
  }
  EXPECT_EQ(DivideIntoBlocks(problem, 1).size(), 3u);
  EXPECT_EQ(DivideIntoBlocks(problem, 10).size(), 11u);
  EXPECT_EQ(DivideIntoBlocks(problem, 1000).size(), 103u);
}

}  // namespace
}  // namespace pinode
