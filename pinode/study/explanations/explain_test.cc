#include "pinode/study/explanations/explain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pinode/dynamics/feature.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/explanations/catalogue.h"
#include "pinode/study/explanations/close_numbers.h"
#include "pinode/study/explanations/confusions.h"
#include "pinode/study/explanations/record_checks.h"
#include "pinode/study/explanations/score_test.h"
#include "pinode/study/identify/identify.h"
#include "pinode/study/problem/growth.h"
#include "pinode/study/terms/library_term.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

// Three floors whose stiffness is free. The records come from `truth`.
Identification IdentifyChain(const StructuralDynamics& truth) {
  return Identify(MeasuredChain(3, truth, 7), IdentificationOptions(), {},
                  nullptr);
}

std::vector<std::string> Checks(const Verdict& verdict) {
  std::vector<std::string> checks;
  for (const Finding& finding : verdict.findings()) {
    checks.push_back(finding.check);
  }
  return checks;
}

TEST(CloseNumbers, AreToldApart) {
  EXPECT_EQ(DigitsToTellApart({31.4, 29.0, 33.0}), 3);
  EXPECT_EQ(DigitsToTellApart({0.99931, 0.99884, 0.99978}), 4);
  EXPECT_EQ(DigitsToTellApart({0.998, 0.99931, 0.99978}), 3);
  EXPECT_EQ(DigitsToTellApart({2.0, 2.0}), 3);
  EXPECT_EQ(DigitsToTellApart({1.0, 1.0 + 1e-12}), 8);
}

TEST(Explain, FindsNothingWhereNothingIsWrong) {
  const Identification found = IdentifyChain(*ChainAt(Vector{{0.1, -0.2, 0}}));
  EXPECT_EQ(found.summary.verdict.grade(), Grade::kGood);
  EXPECT_TRUE(found.summary.explanations.empty());
}

TEST(Explain, NamesTheDamping) {
  const Identification found =
      IdentifyChain(*testing::MakeGroupedChain(3, 100.0, 0.75));
  // All masses smaller by a third are the same to these records.
  ASSERT_GE(found.summary.explanations.size(), 2u);
  const size_t damping =
      found.summary.explanations[0].kind == "damping" ? 0 : 1;
  const Explanation& one = found.summary.explanations[damping];
  const Explanation& other = found.summary.explanations[1 - damping];
  EXPECT_EQ(one.kind, "damping") << one.what;
  EXPECT_NEAR(one.value, 0.5, 0.02);
  EXPECT_LT(one.lower95, 0.5);
  EXPECT_GT(one.upper95, 0.5);
  EXPECT_GT(one.removes, 0.9);
  EXPECT_EQ(other.kind, "mass") << other.what;
  EXPECT_NEAR(other.value, -1.0 / 3.0, 0.02);
  EXPECT_NEAR(other.log_odds, one.log_odds, 0.1);
}

TEST(Explain, NamesTheMass) {
  const auto chain = testing::MakeGroupedChain(3, 100.0, 0.5);
  StructuralModel model = chain->model();
  model.mass(1, 1) *= 1.3;
  std::string error;
  const auto truth =
      StructuralDynamics::Create(std::move(model), chain->inputs(), &error);
  ASSERT_NE(truth, nullptr) << error;
  const Identification found = IdentifyChain(*truth);
  EXPECT_EQ(found.summary.verdict.grade(), Grade::kWithCare);
  EXPECT_THAT(Checks(found.summary.verdict),
              ::testing::Contains("another_explanation"));
  ASSERT_FALSE(found.summary.explanations.empty());
  const Explanation& first = found.summary.explanations[0];
  EXPECT_EQ(first.kind, "mass") << first.what;
  EXPECT_EQ(first.place, chain->model().dof_names[1]);
  EXPECT_NEAR(first.value, 0.3, 0.01);
}

