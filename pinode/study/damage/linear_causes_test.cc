#include "pinode/study/damage/linear_causes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "pinode/dynamics/feature.h"
#include "pinode/study/damage/damage_analysis.h"
#include "pinode/study/identify/identify.h"
#include "tests/support/identify_testing.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

Explanation ExplanationOf(const std::string& kind, double log_odds,
                          double leaves) {
  Explanation explanation;
  explanation.kind = kind;
  explanation.log_odds = log_odds;
  explanation.leaves = leaves;
  return explanation;
}

TEST(LinearCauses, ADamperHasTheRatioOfTheFirstMode) {
  // Two masses of 2 on springs of 300 and 100; damping 0.02 K / w1 is a ratio
  // of 0.01 in the first mode.
  StructuralModel model;
  model.dof_names = {"u1", "u2"};
  model.mass = 2.0 * Matrix::Identity(2, 2);
  model.stiffness = Matrix{{400.0, -100.0}, {-100.0, 100.0}};
  const double w1 =
      std::sqrt((500.0 - std::sqrt(500.0 * 500.0 - 4.0 * 30000.0)) / 4.0);
  model.damping = 0.02 / w1 * model.stiffness;
  std::vector<ChangeCandidate> found(3);
  found[0].subject.kind = ChangeKind::kMass;
  found[0].subject.name = "mass.u1";
  for (size_t i = 1; i < 3; ++i) {
    found[i].subject.kind = ChangeKind::kNonlinear;
    found[i].subject.place = "k2";
    found[i].from = 0;
    found[i].to = 1;
  }
  // Without a force among what was found, each spring is tried.
  EXPECT_TRUE(DampersToTry(model, {found[0]}, {}).empty());
  EXPECT_EQ(DampersToTry(model, {found[0]}, found).size(), 1u);
  const std::vector<std::vector<ChangeCandidate>> sets =
      DampersToTry(model, found, {});
  ASSERT_EQ(sets.size(), 1u);
  const std::vector<ChangeCandidate>& dampers = sets[0];
  ASSERT_EQ(dampers.size(), 2u);
  EXPECT_EQ(dampers[0].subject.name, "mass.u1");
  EXPECT_EQ(dampers[1].subject.kind, ChangeKind::kDamping);
  EXPECT_EQ(dampers[1].subject.place, "k2");
  const Matrix expected = 0.02 / w1 * Matrix{{100.0, -100.0}, {-100.0, 100.0}};
  EXPECT_LT((dampers[1].matrix - expected).cwiseAbs().maxCoeff(), 1e-9);
}

// Eigenvalues of [[a, b], [b, a]] are a + b and a - b.
TEST(LinearCauses, NegativeDampingIsThatOfAnyDirection) {
  EXPECT_FALSE(HasNegativeDamping(Matrix{{2.0, 1.9}, {1.9, 2.0}}));
  EXPECT_FALSE(HasNegativeDamping(Matrix{{2.0, 2.0}, {2.0, 2.0}}));
  EXPECT_TRUE(HasNegativeDamping(Matrix{{2.0, 2.1}, {2.1, 2.0}}));
  EXPECT_FALSE(HasNegativeDamping(Matrix::Zero(2, 2)));
  // The antisymmetric part does no work.
  EXPECT_FALSE(HasNegativeDamping(Matrix{{1.0, 9.0}, {-9.0, 1.0}}));
}

TEST(LinearCauses, EachOfManySpringsIsNotTried) {
  StructuralModel model;
  model.dof_names = {"u1"};
  model.mass = model.stiffness = Matrix::Identity(1, 1);
  model.damping = 0.02 * model.mass;
  std::vector<ChangeCandidate> springs(9);
  for (size_t i = 0; i < springs.size(); ++i) {
    springs[i].subject.kind = ChangeKind::kNonlinear;
    springs[i].subject.place = "k" + std::to_string(i + 1);
    springs[i].from = Feature::kGround;
    springs[i].to = 0;
  }
  EXPECT_TRUE(DampersToTry(model, {}, springs).empty());
  // Forces that were found are few.
  const auto instead = DampersToTry(model, springs, {});
  ASSERT_EQ(instead.size(), 1u);
  EXPECT_EQ(instead[0].size(), 9u);
  springs.pop_back();
  EXPECT_EQ(DampersToTry(model, {}, springs).size(), 8u);
}

