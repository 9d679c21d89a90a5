// A stiffness that follows the temperature by a table, from a case file to its
// result.

#include <cmath>
#include <random>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/case/results/model_case.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/estimate/certainty/assessment.h"
#include "tests/support/case_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double kMass = 1000.0;       // kg
constexpr double kStiffness = 1e6;     // N/m
constexpr double kAtReference = -0.1;  // alpha at 20 degrees

// Frozen ground is stiff: the change of alpha against that at 20 degrees.
double Frost(double temperature) {
  return temperature > 0.0 ? 0.001 * (20.0 - temperature)
                           : 0.02 - 0.02 * temperature;
}

// From 20 degrees to -20 and back in a minute, the ground shaken; Runge-Kutta
// in steps of half a millisecond, 2 % noise.
std::string FrostRecord() {
  constexpr int kSamples = 6000;
  constexpr int kSteps = 20;
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<double> ground(kSamples), temperature(kSamples);
  double held = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    held = 0.8 * held + normal(random);
    ground[i] = held;
    temperature[i] = 20.0 * std::cos(2.0 * kPi * i / kSamples);
  }
  std::string text = "t,ag,T,a\n";
  double x = 0.0, v = 0.0;
  std::vector<double> absolute(kSamples);
  for (int i = 0; i < kSamples; ++i) {
    const auto between = [i](const std::vector<double>& of, double share) {
      const int next = std::min(i + 1, kSamples - 1);
      return (1.0 - share) * of[i] + share * of[next];
    };
    // -(k x + c v) / m.
    const auto pull = [&](double share, double at_x, double at_v) {
      const double k = kStiffness * (1.0 + kAtReference +
                                     Frost(between(temperature, share)));
      return -(k * at_x + 1200.0 * at_v) / kMass;
    };
    absolute[i] = pull(0.0, x, v);
    const double h = 0.01 / kSteps;
    for (int s = 0; s < kSteps; ++s) {
      const auto a = [&](double part, double at_x, double at_v) {
        const double share = (s + part) / kSteps;
        return pull(share, at_x, at_v) - between(ground, share);
      };
      const double x1 = v, v1 = a(0.0, x, v);
      const double x2 = v + h / 2 * v1, v2 = a(0.5, x + h / 2 * x1, x2);
      const double x3 = v + h / 2 * v2, v3 = a(0.5, x + h / 2 * x2, x3);
      const double x4 = v + h * v3, v4 = a(1.0, x + h * x3, x4);
      x += h / 6 * (x1 + 2 * x2 + 2 * x3 + x4);
      v += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    }
  }
  double square = 0.0;
  for (const double value : absolute) square += value * value / kSamples;
  for (int i = 0; i < kSamples; ++i) {
    text += FormatNumber(0.01 * i, 6) + "," + FormatNumber(ground[i], 12) +
            "," + FormatNumber(temperature[i], 12) + "," +
            FormatNumber(
                absolute[i] + 0.02 * std::sqrt(square) * normal(random), 9) +
            "\n";
  }
  return text;
}

constexpr char kFrostCase[] = R"([model]
dofs = ["u1"]
mass = [[1000]]
stiffness = [[1e6]]
damping = [[1200]]
[[group]]
name = "soil"
adds_to = "stiffness"
between = ["ground", "u1"]
scale = 1e6
FOLLOWS
[[record]]
name = "winter"
file = "winter.csv"
time = "t"
start = "rest"
interpolation = "linear"
  [[record.ground]]
  direction = "x"
  column = "ag"
  unit = "m/s^2"
  [[record.covariate]]
  name = "temperature"
  column = "T"
  [[record.channel]]
  column = "a"
  quantity = "absolute_acceleration"
  dof = "u1"
  unit = "m/s^2"
)";

constexpr char kTable[] =
    R"(follows = {covariate = "temperature", knots = [-20, -10, 0, 10, 20, 40], reference = 20})";

class GroupCurveTest : public ::testing::Test {
 protected:
  void SetUp() override { folder_.Write("winter.csv", FrostRecord()); }

  Case Read(const std::string& follows) {
    return ReadOrFail(
        folder_.Write("case.toml", Replaced(kFrostCase, "FOLLOWS", follows)));
  }