// A network can be the force that a wrong mass lacks, and stiffness follows it.
TEST(Explain, NamesTheMassBesideANetwork) {
  const auto chain = testing::MakeGroupedChain(2, 100.0, 0.5);
  StructuralModel model = chain->model();
  model.mass(1, 1) *= 1.1;
  std::string error;
  const auto truth =
      StructuralDynamics::Create(std::move(model), chain->inputs(), &error);
  ASSERT_NE(truth, nullptr) << error;
  IdentificationProblem problem = MeasuredChain(2, *truth, 7);
  auto dynamics = std::make_shared<StructuralDynamics>(*problem.dynamics);
  ASSERT_TRUE(dynamics->AddNetwork(
      testing::MakeNetwork({Feature::Displacement(0), Feature::Velocity(0)}, 4,
                           0.1),
      &error))
      << error;
  problem.dynamics = dynamics;
  problem.records[0].substeps = 4;
  const Identification found =
      Identify(problem, IdentificationOptions(), {}, nullptr);
  EXPECT_NE(found.summary.verdict.grade(), Grade::kGood);
  ASSERT_FALSE(found.summary.explanations.empty());
  // Less at the first floor is the same to this network.
  const Explanation& first = found.summary.explanations[0];
  EXPECT_EQ(first.kind, "mass") << first.what;
  EXPECT_NEAR(std::abs(first.value), 0.1, 0.02) << first.what;
}

TEST(Explain, NamesTheSensor) {
  IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector{{0.1, -0.2, 0}}), 7);
  problem.records[0].channels[1].values *= -0.8;
  const Identification found =
      Identify(std::move(problem), IdentificationOptions(), {}, nullptr);
  // A sensor upside down leaves so much that nothing can be said.
  if (found.summary.usable()) {
    ASSERT_FALSE(found.summary.explanations.empty());
    EXPECT_EQ(found.summary.explanations[0].kind, "sensor_gain");
  }

  problem = MeasuredChain(3, *ChainAt(Vector{{0.1, -0.2, 0}}), 7);
  problem.records[0].channels[1].values *= 0.8;
  const Identification scaled =
      Identify(std::move(problem), IdentificationOptions(), {}, nullptr);
  ASSERT_FALSE(scaled.summary.explanations.empty());
  const Explanation& first = scaled.summary.explanations[0];
  EXPECT_EQ(first.kind, "sensor_gain") << first.what;
  EXPECT_EQ(first.place, "a2");
  EXPECT_NEAR(first.value, 0.8, 0.005);
}

TEST(Explain, NamesTheNonlinearSpring) {
  const auto linear = ChainAt(Vector{{0.1, -0.2, 0}});
  LibrarySpec spec;
  spec.name = "spring";
  spec.features = {Feature::Deformation(0, 1)};
  spec.output =
      linear->model().dof_names[1] + "-" + linear->model().dof_names[0];
  spec.acts_as = ActsAs::kForce;
  spec.coefficients.resize(1);
  const std::string d = spec.features[0].Name(linear->model().dof_names, {});
  spec.coefficients[0].basis = d + "^3";
  spec.coefficients[0].parameter.value = 200.0;
  LawTerm term;
  std::string error;
  ASSERT_TRUE(MakeLibraryTerm(spec, *linear, UnitSystem(), &term, &error))
      << error;
  auto truth = std::make_shared<StructuralDynamics>(*linear);
  ASSERT_TRUE(truth->AddLaw(std::move(term), &error)) << error;
  const Identification found = IdentifyChain(*truth);
  ASSERT_FALSE(found.summary.explanations.empty());
  const Explanation& first = found.summary.explanations[0];
  EXPECT_EQ(first.kind, "nonlinear") << first.what;
  EXPECT_EQ(first.place,
            linear->model().dof_names[0] + "-" + linear->model().dof_names[1]);
  EXPECT_NEAR(first.value, 200.0, 5.0);
  EXPECT_GT(first.probability, 0.9);
}

// Stiffness of the first storey is known: stiffness and damping of the others
// cannot take over a clock that runs fast.
TEST(Explain, NamesTheClock) {
  constexpr double kRate = 1.1;
  auto truth =
      testing::MakeGroupedChain(3, 100.0 / (kRate * kRate), 0.5 / kRate);
  IdentificationProblem problem = MeasuredChain(3, *truth, 7);
  StructureTerms terms = TermsOf(*problem.dynamics);
  terms.groups[0].alpha.free = false;
  std::string error;
  ASSERT_TRUE(Assemble(problem.dynamics->model(), problem.dynamics->inputs(),
                       terms, &problem.dynamics, &error))
      << error;
  const Identification found =
      Identify(std::move(problem), IdentificationOptions(), {}, nullptr);
  std::vector<std::string> kinds;
  for (const Explanation& explanation : found.summary.explanations) {
    kinds.push_back(explanation.kind);
    if (explanation.kind != "clock_rate") continue;
    EXPECT_NEAR(explanation.value, kRate - 1.0, 0.005) << explanation.what;
  }
  ASSERT_GE(kinds.size(), 1u);
  kinds.resize(std::min<size_t>(kinds.size(), 2));
  EXPECT_THAT(kinds, ::testing::Contains("clock_rate"));
}