TEST(LinearCauses, AFaultStandsForMoreChangesThanItHasParts) {
  const Explanation gain = ExplanationOf("excitation_scale", 500.0, 0.002);
  EXPECT_NE(FaultInsteadOfChanges({gain}, 2, 0.01), nullptr);
  EXPECT_EQ(FaultInsteadOfChanges({gain}, 1, 0.01), nullptr);
  EXPECT_EQ(FaultInsteadOfChanges({}, 5, 0.01), nullptr);
  const Explanation two =
      ExplanationOf("sensor_gain+sensor_delay", 500.0, 0.002);
  EXPECT_EQ(FaultInsteadOfChanges({two}, 2, 0.01), nullptr);
  EXPECT_NE(FaultInsteadOfChanges({two}, 3, 0.01), nullptr);
  // A mass is no fault, and leftover motion no explanation.
  EXPECT_EQ(FaultInsteadOfChanges({ExplanationOf("mass", 500.0, 0.0)}, 5, 0.01),
            nullptr);
  EXPECT_EQ(FaultInsteadOfChanges(
                {ExplanationOf("sensor_gain+mass", 500.0, 0.0)}, 5, 0.01),
            nullptr);
  EXPECT_EQ(FaultInsteadOfChanges(
                {ExplanationOf("excitation_scale", 500.0, 0.1)}, 5, 0.01),
            nullptr);
  // The changes leave less.
  EXPECT_EQ(FaultInsteadOfChanges(
                {ExplanationOf("excitation_scale", 500.0, 0.019)}, 5, 0.001),
            nullptr);
  // A mass that is as likely.
  EXPECT_EQ(FaultInsteadOfChanges({gain, ExplanationOf("mass", 499.5, 0.002)},
                                  5, 0.01),
            nullptr);
  EXPECT_NE(FaultInsteadOfChanges({gain, ExplanationOf("mass", 300.0, 0.002)},
                                  5, 0.01),
            nullptr);
}

// Drag and friction look like it, but the structure is linear.
TEST(LinearCauses, AnAddedDamperMakesNoStructureNonlinear) {
  const Vector alpha{{0.05, -0.02, 0.01}};
  const TestFit healthy = FitOf(MeasuredChain(3, *ChainAt(alpha), 1));
  Baseline baseline;
  std::string error;
  ASSERT_TRUE(BaselineFrom("spring", healthy.problem, healthy.summary,
                           healthy.model, &baseline, &error))
      << error;
  auto damped = ChainAt(alpha);
  GroupTerm damper;
  damper.group.name = "damper";
  damper.group.target = MatrixGroup::Target::kDamping;
  damper.group.matrix = Matrix{{1, -1, 0}, {-1, 1, 0}, {0, 0, 0}};
  damper.alpha.value = 1.0;
  ASSERT_TRUE(damped->AddGroup(damper, &error)) << error;
  Identification later =
      Identify(MeasuredChain(3, *damped, 5), {}, {}, nullptr);
  DamageAnalysisOptions options;
  options.search = LookEverywhere(later.problem);
  DamageResult result;
  ASSERT_TRUE(AnalyseDamage(later.problem, later.summary, later.model,
                            {baseline}, options, &result, &error))
      << error;
  EXPECT_EQ(result.judgement.verdict, DamageVerdict::kOtherChange)
      << result.judgement.sentence;
  EXPECT_THAT(result.judgement.sentence, HasSubstr("the damping of"));
}

}  // namespace
}  // namespace pinode
