#include "pinode/study/damage/change_explanations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/structure/model/modal_analysis.h"
#include "pinode/study/damage/damage_analysis.h"
#include "pinode/study/identify/identify.h"
#include "tests/support/identify_testing.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// A chain of four masses between two walls: spring j and spring 6 - j are
// mirror images, so that frequencies alone do not tell them apart.
StructuralDynamics ChainBetweenWalls() {
  constexpr int kMasses = 4;
  StructuralModel model;
  model.mass = Matrix::Identity(kMasses, kMasses);
  model.damping = Matrix::Zero(kMasses, kMasses);
  model.stiffness = Matrix::Zero(kMasses, kMasses);
  std::vector<Matrix> springs;
  for (int j = 0; j <= kMasses; ++j) {
    const int from = j == 0 ? Feature::kGround : j - 1;
    const int to = j == kMasses ? Feature::kGround : j;
    springs.push_back(1000.0 * (to == Feature::kGround
                                    ? SpringMatrix(kMasses, to, from)
                                    : SpringMatrix(kMasses, from, to)));
    model.stiffness += springs.back();
  }
  for (int i = 0; i < kMasses; ++i) {
    model.dof_names.push_back("u" + std::to_string(i + 1));
  }
  model.influence = Matrix::Zero(kMasses, 0);
  model.support_mass_coupling = Matrix::Zero(kMasses, 0);
  StructuralDynamics dynamics(model, {});
  for (size_t j = 0; j < springs.size(); ++j) {
    GroupTerm term;
    term.group.name = "k" + std::to_string(j + 1);
    term.group.matrix = springs[j];
    term.alpha.name = term.group.name;
    term.alpha.prior_sigma = 0.1;
    std::string error;
    EXPECT_TRUE(dynamics.AddGroup(term, &error)) << error;
  }
  return dynamics;
}

// Frequencies of the chain with these factors, with deviations of 1e-4.
Identification FitOfFrequencies(const Vector& alpha) {
  const StructuralDynamics dynamics = ChainBetweenWalls();
  const StructuralModel truth = dynamics.CorrectedModel(alpha);
  ModalProperties modes;
  std::string error;
  EXPECT_TRUE(
      ComputeModes(truth.mass, truth.damping, truth.stiffness, &modes, &error))
      << error;
  IdentificationProblem problem;
  problem.dynamics = std::make_shared<StructuralDynamics>(dynamics);
  for (int i = 0; i < 4; ++i) {
    MeasuredMode mode;
    mode.name = "mode " + std::to_string(i + 1);
    mode.frequency = modes.frequency_hz[i];
    mode.frequency_sigma = 1e-4 * mode.frequency;
    problem.modal.modes.push_back(mode);
  }
  Identification fit = Identify(std::move(problem), IdentificationOptions());
  EXPECT_TRUE(fit.summary.usable()) << fit.summary.message;
  return fit;
}

DamageResult AnalyseLoss(const Vector& healthy, const Vector& now) {
  const Identification before = FitOfFrequencies(healthy);
  const Identification after = FitOfFrequencies(now);
  Baseline baseline;
  std::string error;
  EXPECT_TRUE(BaselineFrom("healthy", before.problem, before.summary,
                           before.model, &baseline, &error))
      << error;
  DamageResult result;
  EXPECT_TRUE(AnalyseDamage(after.problem, after.summary, after.model,
                            {baseline}, {}, &result, &error))
      << error;
  return result;
}

TEST(ChangeExplanations, MirrorImagesAreEquals) {
  const DamageResult result =
      AnalyseLoss(Vector::Zero(5), Vector{{0.0, -0.3, 0.0, 0.0, 0.0}});
  ASSERT_EQ(result.estimate.explanations.size(), 2u);
  std::vector<int> places;
  for (const ChangeExplanation& explanation : result.estimate.explanations) {
    ASSERT_EQ(explanation.changed.size(), 1u);
    places.push_back(explanation.changed[0]);
    EXPECT_NEAR(explanation.probability, 0.5, 1e-3);
    EXPECT_NEAR(explanation.changes[0].change, -0.3, 2e-3);
    EXPECT_LT(explanation.changes[0].lower95, -0.3);
    EXPECT_GT(explanation.changes[0].upper95, -0.3);
  }
  EXPECT_THAT(places, ::testing::UnorderedElementsAre(1, 3));
  EXPECT_EQ(result.judgement.verdict, DamageVerdict::kDamage);
  for (const char* text : {"k2 (-30 %)", "k4 (-30 %)", " or "}) {
    EXPECT_THAT(result.judgement.sentence, HasSubstr(text));
  }
  EXPECT_THAT(result.judgement.sentence, HasSubstr("50 % and 50 %"));
}

// The same structure as the model is not: priors of both sides must not count
// twice, and the frequencies are not linear over their width.
TEST(ChangeExplanations, SizesAreThoseOfTheChangedGroupsAlone) {
  const Vector healthy{{0.08, -0.12, 0.1, -0.05, -0.09}};
  for (const double loss : {0.05, 0.2, 0.5}) {
    Vector now = healthy;
    now[2] = (1.0 + healthy[2]) * (1.0 - loss) - 1.0;
    const DamageResult result = AnalyseLoss(healthy, now);
    ASSERT_FALSE(result.estimate.explanations.empty()) << loss;
    const ChangeExplanation& first = result.estimate.explanations[0];
    ASSERT_EQ(first.changed, std::vector<int>{2}) << loss;
    EXPECT_LT(first.changes[0].lower95, -loss);
    EXPECT_GT(first.changes[0].upper95, -loss);
    EXPECT_LT(first.changes[0].upper95 - first.changes[0].lower95, 0.08);
    EXPECT_TRUE(result.estimate.groups[2].changed);
    EXPECT_EQ(result.estimate.groups[2].change, first.changes[0].change);
  }
}

}  // namespace
}  // namespace pinode