// The interval of a result that lacks something holds the truth, and what the
// linearised fit says alone does not.
TEST(Explain, WidensIntervalsAsFarAsTheExplanation) {
  const auto chain = testing::MakeGroupedChain(3, 100.0, 0.5);
  StructuralModel model = chain->model();
  model.mass(1, 1) *= 1.3;
  std::string error;
  const auto truth =
      StructuralDynamics::Create(std::move(model), chain->inputs(), &error);
  ASSERT_NE(truth, nullptr) << error;
  const Identification found = IdentifyChain(*truth);
  ASSERT_EQ(found.summary.verdict.grade(), Grade::kWithCare);
  int missed = 0;
  for (const ParameterEstimate& estimate : found.summary.parameters) {
    EXPECT_LT(estimate.lower95, 1e-3) << estimate.name;
    EXPECT_GT(estimate.upper95, -1e-3) << estimate.name;
    missed += std::abs(estimate.value) > estimate.half_width95 ? 1 : 0;
  }
  EXPECT_GT(missed, 0);
  EXPECT_EQ(found.summary.explanations[0].values.size(),
            found.summary.parameters.size());
}

TEST(Explain, NamesTheBound) {
  IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector{{0.25, 0, 0}}), 7);
  StructureTerms terms = TermsOf(*problem.dynamics);
  terms.groups[0].alpha.lower = -0.5;
  terms.groups[0].alpha.upper = 0.1;
  std::string error;
  ASSERT_TRUE(Assemble(problem.dynamics->model(), problem.dynamics->inputs(),
                       terms, &problem.dynamics, &error))
      << error;
  const Identification found =
      Identify(std::move(problem), IdentificationOptions(), {}, nullptr);
  ASSERT_FALSE(found.summary.explanations.empty());
  EXPECT_EQ(found.summary.explanations[0].kind, "bound")
      << found.summary.explanations[0].what;
  EXPECT_NEAR(found.summary.explanations[0].value, 0.25, 0.01);
}

// Unknown damping changes mass and stiffness under ground motion alike: the
// records of one floor cannot show it.
TEST(Explain, SaysWhatOnlyTheGivenDampingDetermines) {
  auto dynamics = testing::MakeGroupedChain(1, 100.0, 0.5);
  GroupTerm mass;
  mass.group.name = "m";
  mass.group.target = MatrixGroup::Target::kMass;
  mass.group.matrix = dynamics->model().mass;
  mass.alpha.name = "m";
  std::string error;
  ASSERT_TRUE(dynamics->AddGroup(mass, &error)) << error;
  IdentificationProblem problem =
      MeasuredChain(1, *testing::MakeGroupedChain(1, 100.0, 0.45), 7);
  problem.dynamics = dynamics;
  const Identification found =
      Identify(std::move(problem), IdentificationOptions(), {}, nullptr);
  EXPECT_THAT(Checks(found.summary.verdict),
              ::testing::Contains("told_apart_by_damping"));
}

TEST(ConfusionsBeforeFit, SaysWhatTheRecordsCannotTell) {
  IdentificationProblem problem =
      MeasuredChain(1, *testing::MakeGroupedChain(1, 100.0, 0.5), 7);
  const IdentificationOptions options;
  EXPECT_THAT(ConfusionsBeforeFit(problem, options),
              ::testing::Not(::testing::Contains(
                  ::testing::HasSubstr("all damping by one factor"))));
  auto dynamics = std::make_shared<StructuralDynamics>(*problem.dynamics);
  GroupTerm mass;
  mass.group.name = "m";
  mass.group.target = MatrixGroup::Target::kMass;
  mass.group.matrix = dynamics->model().mass;
  mass.alpha.name = "m";
  std::string error;
  ASSERT_TRUE(dynamics->AddGroup(mass, &error)) << error;
  problem.dynamics = dynamics;
  EXPECT_THAT(ConfusionsBeforeFit(problem, options),
              ::testing::Contains(::testing::AllOf(
                  ::testing::HasSubstr("in all damping by one factor changes "),
                  ::testing::EndsWith(
                      "Measure it, or give those parameters a prior."))));
  // An error of the mass is what the problem looks for.
  EXPECT_THAT(ConfusionsBeforeFit(problem, options),
              ::testing::Not(::testing::Contains(
                  ::testing::HasSubstr("do not separate all masses"))));
}

