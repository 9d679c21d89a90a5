#include "pinode/study/reduction/renewed_basis.h"

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/study/reduction/finite_element_result.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/identify_testing.h"
#include "tests/support/rod_testing.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using InBasis = ReducedStructure::Group::InBasis;

ReducedStructure::Group SetOfElements(const SparseMatrix& matrix) {
  ReducedStructure::Group group;
  group.matrix = matrix;
  group.in_basis = InBasis::kReduced;
  group.is_element_set = true;
  return group;
}

// The rod with its first node held, reduced to nodes 4 and 8: groups `lower`
// and `upper` of its springs, and `brace` beside them.
class RenewedBasisTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ReducedStructure& rod = rod_.structure;
    for (int i = 0; i < kNodes; ++i) {
      rod.exported.dof_names.push_back(std::to_string(i + 1) + ".1");
    }
    rod.exported.mass.resize(kNodes, kNodes);
    rod.exported.mass.setIdentity();
    rod.exported.mass *= 2.0;
    rod.exported.stiffness = Rod(1.0, 1.0);
    rod.removed_dofs = {0};
    rod.model = RemoveDofs(rod.exported, rod.removed_dofs);
    rod.options.method = ReductionMethod::kGuyan;
    rod.options.kept_dofs = {"4.1", "8.1"};
    rod.is_reduced = true;
    rod.damping_rule.emplace();
    rod.damping_rule->kind = DampingRule::Kind::kRatios;
    rod.damping_rule->ratios = Vector::Constant(1, 0.02);
    rod.directions = {"x"};
    rod.influence = Matrix::Ones(kNodes - 1, 1);
    rod.groups = {SetOfElements(Rod(1.0, 0.0)), SetOfElements(Rod(0.0, 1.0)),
                  SpringGroup(rod, 100.0, 0, 1)};
    std::string error;
    StructuralModel model;
    ASSERT_TRUE(SetBasisPoint({}, &rod, &error)) << error;
    ASSERT_TRUE(Reduce(&rod, &error)) << error;
    ASSERT_TRUE(MakeReducedModel(&rod, &model, &error)) << error;
    StructureTerms terms;
    const char* const kNames[] = {"lower", "upper", "brace"};
    for (size_t j = 0; j < 3; ++j) {
      GroupTerm term;
      term.group.name = term.alpha.name = kNames[j];
      term.group.matrix = 100.0 * SpringMatrix(2, 0, 1);
      ASSERT_TRUE(GroupInBasis(rod, &rod.groups[j], &term.group.matrix, &error))
          << error;
      terms.groups.push_back(term);
    }
    terms.groups[1].present = 2.0;
    IdentificationProblem& problem = rod_.problem;
    ASSERT_TRUE(Assemble(model,
                         {{InputSpec::Kind::kGroundAcceleration, 0, "ag"}},
                         terms, &problem.dynamics, &error))
        << error;
    IdentificationRecord record =
        testing::MakeExcitedRecord(*problem.dynamics, 100, 0.01);
    record.channels = {
        testing::MakeChannel("a1", Quantity::kAbsoluteAcceleration, 2, 1)};
    record.channels[0].values = Vector::Zero(100);
    problem.records = {record};
    ChooseStepsOrFail(&problem);
  }

  // The groups `lower`, `upper` and `brace` at these values.
  static IdentifiedModel At(double lower, double upper, double brace) {
    IdentifiedModel model;
    model.parameters = Vector{{lower, upper, brace}};
    return model;
  }

  static Matrix StiffnessOf(const ReducedProblem& rod,
                            const IdentifiedModel& model) {
    return rod.problem.dynamics->CorrectedModel(model.parameters).stiffness;
  }

  ReducedProblem rod_;
};

// Springs in a row: three of half the stiffness below the first sensor; one of
// these and three whole ones between the two, beside the brace.
TEST_F(RenewedBasisTest, IsExactWhereTheParametersAre) {
  const IdentifiedModel found = At(-0.5, 0.0, 2.0);
  Matrix exact(2, 2);
  const double between = kSpring / 5.0 + 200.0;
  exact << kSpring / 6.0 + between, -between, -between, between;
  // With the exported model's basis the deflection is the wrong one.
  EXPECT_NEAR(StiffnessOf(rod_, found)(1, 1), kSpring * 7.0 / 32.0 + 200.0,
              1e-8);

  ReducedProblem renewed;
  IdentifiedModel begin;
  std::string error;
  ASSERT_TRUE(RenewBasis(rod_, found, &renewed, &begin, &error)) << error;
  EXPECT_EQ(begin.parameters, found.parameters);
  EXPECT_LT((StiffnessOf(renewed, begin) - exact).norm(), 1e-9 * kSpring);
  // Groups are shares of the export still.
  ASSERT_EQ(renewed.structure.groups.size(), 3u);
  EXPECT_LT((Matrix(renewed.structure.groups[0].matrix) - Matrix(Rod(1.0, 0.0)))
                .norm(),
            1e-8);
  EXPECT_EQ(renewed.problem.dynamics->groups()[1].present, 2.0);
  // And once more from there.
  ReducedProblem again;
  ASSERT_TRUE(RenewBasis(renewed, At(0.0, 0.0, 0.0), &again, &begin, &error))
      << error;
  EXPECT_LT((again.problem.dynamics->model().stiffness -
             rod_.problem.dynamics->model().stiffness)
                .norm(),
            1e-9 * kSpring);
}