  std::string Refusal(const std::string& follows) {
    Case c;
    std::string error;
    EXPECT_FALSE(ReadCase(
        folder_.Write("case.toml", Replaced(kFrostCase, "FOLLOWS", follows)),
        &c, &error));
    EXPECT_THAT(error, StartsWith(folder_.Path("case.toml") + ":"));
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    return error;
  }

  TemporaryFolder folder_;
};

using GroupCurveFigures = GroupCurveTest;

TEST_F(GroupCurveFigures, RecoversAKinkThatAStraightLineMisses) {
  const Case c = Read(kTable);
  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(c.problem, c.options, nullptr, &summary, &model);
  ASSERT_TRUE(summary.usable()) << summary.message;
  ASSERT_EQ(summary.parameters.size(), 6u);
  const auto& found = summary.parameters;
  EXPECT_EQ(found[0].name, "soil");
  EXPECT_EQ(found[1].name, "soil.temperature[-20]");
  EXPECT_EQ(found[5].name, "soil.temperature[40]");
  EXPECT_NEAR(found[0].value, kAtReference, 3.0 * found[0].sigma);
  const double knots[] = {-20.0, -10.0, 0.0, 10.0};
  for (int k = 0; k < 4; ++k) {
    const ParameterEstimate& at = found[static_cast<size_t>(k + 1)];
    EXPECT_NEAR(at.value, Frost(knots[k]), 3.0 * at.sigma) << at.name;
    EXPECT_LT(at.sigma, 0.01);
    EXPECT_GT(at.sigma, 1e-5);
  }
  // Without data there is the prior, wide and centred at the neighbouring
  // value.
  EXPECT_NEAR(found[5].value, 0.0, 0.01);
  EXPECT_GT(found[5].sigma, 10.0 * found[4].sigma);
  EXPECT_GT(found[5].sigma, 0.03);
  const double noise = 0.02;
  EXPECT_LT(summary.records[0].channels[0].nrmse, 1.05 * noise);

  // A constant and a straight line instead.
  const Case straight = Read(R"([[group]]
name = "slope"
adds_to = "stiffness"
between = ["ground", "u1"]
scale = 1e6
follows = {covariate = "temperature", reference = 20}
)");
  IdentificationSummary of_line;
  testing::FitAndJudge(straight.problem, straight.options, nullptr, &of_line,
                       &model);
  EXPECT_GT(of_line.records[0].channels[0].nrmse,
            4.0 * summary.records[0].channels[0].nrmse);
  std::printf("nrmse %.4f by the table, %.4f by the straight line\n",
              summary.records[0].channels[0].nrmse,
              of_line.records[0].channels[0].nrmse);
  for (const ParameterEstimate& p : found) {
    std::printf("%-24s %9.5f +- %.5f\n", p.name.c_str(), p.value, p.sigma);
  }
}

// No record reaches 40 degrees: what the fit holds by its prior is not called
// undetermined before it.
TEST_F(GroupCurveTest, AssessmentKnowsWhatHoldsAKnotWithoutData) {
  const Case c = Read(kTable);
  ProblemAssessment assessment;
  std::string error;
  ASSERT_TRUE(AssessProblem(c.problem, c.options, &assessment, &error))
      << error;
  EXPECT_THAT(assessment.undetermined, ::testing::IsEmpty());
  ASSERT_EQ(assessment.expected.size(), 6u);
  EXPECT_LT(assessment.expected[4].sigma, assessment.expected[5].sigma);
  EXPECT_LT(assessment.expected[5].sigma, 10.0);
}

