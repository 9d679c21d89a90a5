#include "pinode/study/explanations/modes_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "pinode/problem/parameter_layout.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/study/damage/mass_instead.h"
#include "pinode/study/identify/identify.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// Five floors whose stiffness is free, and four measured modes, at all DOFs, of
// a chain with one other mass, with 0.1 % noise in frequencies and 0.01 in
// shapes.
IdentificationProblem MeasuredModes(double added_mass, int at,
                                    const Vector& alpha, unsigned seed) {
  IdentificationProblem problem;
  const auto chain = testing::MakeGroupedChain(5, 100.0, 0.5);
  problem.dynamics = chain;
  StructuralModel truth = chain->CorrectedModel(alpha);
  truth.mass(at, at) *= 1.0 + added_mass;
  ModalProperties modes;
  std::string error;
  EXPECT_TRUE(
      ComputeModes(truth.mass, truth.damping, truth.stiffness, &modes, &error))
      << error;
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise;
  for (int j = 0; j < 4; ++j) {
    MeasuredMode mode;
    mode.name = std::to_string(j + 1);
    mode.frequency = modes.frequency_hz[j] * (1.0 + 1e-3 * noise(generator));
    mode.frequency_sigma = 1e-3 * modes.frequency_hz[j];
    mode.dofs = {0, 1, 2, 3, 4};
    mode.shape = modes.mode_shapes.col(j);
    mode.shape /= mode.shape.cwiseAbs().maxCoeff();
    for (double& entry : mode.shape) entry += 0.01 * noise(generator);
    mode.shape_sigma = 0.01;
    problem.modal.modes.push_back(std::move(mode));
  }
  return problem;
}

Identification IdentifyModes(const IdentificationProblem& problem) {
  return Identify(problem, IdentificationOptions(), {}, nullptr);
}

const Vector& SomeStiffness() {
  static const Vector alpha{{-0.1, 0.05, 0.12, -0.08, 0.1}};
  return alpha;
}

TEST(ModesSearch, HasNothingToSayOfRightModes) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Identification found =
        IdentifyModes(MeasuredModes(0.0, 0, SomeStiffness(), seed));
    EXPECT_EQ(found.summary.verdict.grade(), Grade::kGood) << seed;
    EXPECT_TRUE(found.summary.explanations.empty()) << seed;
  }
}

TEST(ModesSearch, NamesTheMass) {
  const Identification found =
      IdentifyModes(MeasuredModes(0.25, 2, SomeStiffness(), 1));
  EXPECT_EQ(found.summary.verdict.grade(), Grade::kWithCare);
  ASSERT_FALSE(found.summary.explanations.empty());
  const Explanation& first = found.summary.explanations[0];
  EXPECT_EQ(first.kind, "mass") << first.what;
  EXPECT_EQ(first.place, "u3");
  EXPECT_LT(first.lower95, 0.25);
  EXPECT_GT(first.upper95, 0.25);
  // The intervals hold what the mass makes of the stiffness.
  for (size_t j = 0; j < 5; ++j) {
    const ParameterEstimate& own = found.summary.parameters[j];
    const double truth = SomeStiffness()[static_cast<Eigen::Index>(j)];
    EXPECT_LT(own.lower95, truth) << own.name;
    EXPECT_GT(own.upper95, truth) << own.name;
  }
}

TEST(ModesSearch, NamesAMisreadMode) {
  IdentificationProblem problem = MeasuredModes(0.0, 0, SomeStiffness(), 2);
  problem.modal.modes[2].frequency *= 1.05;
  const Identification found = IdentifyModes(problem);
  EXPECT_EQ(found.summary.verdict.grade(), Grade::kWithCare);
  ASSERT_FALSE(found.summary.explanations.empty());
  const Explanation& first = found.summary.explanations[0];
  EXPECT_EQ(first.kind, "mode") << first.what;
  EXPECT_EQ(first.place, "3");
  EXPECT_THAT(first.what, HasSubstr("misread"));
}

bool HasFinding(const IdentificationSummary& fit, const std::string& check) {
  const auto& findings = fit.verdict.findings();
  return std::any_of(
      findings.begin(), findings.end(),
      [&check](const Finding& finding) { return finding.check == check; });
}

// With the other sign of an entry the second mode is the partner of no mode of
// the model, and the fit goes on without it.
TEST(ModesSearch, NamesTheSignThatLeavesAModeUnused) {
  for (const bool has_deviations : {true, false}) {
    IdentificationProblem problem = MeasuredModes(0.0, 0, SomeStiffness(), 2);
    problem.modal.modes[1].shape[1] *= -1.0;
    for (MeasuredMode& mode : problem.modal.modes) {
      if (has_deviations) break;
      mode.frequency_sigma = 0.0;
      mode.shape_sigma = 0.0;
    }
    const Identification found = IdentifyModes(problem);
    ASSERT_FALSE(found.summary.modes[1].InUse());
    EXPECT_EQ(found.summary.verdict.grade(), Grade::kWithCare);
    EXPECT_TRUE(HasFinding(found.summary, "mode_not_used"));
    ASSERT_FALSE(found.summary.explanations.empty()) << has_deviations;
    EXPECT_EQ(found.summary.explanations[0].what, "the sign of mode 2 at 'u2'");
  }
}