TEST_F(RenewedBasisTest, DampingFollows) {
  ReducedProblem renewed;
  IdentifiedModel begin;
  std::string error;
  ASSERT_TRUE(RenewBasis(rod_, At(-0.5, 0.0, 0.0), &renewed, &begin, &error))
      << error;
  const StructuralModel model =
      renewed.problem.dynamics->CorrectedModel(begin.parameters);
  ModalProperties modes;
  ASSERT_TRUE(
      ComputeModes(model.mass, model.damping, model.stiffness, &modes, &error))
      << error;
  EXPECT_NEAR(modes.damping_ratio[0], 0.02, 1e-12);

  // Rayleigh's, of which a group in proportion to K is a part.
  rod_.structure.damping_rule->kind = DampingRule::Kind::kRayleigh;
  rod_.structure.damping_rule->rayleigh = {0.3, 0.001};
  ASSERT_TRUE(RenewBasis(rod_, At(-0.5, 0.0, 0.0), &renewed, &begin, &error))
      << error;
  const Matrix whole =
      0.6 * Matrix::Identity(kNodes, kNodes) + 0.001 * Matrix(Rod(0.5, 1.0));
  EXPECT_LT((Matrix(renewed.structure.damping) - whole).norm(), 1e-10);
}

TEST_F(RenewedBasisTest, RefusesWhatDoesNotFitTogether) {
  ReducedProblem renewed;
  IdentifiedModel begin;
  std::string error;
  // Springs that push.
  EXPECT_FALSE(RenewBasis(rod_, At(-0.5, -1.5, 0.0), &renewed, &begin, &error));
  EXPECT_FALSE(error.empty());
  IdentifiedModel other = At(0.0, 0.0, 0.0);
  other.parameters.conservativeResize(2);
  EXPECT_FALSE(RenewBasis(rod_, other, &renewed, &begin, &error));
  EXPECT_THAT(error, HasSubstr("other parameters"));
  ReducedProblem bad = rod_;
  bad.structure.groups.pop_back();
  EXPECT_FALSE(RenewBasis(bad, At(0.0, 0.0, 0.0), &renewed, &begin, &error));
  EXPECT_THAT(error, HasSubstr("not that of the reduced structure"));
  bad = rod_;
  bad.structure.removed_dofs = {9};
  EXPECT_FALSE(RenewBasis(bad, At(0.0, 0.0, 0.0), &renewed, &begin, &error));
  EXPECT_THAT(error, HasSubstr("removed"));
  bad = rod_;
  bad.structure.influence = Matrix::Ones(3, 1);
  EXPECT_FALSE(RenewBasis(bad, At(0.0, 0.0, 0.0), &renewed, &begin, &error));
  EXPECT_THAT(error, HasSubstr("influence"));
}

