#include "pinode/case/sections/plan_section.h"

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

constexpr char kChain[] = R"(title = "Planned"
[model]
dofs = ["1.1", "1.4", "2.1"]
mass = {diagonal = [1, 1, 1]}
stiffness = [[200, 0, -100], [0, 50, 0], [-100, 0, 100]]
damping = {ratios = [0.02]}
[[group]]
name = "k1"
adds_to = "stiffness"
between = ["ground", "1.1"]
scale = 100
[[record]]
name = "blow"
file = "blow.csv"
time = "t"
interpolation = "linear"
start = "rest"
  [[record.force]]
  dof = "2.1"
  column = "f"
  unit = "N"
)";

constexpr char kChannel[] = R"(  [[record.channel]]
  name = "a1"
  quantity = "absolute_acceleration"
  dof = "1.1"
  unit = "m/s^2"
  sigma_percent = 3
)";

class PlanSectionTest : public ::testing::Test {
 protected:
  PlanSectionTest() {
    std::string record = "t,f\n";
    for (int i = 0; i <= 100; ++i) {
      record += std::to_string(0.02 * i) + (i < 5 ? ",10\n" : ",0\n");
    }
    folder_.Write("blow.csv", record);
  }

  Case Read(const std::string& text, const std::string& force_dof = "") {
    Case c;
    std::string error;
    EXPECT_TRUE(ReadCaseForPlanning(folder_.Write("case.toml", text), force_dof,
                                    &c, &error))
        << error;
    return c;
  }

  std::string ErrorOf(const std::string& text,
                      const std::string& force_dof = "") {
    Case c;
    std::string error;
    EXPECT_FALSE(ReadCaseForPlanning(folder_.Write("case.toml", text),
                                     force_dof, &c, &error));
    EXPECT_EQ(error.find('\n'), std::string::npos);
    return error;
  }

  TemporaryFolder folder_;
};

TEST_F(PlanSectionTest, WithoutASectionEveryTranslation) {
  // No response has been measured, and none need be.
  const Case c = Read(kChain);
  ASSERT_EQ(c.plan.candidates.size(), 2u);
  EXPECT_EQ(c.plan.candidates[0].observation.name, "1.1");
  EXPECT_EQ(c.plan.candidates[1].observation.name, "2.1");
  EXPECT_EQ(c.plan.candidates[1].observation.weights, Vector::Unit(3, 2));
  EXPECT_EQ(c.plan.candidates[1].observation.quantity,
            Quantity::kAbsoluteAcceleration);
  EXPECT_EQ(c.plan.candidates[1].sigma, 0.0);
  EXPECT_TRUE(c.plan.own.empty());
}

TEST_F(PlanSectionTest, EveryKey) {
  const Case c = Read(std::string(kChain) + kChannel + R"([plan]
criterion = "worst_deviation"
parameters = ["k1"]
keep_own = true
durations = [0.5, 2.0]
excite = ["1.1", "2.1"]
[[plan.candidate]]
dofs = ["2.1", "1.4"]
quantity = "displacement"
sigma = 2
unit = "mm"
[[plan.candidate]]
sigma_percent = 4
)");
  EXPECT_EQ(c.plan.options.criterion,
            SensorPlanOptions::Criterion::kWorstDeviation);
  EXPECT_EQ(c.plan.options.targets, std::vector<std::string>{"k1"});
  EXPECT_TRUE(c.plan.options.keep_own);
  EXPECT_EQ(c.plan.durations, (std::vector<double>{0.5, 2.0}));
  EXPECT_EQ(c.plan.excite, (std::vector<std::string>{"1.1", "2.1"}));
  ASSERT_EQ(c.plan.own.size(), 1u);
  EXPECT_DOUBLE_EQ(c.plan.own[0].noise_share, 0.03);
  ASSERT_EQ(c.plan.candidates.size(), 4u);
  EXPECT_EQ(c.plan.candidates[0].observation.name, "2.1 displacement");
  EXPECT_DOUBLE_EQ(c.plan.candidates[0].sigma, 0.002);
  EXPECT_EQ(c.plan.candidates[3].observation.name, "2.1 absolute_acceleration");
  EXPECT_DOUBLE_EQ(c.plan.candidates[3].noise_share, 0.04);
}

TEST_F(PlanSectionTest, ForcesMove) {
  const Case c = Read(kChain, "1.1");
  ASSERT_EQ(c.problem.dynamics->num_inputs(), 1);
  EXPECT_EQ(c.problem.dynamics->inputs()[0].index, 0);
  EXPECT_EQ(c.problem.records[0].excitation->samples()(0, 2), 10.0);
  const std::string free =
      Replaced(Replaced(kChain, "[[record.force]]", "[[record.ground]]"),
               "  dof = \"2.1\"", "  direction = \"x\"");
  EXPECT_THAT(ErrorOf(Replaced(free, "\"N\"", "\"m/s^2\""), "1.1"),
              HasSubstr("case.toml:12: a record has no [[record.force]]"));
}

TEST_F(PlanSectionTest, RefusesInOneLine) {
  const auto plan = [](const std::string& lines) {
    return std::string(kChain) + "[plan]\n" + lines;
  };
  EXPECT_THAT(ErrorOf(plan("criterion = \"best\"")), HasSubstr("best"));
  EXPECT_THAT(ErrorOf(plan("parameters = [\"k2\"]")),
              HasSubstr("case.toml:23: [plan]: 'parameters' has 'k2'"));
  EXPECT_THAT(ErrorOf(plan("durations = [3.0]")), HasSubstr("not more than"));
  EXPECT_THAT(ErrorOf(plan("excite = [\"9.1\"]")), HasSubstr("9.1"));
  EXPECT_THAT(ErrorOf(plan("sensors = 3")), HasSubstr("sensors"));
  EXPECT_THAT(ErrorOf(plan("[[plan.candidate]]\ndofs = [\"1.2\"]")),
              HasSubstr("did you mean '1.1'"));
  EXPECT_THAT(ErrorOf(plan("[[plan.candidate]]\nsigma = 1")),
              HasSubstr("unit"));
  EXPECT_THAT(ErrorOf(plan("[[plan.candidate]]\nsigma = 1\nsigma_percent = 2")),
              HasSubstr("are both given"));
  EXPECT_THAT(ErrorOf(plan("[[plan.candidate]]\nquantity = \"strain\"")),
              HasSubstr("strain"));
  EXPECT_THAT(ErrorOf(Replaced(plan(""), "start = \"rest\"",
                               "excitation = \"ambient\"")),
              HasSubstr("planned for"));
}

}  // namespace
}  // namespace pinode
