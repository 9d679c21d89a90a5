#include "pinode/study/identify/step_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "pinode/base/statistics.h"
#include "pinode/dynamics/elements.h"
#include "pinode/problem/record_grid.h"
#include "pinode/study/problem/checkpoint.h"
#include "pinode/study/problem/substeps.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// A chain of three with a stiff top, and a spring that hardens, which is not
// known to be there before the fit.
IdentificationProblem Hardening(double sigma) {
  auto dynamics = testing::MakeGroupedChain(3, 100.0, 0.5);
  std::string error;
  EXPECT_TRUE(
      dynamics->AddElement("hard", "cubic", Feature::kGround, 0, {0.0}, &error))
      << error;
  IdentificationProblem problem;
  IdentificationRecord record =
      testing::MakeExcitedRecord(*dynamics, 400, 0.05);
  record.start = IdentificationRecord::Start::kRest;
  for (int i = 0; i < 3; ++i) {
    record.channels.push_back(testing::MakeChannel(
        "x" + std::to_string(i + 1), Quantity::kDisplacement, 3, i));
  }
  Vector truth = Vector::Zero(4);
  truth[3] = 4000.0;
  record.substeps = 64;
  testing::Simulate(*dynamics, truth, Vector::Zero(6), sigma, 5, &record);
  record.substeps = 0;
  record.integrator = Integrator::kExponential;
  problem.dynamics = dynamics;
  problem.records.push_back(std::move(record));
  ChooseStepsOrFail(&problem);
  return problem;
}

TEST(StepCheck, SeesTheStepsWhereTheyCount) {
  TestFit fit;
  fit.problem = Hardening(1e-3);
  IdentificationRecord& record = fit.problem.records[0];
  // Nothing hardens yet.
  EXPECT_EQ(record.exponential_steps, 1);
  const auto identify = [&fit] {
    testing::FitAndJudge(fit.problem, IdentificationOptions(), nullptr,
                         &fit.summary, &fit.model);
    ASSERT_EQ(fit.summary.termination, Termination::kConverged)
        << fit.summary.message;
  };
  identify();
  StepCheck check;
  ASSERT_TRUE(CheckStepsAtFit(fit.problem, fit.summary, fit.model, 1, &check));
  EXPECT_GT(check.shift, 0.1);
  EXPECT_THAT(check.Sentence(), HasSubstr("'" + check.parameter + "'"));
  // What it promises is what a fit with so many steps comes to.
  const double before =
      fit.model.parameters
          [ParameterLayout(fit.problem)
               .free()[static_cast<size_t>(
                   ParameterLayout(fit.problem).FreeIndex(check.parameter))]];
  TestFit fine = fit;
  fine.problem.records[0].exponential_steps *= 2;
  testing::FitAndJudge(fine.problem, IdentificationOptions(), nullptr,
                       &fine.summary, &fine.model);
  const double after =
      fine.model.parameters
          [ParameterLayout(fit.problem)
               .free()[static_cast<size_t>(
                   ParameterLayout(fit.problem).FreeIndex(check.parameter))]];
  EXPECT_NEAR(after - before, check.change, 0.2 * std::abs(check.change));

  // As asked for, with steps that are chosen.
  EXPECT_TRUE(record.substeps_chosen);
  const std::string identity = ProblemIdentity(fit.problem);
  ASSERT_TRUE(RefineSteps(check, &fit.problem));
  // A checkpoint stays one of this problem.
  EXPECT_EQ(ProblemIdentity(fit.problem), identity);
  EXPECT_GT(record.exponential_steps, 1);
  identify();
  ASSERT_TRUE(CheckStepsAtFit(fit.problem, fit.summary, fit.model, 1, &check));
  EXPECT_LT(check.shift, 0.1);
  EXPECT_FALSE(RefineSteps(check, &fit.problem));
}

// A chain with a stop that is hit, perhaps with a mode at 5 kHz.
IdentificationProblem WithAStop(bool stiff, bool with_stop,
                                std::optional<Integrator> integrator) {
  StructuralModel model = testing::MakeChain(3, 100.0, 0.5);
  if (stiff) {
    const double square = std::pow(2.0 * 3.14159265358979 * 5000.0, 2);
    model.stiffness(2, 2) += square;
    model.damping(2, 2) += 0.02 * std::sqrt(square);
  }
  auto dynamics = std::make_shared<StructuralDynamics>(
      model, std::vector<InputSpec>{
                 {InputSpec::Kind::kGroundAcceleration, 0, "ground"}});
  std::string error;
  EXPECT_TRUE(with_stop
                  ? dynamics->AddElement("stop", "bilinear", Feature::kGround,
                                         0, {200.0, 0.01}, &error)
                  : dynamics->AddElement("hard", "cubic", Feature::kGround, 0,
                                         {500.0}, &error))
      << error;
  IdentificationProblem problem;
  IdentificationRecord record =
      testing::MakeExcitedRecord(*dynamics, 400, 0.02);
  record.start = IdentificationRecord::Start::kRest;
  record.channels.push_back(
      testing::MakeChannel("x1", Quantity::kDisplacement, 3, 0));
  record.substeps = stiff ? 1600 : 16;
  testing::Simulate(*dynamics, dynamics->Parameters(), Vector::Zero(6), 0.0, 1,
                    &record);
  record.channels[0].sigma =
      1e-4 * StandardDeviationOfPresent(record.channels[0].values);
  record.substeps = 0;
  record.integrator = integrator;
  problem.dynamics = dynamics;
  problem.records.push_back(std::move(record));
  ChooseStepsOrFail(&problem);
  return problem;
}

int StepsWithAStop(bool stiff, bool with_stop) {
  return WithAStop(stiff, with_stop, Integrator::kExponential)
      .records[0]
      .exponential_steps;
}

TEST(ExponentialSteps, AreNotMoreForAModeAtFiveKilohertz) {
  EXPECT_LE(StepsWithAStop(true, false), StepsWithAStop(false, false));
  const int with_a_stop = StepsWithAStop(false, true);
  EXPECT_GT(with_a_stop, 1);
  EXPECT_LE(StepsWithAStop(true, true), 2 * with_a_stop);
}

TEST(ExponentialSteps, AreChosenWhereRungeKuttaNeedsMore) {
  const auto chosen = [](bool stiff, std::optional<Integrator> integrator) {
    const IdentificationProblem problem = WithAStop(stiff, false, integrator);
    return IntegratorOf(*problem.dynamics, problem.records[0]);
  };
  EXPECT_EQ(chosen(true, std::nullopt), Integrator::kExponential);
  EXPECT_EQ(chosen(false, std::nullopt), Integrator::kRungeKutta);
  EXPECT_EQ(chosen(true, Integrator::kRungeKutta), Integrator::kRungeKutta);
}

TEST(StepCheck, HasNothingToSayOfTheExactSolution) {
  const IdentificationProblem problem =
      MeasuredChain(2, *ChainAt(Eigen::Vector2d(0.1, -0.1)), 3);
  const TestFit fit = FitOf(problem);
  StepCheck check;
  EXPECT_FALSE(CheckStepsAtFit(fit.problem, fit.summary, fit.model, 1, &check));
}

}  // namespace
}  // namespace pinode