// What goes back to the finite-element program: lower springs of 0.9 and upper
// ones of 2.4 / 2 of the export.
TEST_F(RenewedBasisTest, GoesBackToTheExport) {
  StructuralDynamics dynamics = *rod_.problem.dynamics;
  dynamics.SetParameters(Vector{{-0.1, 0.4, 0.0}});
  const FiniteElementModel updated = UpdatedExport(rod_.structure, dynamics);
  EXPECT_LT((Matrix(updated.stiffness) - Matrix(Rod(0.9, 1.4))).norm(), 1e-9);
  EXPECT_FALSE(updated.has_damping());
  FitSummary summary;
  ParameterEstimate upper;
  upper.name = "upper";
  upper.value = 0.4;
  upper.sigma = 0.02;
  upper.lower95 = 0.36;
  upper.upper95 = 0.44;
  upper.free = true;
  summary.parameters = {upper};
  const std::vector<ElementFactor> factors =
      ElementFactors(rod_.structure, dynamics, summary);
  ASSERT_EQ(factors.size(), 2u);
  EXPECT_DOUBLE_EQ(factors[0].factor, 0.9);
  EXPECT_DOUBLE_EQ(factors[1].factor, 1.2);
  EXPECT_DOUBLE_EQ(factors[1].sigma, 0.01);
  EXPECT_DOUBLE_EQ(factors[1].lower95, 1.18);
  WholeModes modes;
  std::string error;
  ASSERT_TRUE(ModesOfWhole(rod_.structure, dynamics, &modes, &error)) << error;
  ASSERT_EQ(modes.shapes.rows(), kNodes);
  ASSERT_EQ(modes.shapes.cols(), 2);
  EXPECT_EQ(modes.shapes.row(0).norm(), 0.0);
  // A third of the way to node 4.
  EXPECT_NEAR(modes.shapes(1, 0), modes.shapes(3, 0) / 3.0, 1e-12);
  rod_.structure.expanded_dofs = {3, 1};
  const Matrix response = ExpandedResponse(rod_.structure, Matrix::Ones(4, 5));
  EXPECT_NEAR(response(0, 2), 1.0, 1e-12);
  EXPECT_NEAR(response(1, 2), 1.0 / 3.0, 1e-12);
}

// A fit that finds `lower` at half of where the basis was taken plus 0.1, so
// that 0.2 is where it settles, each time half as far away.
struct HalvingFit : InnerFit {
  int calls = 0;
  int interrupted_at = 0;
  int unsound_at = 0;

  void Run(const std::string&, const IdentificationProblem&,
           const IdentificationOptions& options, const IdentifiedModel* begin,
           FitSummary* summary, IdentifiedModel* model) override {
    ++calls;
    *model = *begin;
    model->parameters[0] = 0.1 + 0.5 * begin->parameters[0];
    summary->termination = calls == interrupted_at ? Termination::kInterrupted
                                                   : Termination::kConverged;
    summary->stalled = calls == unsound_at;
    summary->message = "of the test";
    ParameterEstimate lower;
    lower.name = "lower";
    lower.value = model->parameters[0];
    lower.sigma = 0.1;
    summary->parameters = {lower};
    EXPECT_EQ(options.shooting, IdentificationOptions::Shooting::kSingle);
  }
};

class UntilSettledTest : public RenewedBasisTest {
 protected:
  void SetUp() override {
    RenewedBasisTest::SetUp();
    model_ = At(0.0, 0.0, 0.0);
    ParameterEstimate lower;
    lower.name = "lower";
    lower.sigma = 0.1;
    summary_.parameters = {lower};
    summary_.termination = Termination::kConverged;
  }

  double BasisAt() const { return StiffnessOf(rod_, At(0.0, 0.0, 0.0))(1, 1); }

  FitSummary summary_;
  IdentifiedModel model_;
};

// 0.1, 0.15, 0.175: the last move is a quarter of a standard error.
TEST_F(UntilSettledTest, EndsWhereMovesAreSmall) {
  HalvingFit fit;
  RenewBasisUntilSettled({}, &fit, &rod_, &summary_, &model_);
  EXPECT_EQ(fit.calls, 3);
  EXPECT_NEAR(model_.parameters[0], 0.175, 1e-15);
  EXPECT_THAT(WhyNotSound(GapTuning(), summary_), IsEmpty());
  ASSERT_FALSE(rod_.problem.description.remarks.empty());
  EXPECT_EQ(rod_.problem.description.remarks.back(),
            "The basis of the reduction was taken again at the values found, "
            "3 times; the last time they moved by at most 0.25 standard "
            "errors.");
}

TEST_F(UntilSettledTest, KeepsTheLastSoundFit) {
  HalvingFit fit;
  fit.unsound_at = 2;
  RenewBasisUntilSettled({}, &fit, &rod_, &summary_, &model_);
  EXPECT_EQ(model_.parameters[0], 0.1);
  EXPECT_THAT(WhyNotSound(GapTuning(), summary_), IsEmpty());
  ASSERT_FALSE(rod_.problem.description.remarks.empty());
  EXPECT_THAT(
      rod_.problem.description.remarks.back(),
      HasSubstr("could not be renewed: the fit stopped before a minimum"));
}

TEST_F(UntilSettledTest, AnInterruptLeavesWhatAResumptionBeginsFrom) {
  HalvingFit fit;
  fit.interrupted_at = 2;
  const double before = BasisAt();
  RenewBasisUntilSettled({}, &fit, &rod_, &summary_, &model_);
  EXPECT_EQ(model_.parameters[0], 0.0);
  EXPECT_EQ(BasisAt(), before);
  EXPECT_EQ(summary_.termination, Termination::kInterrupted);
}

}  // namespace
}  // namespace pinode
