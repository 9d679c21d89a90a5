// Forces that nobody measured, and a stiffness that follows time or the
// temperature: data/three_storey_force.

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/study/explanations/unknown_forces.h"
#include "pinode/study/identify/identify.h"
#include "tests/cases/force_measure.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace testing {
namespace {

void Expect(const std::string& what, const Asked& asked, double measured) {
  ReportFigure(what, asked, measured);
  EXPECT_GE(measured, asked.least) << what;
  EXPECT_LE(measured, asked.most) << what;
}

TEST(ForceCases, ABlowIsFoundWithLocalSmoothness) {
  const CaseRun run = RunCase(ForceCase("impact"));
  ASSERT_TRUE(run.summary.usable()) << run.summary.message;
  EXPECT_EQ(run.summary.covariance_method, "plain");
  const ForceScore blow = ScoreForce(run);
  Expect("impact, local smoothness: impulse, relative error", AtMost(0.05),
         blow.impulse_error);
  Expect("impact, local smoothness: peak time, s (a sample is 0.01)",
         AtMost(0.01), blow.peak_error);
  Expect("impact, local smoothness: force, share within its 95 % band",
         AtLeast(0.9), blow.coverage);
  ReportFigure("impact, local smoothness: the same, during the blow", Nothing(),
               blow.coverage_acting);
  ReportFigure("impact, local smoothness: force, nrmse", Nothing(), blow.nrmse);

  // One precision for all knots smears the blow.
  Case global = ForceCase("impact");
  StructuralDynamics dynamics(global.problem.dynamics->model(),
                              global.problem.dynamics->inputs());
  std::string error;
  for (const LawTerm& law : global.problem.dynamics->laws()) {
    ASSERT_TRUE(dynamics.AddLaw(law, &error)) << error;
  }
  UnknownForceTerm term = global.problem.dynamics->unknown_forces()[0];
  const double spacing =
      dynamic_cast<const SplineForce&>(*term.history).options().spacing;
  term.prior = SmoothnessPrior(term.parameters.size(), term.parameters.size(),
                               spacing / 0.1);
  ASSERT_TRUE(dynamics.AddUnknownForce(term, &error)) << error;
  global.problem.dynamics = std::make_shared<StructuralDynamics>(dynamics);
  const ForceScore smeared = ScoreForce(RunCase(std::move(global)));
  ReportFigure("impact, one smoothness for all: impulse, relative error",
               Nothing(), smeared.impulse_error);
  ReportFigure("impact, one smoothness for all: force, nrmse", Nothing(),
               smeared.nrmse);
  EXPECT_GT(smeared.nrmse, 3.0 * blow.nrmse);
}

// The swept sine with `model` in place of the case's, and the force at `dof`.
CaseRun RunSweep(const StructuralModel& model, int dof) {
  Case with = ForceCase("sweep");
  const StructuralDynamics& given = *with.problem.dynamics;
  StructuralDynamics dynamics(model, given.inputs());
  std::string error;
  for (const LawTerm& law : given.laws()) {
    EXPECT_TRUE(dynamics.AddLaw(law, &error)) << error;
  }
  UnknownForceTerm force = given.unknown_forces()[0];
  force.outputs = Vector::Unit(model.num_dofs(), dof);
  EXPECT_TRUE(dynamics.AddUnknownForce(force, &error)) << error;
  with.problem.dynamics = std::make_shared<StructuralDynamics>(dynamics);
  CaseRun run;
  Identification found =
      Identify(with.problem, with.options, IdentificationExtras(), nullptr);
  run.c = std::move(with);
  run.summary = std::move(found.summary);
  run.model = std::move(found.model);
  return run;
}

// A force takes over most of what a model lacks: a storey that is a tenth too
// soft leaves 5 % of the motion, and a force that is off by a fifth.
TEST(ForceCases, AWrongStoreyIsNamed) {
  const Case given = ForceCase("sweep");
  StructuralModel model = given.problem.dynamics->model();
  const double soft = 0.12 * model.stiffness(0, 1);  // -k2
  model.stiffness(0, 0) += soft;
  model.stiffness(1, 1) += soft;
  model.stiffness(0, 1) -= soft;
  model.stiffness(1, 0) -= soft;
  const CaseRun run = RunSweep(model, 1);
  EXPECT_EQ(run.summary.verdict.grade(), Grade::kWithCare);
  ASSERT_FALSE(run.summary.explanations.empty());
  const Explanation& first = run.summary.explanations[0];
  EXPECT_EQ(first.kind, "stiffness") << first.what;
  EXPECT_NEAR(first.value, 1.0 / 0.88 - 1.0, 0.005) << first.what;
  EXPECT_EQ(first.moved, "shaker");
  // The bounds of the force hold the true one.
  const ForceScore score = ScoreForce(run);
  Expect("sweep, a storey off by 12 %: force, share within its band",
         AtLeast(0.9), score.coverage);
}

TEST(ForceCases, AForceAtTheWrongStoreyIsNoForce) {
  const CaseRun run = RunSweep(ForceCase("sweep").problem.dynamics->model(), 2);
  EXPECT_EQ(run.summary.verdict.grade(), Grade::kNotUsable);
  ASSERT_FALSE(run.summary.explanations.empty());
  EXPECT_EQ(run.summary.explanations[0].kind, "force_place");
  EXPECT_EQ(run.summary.explanations[0].place, "shaker,u2");
}

// With one sensor for one force nothing can contradict the model.
TEST(ForceCases, AForceNeedsMoreSensorsThanForces) {
  Case c = ForceCase("sweep");
  EXPECT_TRUE(CheckUnknownForces(c.problem, FitSummary()).empty());
  std::vector<MeasuredChannel>& channels = c.problem.records[0].channels;
  channels[1].fit = false;
  EXPECT_TRUE(CheckUnknownForces(c.problem, FitSummary()).empty());
  channels[2].fit = false;
  const std::vector<Finding> findings =
      CheckUnknownForces(c.problem, FitSummary());
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].check, "nothing_checks_the_force");
  EXPECT_EQ(findings[0].grade, Grade::kWithCare);
}