bool HasKind(const std::vector<Suspect>& suspects, Suspect::Kind kind) {
  return std::any_of(
      suspects.begin(), suspects.end(),
      [kind](const Suspect& suspect) { return suspect.kind == kind; });
}

void SetSamples(const Matrix& samples, IdentificationRecord* record) {
  const Excitation old = *record->excitation;
  record->excitation.emplace(old.start_time(), old.step(), samples,
                             old.interpolation());
}

// Another start is the same as a late clock or another scale of all sensors.
TEST(MakeSuspects, FreeVibrationHasNoClockAgainstTheExcitation) {
  using Kind = Suspect::Kind;
  IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector{{0.1, -0.2, 0}}), 7);
  IdentifiedModel model;
  model.parameters = ParameterLayout(problem).InitialValues();
  const std::vector<Suspect> driven = MakeSuspects(problem, model);
  EXPECT_TRUE(HasKind(driven, Kind::kExcitationDelay));
  EXPECT_TRUE(HasKind(driven, Kind::kExcitationScale));
  for (IdentificationRecord& record : problem.records) {
    SetSamples(Matrix(0.0 * record.excitation->samples()), &record);
    record.start = IdentificationRecord::Start::kFree;
  }
  const std::vector<Suspect> free = MakeSuspects(problem, model);
  EXPECT_FALSE(HasKind(free, Kind::kExcitationDelay));
  EXPECT_FALSE(HasKind(free, Kind::kExcitationScale));
  EXPECT_TRUE(HasKind(free, Kind::kSensorDelay));
  // The instant of a known start is one that a clock can miss.
  for (IdentificationRecord& record : problem.records) {
    record.start = IdentificationRecord::Start::kRest;
  }
  EXPECT_TRUE(HasKind(MakeSuspects(problem, model), Kind::kExcitationDelay));
  // One that was found from the first samples is like an unknown one.
  for (IdentificationRecord& record : problem.records) {
    record.start = IdentificationRecord::Start::kKnown;
    record.known_start = Vector::Zero(problem.dynamics->num_states());
  }
  EXPECT_TRUE(HasKind(MakeSuspects(problem, model), Kind::kExcitationDelay));
  for (IdentificationRecord& record : problem.records) {
    record.start_samples = 50;
  }
  const std::vector<Suspect> found = MakeSuspects(problem, model);
  EXPECT_FALSE(HasKind(found, Kind::kExcitationDelay));
  EXPECT_FALSE(HasKind(found, Kind::kExcitationScale));
}

// A temperature drives nothing. If it changes, a clock can miss it.
TEST(MakeSuspects, ACovariateDoesNotDriveFreeVibration) {
  using Kind = Suspect::Kind;
  IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector{{0.1, -0.2, 0}}), 7);
  std::vector<InputSpec> inputs = problem.dynamics->inputs();
  inputs.push_back({InputSpec::Kind::kCovariate, 0, "temperature"});
  auto dynamics =
      std::make_shared<StructuralDynamics>(problem.dynamics->model(), inputs);
  for (const GroupTerm& term : problem.dynamics->groups()) {
    std::string error;
    ASSERT_TRUE(dynamics->AddGroup(term, &error)) << error;
  }
  problem.dynamics = dynamics;
  IdentificationRecord& record = problem.records[0];
  record.start = IdentificationRecord::Start::kFree;
  Matrix samples =
      Matrix::Zero(dynamics->num_inputs(), record.excitation->num_samples());
  samples.bottomRows(1).setConstant(20.0);
  SetSamples(samples, &record);
  IdentifiedModel model;
  model.parameters = ParameterLayout(problem).InitialValues();
  const std::vector<Suspect> warm = MakeSuspects(problem, model);
  EXPECT_FALSE(HasKind(warm, Kind::kExcitationDelay));
  EXPECT_FALSE(HasKind(warm, Kind::kExcitationScale));
  samples.bottomRightCorner(1, 10).setConstant(25.0);
  SetSamples(samples, &record);
  const std::vector<Suspect> warmer = MakeSuspects(problem, model);
  EXPECT_TRUE(HasKind(warmer, Kind::kExcitationDelay));
  EXPECT_FALSE(HasKind(warmer, Kind::kExcitationScale));
}