// The result is a case whose matrices are those at the reference, and whose
// table begins at what was found: the fit of it stays there.
TEST_F(GroupCurveTest, ResultIsACaseOfTheSame) {
  const Case c = Read(kTable);
  IdentifiedModel model;
  model.parameters = c.problem.dynamics->Parameters();
  model.parameters << -0.1, 0.42, 0.22, 0.02, 0.01, -0.005;
  std::string error;
  ASSERT_TRUE(
      WriteModelCase(c, model, folder_.Path(""), folder_.Path(""), &error))
      << error;
  const Case again = ReadOrFail(folder_.Path("model.toml"));
  const StructuralDynamics& dynamics = *again.problem.dynamics;
  EXPECT_NEAR(dynamics.model().stiffness(0, 0), 0.9e6, 1e-6);
  Vector expected(6);
  expected << 0.0, 0.42, 0.22, 0.02, 0.01, -0.005;
  EXPECT_LT((dynamics.Parameters() - expected).norm(), 1e-14);
  const GroupCurve before = c.problem.dynamics->group_curves()[0];
  const GroupCurve after = dynamics.group_curves()[0];
  EXPECT_EQ(after.knots, before.knots);
  EXPECT_EQ(after.reference, before.reference);
  EXPECT_LT((after.group.matrix - before.group.matrix).norm(), 1e-9);
  EXPECT_EQ(after.prior.precisions, before.prior.precisions);
}

TEST_F(GroupCurveTest, ReadsWhatIsGiven) {
  const Case c = Read(
      R"(follows = {covariate = "temperature", knots = [-20, 0, 20], reference = 0, smoothness = 0.05, differences = 2, values = [0.3, 0, -0.1], free = false})");
  ASSERT_EQ(c.problem.dynamics->group_curves().size(), 1u);
  const GroupCurve curve = c.problem.dynamics->group_curves()[0];
  EXPECT_THAT(curve.knots, ElementsAre(-20.0, 0.0, 20.0));
  EXPECT_EQ(curve.reference, 1);
  EXPECT_EQ(curve.prior.combinations.size(), 1u);
  EXPECT_DOUBLE_EQ(curve.prior.precisions[0], 400.0);
  EXPECT_EQ(curve.parameters.Values(), Vector(Eigen::Vector2d(0.3, -0.1)));
  EXPECT_FALSE(curve.parameters.parameters[0].free);
  EXPECT_TRUE(c.problem.dynamics->groups()[0].alpha.free);
}

TEST_F(GroupCurveTest, RefusesWhatCannotBe) {
  const auto with = [this](const std::string& rest) {
    return Refusal("follows = {covariate = \"temperature\", " + rest + "}");
  };
  EXPECT_THAT(with("knots = [0], reference = 0"), HasSubstr("case.toml:11:"));
  EXPECT_THAT(with("knots = [0], reference = 0"),
              HasSubstr("two values of the covariate or more, ascending"));
  EXPECT_THAT(with("knots = [0, 10, 10], reference = 0"),
              HasSubstr("ascending"));
  EXPECT_THAT(with("knots = [0, 10]"), HasSubstr("'reference'"));
  EXPECT_THAT(with("knots = [0, 10], reference = 5"),
              HasSubstr("'reference' is 5, expected one of the knots"));
  EXPECT_THAT(with("knots = [0, 10], reference = 0, differences = 2"),
              HasSubstr("2 of three knots or more"));
  EXPECT_THAT(with("knots = [0, 10, 20], reference = 0, differences = 3"),
              HasSubstr("expected 1, or 2"));
  EXPECT_THAT(with("knots = [0, 10], reference = 0, smoothness = 0.0"),
              HasSubstr("smoothness"));
  EXPECT_THAT(with("knots = [0, 10], reference = 0, smoothness = \"much\""),
              HasSubstr("\"evidence\" or a number"));
  EXPECT_THAT(with("knots = [0, 10], reference = 0, values = [0.0]"),
              HasSubstr("values"));
  EXPECT_THAT(with("knots = [0, 10], reference = 0, values = [0.1, 0.0]"),
              HasSubstr("expected 0 there"));
  EXPECT_THAT(with("reference = 0, smoothness = 0.1"),
              HasSubstr("needs 'knots'"));
  EXPECT_THAT(
      Refusal("follows = {covariate = \"humidity\", knots = [0, 1], reference "
              "= 0}"),
      HasSubstr("no record has a covariate 'humidity'"));
  EXPECT_THAT(
      Refusal("follows = {time = \"linear\", knots = [0, 1], reference = 0}"),
      HasSubstr("not time"));
}

}  // namespace
}  // namespace pinode