// The case says nothing of when the blow fell.
TEST(ForceCases, ABlowIsFoundAsAPulse) {
  const CaseRun run = RunCase(ForceCase("impact_pulse"));
  ASSERT_TRUE(run.summary.usable()) << run.summary.message;
  const double impulse = run.Parameter("blow.amplitude").value *
                         run.Parameter("blow.duration").value * 2.0 / kPi;
  Expect("impact, half-sine pulse: impulse, relative error", AtMost(0.005),
         std::abs(impulse / ForceTruthNumber("pulse/impulse") - 1.0));
  const ForceScore score = ScoreForce(run);
  Expect("impact, half-sine pulse: peak time, s", AtMost(0.01),
         score.peak_error);
  Expect("impact, half-sine pulse: start, s", AtMost(kHeldPulseStart),
         score.start_error);
  Expect("impact, half-sine pulse: duration, relative error",
         AtMost(kHeldPulseDuration), score.duration_error);
  Expect("impact, half-sine pulse: amplitude, relative error",
         AtMost(kHeldPulseAmplitude), score.amplitude_error);
  // Ninety-five per cent intervals, three of them, one seed.
  for (const char* name : {"start", "duration", "amplitude"}) {
    const ParameterEstimate& p = run.Parameter(std::string("blow.") + name);
    EXPECT_LT(
        std::abs(p.value - ForceTruthNumber(std::string("pulse/") + name)),
        3.5 * p.sigma)
        << name;
  }
}

// The errors of neighbouring instants are nearly the same, so that the share of
// one draw of the noise scatters, the more the smoother the force: that bands
// are neither too narrow nor too wide is what force_study_test.cc measures.
void ExpectForce(const std::string& name, const Asked& asked,
                 double least_coverage) {
  const CaseRun run = RunCase(ForceCase(name));
  ASSERT_TRUE(run.summary.usable()) << run.summary.message;
  EXPECT_EQ(run.summary.covariance_method, "plain");
  const ForceScore score = ScoreForce(run);
  Expect(name + ": force, nrmse", asked, score.nrmse);
  Expect(name + ": force, share within its 95 % band", AtLeast(least_coverage),
         score.coverage);
}

TEST(ForceCases, ASweptSineIsFoundFromAccelerations) {
  ExpectForce("sweep", AtMost(0.06), 0.85);
  ExpectForce("sweep_high", AtMost(0.06), 0.85);
}

TEST(ForceCases, ASweptSineIsFoundWithOneDisplacement) {
  ExpectForce("sweep_displacement", AtMost(0.05), 0.85);
}

TEST(ForceCases, AGustIsFoundAsANetworkOfTime) {
  ExpectForce("gust", AtMost(0.05), 0.75);
}

TEST(ForceCases, TheStaticPartIsSaidToBeUnseen) {
  const auto unseen =
      ::testing::HasSubstr("The static part of the unknown force");
  for (const char* name : {"sweep", "sweep_high", "impact"}) {
    EXPECT_THAT(ForceCase(name).problem.description.remarks,
                ::testing::Contains(unseen))
        << name;
  }
  for (const char* name : {"sweep_displacement", "gust"}) {
    EXPECT_THAT(ForceCase(name).problem.description.remarks,
                ::testing::Not(::testing::Contains(unseen)))
        << name;
  }
}

TEST(ForceCases, DegradingStiffnessIsFollowed) {
  const CaseRun run = RunCase(ForceCase("degrading"));
  ASSERT_TRUE(run.summary.usable()) << run.summary.message;
  Expect("degrading stiffness: initial value, relative error", AtMost(0.001),
         std::abs(run.Parameter("k1").value -
                  ForceTruthNumber("degrading/initial")));
  Expect("degrading stiffness: rate, relative error", AtMost(0.003),
         std::abs(run.Parameter("k1_rate").value /
                      ForceTruthNumber("degrading/rate") -
                  1.0));
}

TEST(ForceCases, AStiffnessFollowsTheTemperature) {
  const CaseRun run = RunCase(ForceCase("temperature"));
  ASSERT_TRUE(run.summary.usable()) << run.summary.message;
  const ParameterEstimate& slope = run.Parameter("per_degree");
  const double truth = ForceTruthNumber("temperature/per_degree");
  Expect("temperature: change of stiffness per degree, relative error",
         AtMost(0.01), std::abs(slope.value / truth - 1.0));
  EXPECT_LT(std::abs(slope.value - truth), 3.5 * slope.sigma);
  for (const char* name : {"k1", "k2", "k3"}) {
    Expect(std::string("temperature: ") + name + " at 20 degrees, error",
           AtMost(0.001), std::abs(run.Parameter(name).value));
  }
  // The noise is 1 % of each channel.
  Expect("temperature: nrmse of the hold-out", AtMost(0.012),
         run.Record("temperature_holdout").nrmse);
}

}  // namespace
}  // namespace testing
}  // namespace pinode