// Without standard deviations a fit takes any error of a shape for noise.
TEST(ModesSearch, FindsAShapeThatIsNotMet) {
  IdentificationProblem problem = MeasuredModes(0.0, 0, SomeStiffness(), 2);
  for (MeasuredMode& mode : problem.modal.modes) {
    mode.frequency_sigma = 0.0;
    mode.shape_sigma = 0.0;
  }
  EXPECT_EQ(IdentifyModes(problem).summary.verdict.grade(), Grade::kGood);
  problem.modal.modes[0].shape[1] *= -1.0;
  const IdentificationSummary fit = IdentifyModes(problem).summary;
  ASSERT_TRUE(fit.modes[0].InUse());
  EXPECT_NE(fit.verdict.grade(), Grade::kGood);
  EXPECT_TRUE(HasFinding(fit, "shape_not_met"));
  ASSERT_FALSE(fit.explanations.empty());
  EXPECT_EQ(fit.explanations[0].what, "the sign of mode 1 at 'u2'");
}

// As many numbers as unknowns say nothing of the size of residuals.
TEST(ModesSearch, NamesNothingWhereModesAreExactlyDetermined) {
  for (const double sign : {1.0, -1.0}) {
    IdentificationProblem problem = MeasuredModes(0.0, 0, SomeStiffness(), 2);
    problem.modal.modes.resize(1);
    problem.modal.modes[0].frequency_sigma = 0.0;
    problem.modal.modes[0].shape_sigma = 0.0;
    problem.modal.modes[0].shape[1] *= sign;
    const IdentificationSummary fit = IdentifyModes(problem).summary;
    EXPECT_TRUE(fit.explanations.empty()) << fit.explanations[0].what;
  }
}

Matrix SpringsOfChain(int dofs) {
  Matrix stiffness = 200.0 * Matrix::Identity(dofs, dofs);
  stiffness(dofs - 1, dofs - 1) = 100.0;
  stiffness.diagonal(1).setConstant(-100.0);
  stiffness.diagonal(-1).setConstant(-100.0);
  return stiffness;
}

// Large models are not searched without standard deviations.
TEST(ModesSearch, IsBoundedByTheDofs) {
  for (const int dofs : {5, 201}) {
    IdentificationProblem problem = MeasuredModes(0.0, 0, SomeStiffness(), 2);
    auto dynamics = std::make_shared<StructuralDynamics>(
        MakeStructuralModel(Matrix::Identity(dofs, dofs),
                            Matrix::Zero(dofs, dofs), SpringsOfChain(dofs)),
        std::vector<InputSpec>());
    GroupTerm all;
    all.group.name = all.alpha.name = "k";
    all.group.matrix = dynamics->model().stiffness;
    all.alpha.free = true;
    std::string error;
    ASSERT_TRUE(dynamics->AddGroup(all, &error)) << error;
    problem.dynamics = dynamics;
    problem.modal.modes.resize(1);
    problem.modal.modes[0].frequency_sigma = 0.0;
    problem.modal.modes[0].shape_sigma = 0.0;
    FitSummary fit;
    fit.modes.resize(1);
    ASSERT_FALSE(fit.modes[0].InUse());
    IdentifiedModel model;
    model.parameters = ParameterLayout(problem).InitialValues();
    InnerFit inner;
    ModesSearch search(problem, IdentificationOptions(), fit, model, &inner);
    EXPECT_EQ(search.Run(), dofs == 5);
  }
}

// The mass in place of changed groups that explains the modes. Healthy modes
// know the stiffness to 1 %.
std::string MassInsteadOf(const IdentificationProblem& problem,
                          const std::string& changed) {
  const Identification found = IdentifyModes(problem);
  InnerFit inner;
  std::vector<std::string> groups;
  for (const GroupTerm& term : problem.dynamics->groups()) {
    groups.push_back(term.group.name);
  }
  const GroupState healthy{SomeStiffness(), 1e-4 * Matrix::Identity(5, 5)};
  return MassInstead(problem, IdentificationOptions(), found.model, groups,
                     {healthy}, {{changed, SomeStiffness()[3]}}, &inner);
}

TEST(MassInstead, IsNamedWhereAMassWasAdded) {
  const IdentificationProblem problem =
      MeasuredModes(0.25, 2, SomeStiffness(), 3);
  const std::string group = problem.dynamics->groups()[3].group.name;
  EXPECT_THAT(MassInsteadOf(problem, group), HasSubstr("the mass at u3"));
}

TEST(MassInstead, IsNoneWhereStiffnessWasLost) {
  Vector alpha = SomeStiffness();
  alpha[3] -= 0.25;
  const IdentificationProblem problem = MeasuredModes(0.0, 0, alpha, 4);
  const std::string group = problem.dynamics->groups()[3].group.name;
  EXPECT_EQ(MassInsteadOf(problem, group), "");
}

}  // namespace
}  // namespace pinode