TEST(ScoreSuspects, PromisesWhatARefitGains) {
  TestFit fit =
      FitOf(MeasuredChain(3, *testing::MakeGroupedChain(3, 100.0, 0.5005), 7));
  const std::vector<Suspect> suspects = MakeSuspects(fit.problem, fit.model);
  SuspectScores scores;
  std::string error;
  ASSERT_TRUE(ScoreSuspects(fit.problem, fit.summary, fit.model, suspects, 1,
                            &scores, &error))
      << error;
  ASSERT_EQ(scores.suspects.size(), suspects.size());
  ASSERT_EQ(suspects[0].kind, Suspect::Kind::kDamping);
  // The same from a fit with that unknown. Noise is given, so that costs can be
  // compared.
  IdentificationProblem given = fit.problem;
  for (size_t c = 0; c < given.records[0].channels.size(); ++c) {
    given.records[0].channels[c].sigma =
        fit.model.sigmas[0][static_cast<Eigen::Index>(c)];
  }
  IdentificationProblem with = given;
  ASSERT_TRUE(AddSuspects({suspects[0]}, &with, &error)) << error;
  TestFit before = FitOf(given), after = FitOf(with);
  EXPECT_NEAR(scores.suspects[0].gain,
              before.summary.final_cost - after.summary.final_cost,
              0.05 * scores.suspects[0].gain + 0.05);
}

TEST(CheckAgainstProblem, SeesACopyAndContradictedNoise) {
  IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector{{0.1, -0.2, 0}}), 7);
  const TestFit of_problem = FitOf(problem);
  const FitSummary& fit = of_problem.summary;
  const IdentifiedModel& model = of_problem.model;
  EXPECT_THAT(CheckAgainstProblem(problem, fit, model), ::testing::IsEmpty());
  problem.records[0].channels[0].values = problem.records[0].channels[1].values;
  std::vector<Finding> findings = CheckAgainstProblem(problem, fit, model);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].check, "copied_channel");
  EXPECT_EQ(findings[0].grade, Grade::kNotUsable);

  problem = MeasuredChain(3, *ChainAt(Vector{{0.1, -0.2, 0}}), 7);
  problem.records[0].channels[2].sigma = 0.5 * fit.records[0].channels[2].rmse;
  findings = CheckAgainstProblem(problem, fit, model);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].check, "given_noise_contradicted");
  EXPECT_NEAR(findings[0].number, 2.0, 1e-9);
  EXPECT_EQ(findings[0].grade, Grade::kWithCare);
}

// Two storeys with a damper each, of which one has become negative, and so much
// of the other that a mode has nearly stopped.
TEST(CheckAgainstProblem, SeesDampersThatNoStructureHas) {
  IdentificationProblem problem =
      MeasuredChain(3, *ChainAt(Vector{{0.1, -0.2, 0}}), 7);
  auto dynamics = std::make_shared<StructuralDynamics>(*problem.dynamics);
  GroupTerm damper;
  damper.group.name = "damper";
  damper.group.target = MatrixGroup::Target::kDamping;
  damper.group.matrix = SpringMatrix(3, 0, 1);
  damper.alpha.name = "damper";
  std::string error;
  ASSERT_TRUE(dynamics->AddGroup(damper, &error)) << error;
  problem.dynamics = dynamics;
  TestFit fit = FitOf(problem);
  EXPECT_THAT(CheckAgainstProblem(fit.problem, fit.summary, fit.model),
              ::testing::IsEmpty());
  const ParameterLayout layout(fit.problem);
  for (int i = 0; i < layout.num_parameters(); ++i) {
    if (layout.parameter(i).name == "damper") fit.model.parameters[i] = -5.0;
  }
  const auto checks = [&fit] {
    return Checks(
        Verdict(CheckAgainstProblem(fit.problem, fit.summary, fit.model)));
  };
  EXPECT_THAT(checks(), ::testing::Contains("negative_damper"));
  for (int i = 0; i < layout.num_parameters(); ++i) {
    if (layout.parameter(i).name == "damper") fit.model.parameters[i] = 10.0;
  }
  EXPECT_THAT(checks(), ::testing::ElementsAre("mode_damping"));
}

}  // namespace
}  // namespace pinode
