#include "pinode/case/renewed_basis.h"

#include <functional>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/case/checkpoint_file.h"
#include "pinode/case/finite_element_section.h"
#include "pinode/case/rod_testing.h"
#include "pinode/structure/modal_analysis.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class RenewedBasisTest : public RodCaseTest {
 protected:
  Case RodOrFail() {
    return ReadOrFail(Replaced(kRodCase, "method = \"guyan\"",
                               "method = \"guyan\"\nrenew = true"));
  }

  // The groups `lower`, `upper` and `brace` at these values.
  static IdentifiedModel At(const Case& c, double lower, double upper,
                            double brace) {
    IdentifiedModel model;
    model.parameters = c.problem.dynamics->Parameters();
    model.parameters << lower, upper, brace;
    return model;
  }

  static Matrix StiffnessOf(const Case& c, const IdentifiedModel& model) {
    return c.problem.dynamics->CorrectedModel(model.parameters).stiffness;
  }
};

// Springs in a row: three of half the stiffness below the first sensor; one of
// these and three whole ones between the two, beside the brace.
TEST_F(RenewedBasisTest, IsExactWhereTheParametersAre) {
  const Case c = RodOrFail();
  ASSERT_TRUE(RenewsBasis(c));
  const IdentifiedModel found = At(c, -0.5, 0.0, 2.0);
  Matrix exact(2, 2);
  const double between = kSpring / 5.0 + 200.0;
  exact << kSpring / 6.0 + between, -between, -between, between;
  // With the exported model's basis the deflection is the wrong one.
  EXPECT_NEAR(StiffnessOf(c, found)(1, 1), kSpring * 7.0 / 32.0 + 200.0, 1e-8);

  Case renewed;
  IdentifiedModel begin;
  std::string error;
  ASSERT_TRUE(RenewBasis(c, found, &renewed, &begin, &error)) << error;
  EXPECT_EQ(begin.parameters, found.parameters);
  EXPECT_NE(ProblemHash(renewed.problem), ProblemHash(c.problem));
  EXPECT_EQ(ProblemIdentity(renewed.problem), ProblemIdentity(c.problem));
  EXPECT_LT((StiffnessOf(renewed, begin) - exact).norm(), 1e-9 * kSpring);
  // Groups are shares of the export still.
  ASSERT_EQ(renewed.finite_element->groups.size(), 3u);
  EXPECT_LT(
      (Matrix(renewed.finite_element->groups[0].matrix) - Matrix(Rod(1.0, 0.0)))
          .norm(),
      1e-8);
  // And once more from there.
  Case again;
  ASSERT_TRUE(RenewBasis(renewed, At(c, 0.0, 0.0, 0.0), &again, &begin, &error))
      << error;
  EXPECT_LT((again.problem.dynamics->model().stiffness -
             c.problem.dynamics->model().stiffness)
                .norm(),
            1e-9 * kSpring);
  EXPECT_EQ(ProblemIdentity(again.problem), ProblemIdentity(c.problem));
}

TEST_F(RenewedBasisTest, DampingFollows) {
  const Case c = RodOrFail();
  const IdentifiedModel found = At(c, -0.5, 0.0, 0.0);
  Case renewed;
  IdentifiedModel begin;
  std::string error;
  ASSERT_TRUE(RenewBasis(c, found, &renewed, &begin, &error)) << error;
  const StructuralModel model =
      renewed.problem.dynamics->CorrectedModel(begin.parameters);
  ModalProperties modes;
  ASSERT_TRUE(
      ComputeModes(model.mass, model.damping, model.stiffness, &modes, &error))
      << error;
  EXPECT_NEAR(modes.damping_ratio[0], 0.02, 1e-12);
}

TEST_F(RenewedBasisTest, RefusesWhatHasNoModes) {
  const Case c = RodOrFail();
  Case renewed;
  IdentifiedModel begin;
  std::string error;
  // Springs that push.
  EXPECT_FALSE(RenewBasis(c, At(c, -0.5, -1.5, 0.0), &renewed, &begin, &error));
  EXPECT_THAT(error, HasSubstr("[model.reduction]"));
}

TEST_F(RenewedBasisTest, RefusesPointsThatAreNone) {
  const auto refusal = [this](const std::string& at) {
    return Refusal("method = \"guyan\"",
                   "method = \"guyan\"\nbasis_at = {" + at + "}");
  };
  EXPECT_THAT(refusal("lowest = 0.1"),
              AllOf(HasSubstr(":12: "), HasSubstr("'lowest' is not a group")));
  EXPECT_THAT(refusal("lower = \"low\""), HasSubstr("expected a"));
}

// A fit that finds `lower` at half of where the basis was taken plus 0.1, so
// that 0.2 is where it settles, each time half as far away.
struct HalvingFit {
  int calls = 0;
  int interrupted_at = 0;
  int unusable_at = 0;

  void operator()(const std::string&, const Case& c,
                  const IdentifiedModel* begin, IdentificationSummary* summary,
                  IdentifiedModel* model) {
    ++calls;
    *model = *begin;
    model->parameters[0] = 0.1 + 0.5 * begin->parameters[0];
    summary->termination = calls == interrupted_at ? Termination::kInterrupted
                                                   : Termination::kConverged;
    summary->usable = calls != interrupted_at && calls != unusable_at;
    summary->message = "of the test";
    ParameterEstimate lower;
    lower.name = "lower";
    lower.value = model->parameters[0];
    lower.sigma = 0.1;
    summary->parameters = {lower};
    EXPECT_EQ(c.options.shooting, IdentificationOptions::Shooting::kSingle);
  }
};

class UntilSettledTest : public RenewedBasisTest {
 protected:
  void SetUp() override {
    RenewedBasisTest::SetUp();
    c_ = RodOrFail();
    model_ = At(c_, 0.0, 0.0, 0.0);
    ParameterEstimate lower;
    lower.name = "lower";
    lower.sigma = 0.1;
    summary_.parameters = {lower};
    summary_.termination = Termination::kConverged;
    summary_.usable = true;
  }

  double BasisAt() const {
    return StiffnessOf(c_, At(c_, 0.0, 0.0, 0.0))(1, 1);
  }

  Case c_;
  IdentificationSummary summary_;
  IdentifiedModel model_;
};

// 0.1, 0.15, 0.175: the last move is a quarter of a standard error.
TEST_F(UntilSettledTest, EndsWhereMovesAreSmall) {
  HalvingFit fit;
  RenewBasisUntilSettled(std::ref(fit), &c_, &summary_, &model_);
  EXPECT_EQ(fit.calls, 3);
  EXPECT_NEAR(model_.parameters[0], 0.175, 1e-15);
  EXPECT_TRUE(summary_.usable);
  ASSERT_FALSE(c_.problem.description.remarks.empty());
  EXPECT_EQ(c_.problem.description.remarks.back(),
            "The basis of the reduction was taken again at the values found, "
            "3 times; the last time they moved by at most 0.25 standard "
            "errors.");
  EXPECT_NE(c_.options.shooting, IdentificationOptions::Shooting::kSingle);
}

TEST_F(UntilSettledTest, KeepsTheLastUsableFit) {
  HalvingFit fit;
  fit.unusable_at = 2;
  RenewBasisUntilSettled(std::ref(fit), &c_, &summary_, &model_);
  EXPECT_EQ(model_.parameters[0], 0.1);
  EXPECT_TRUE(summary_.usable);
  ASSERT_FALSE(c_.problem.description.remarks.empty());
  EXPECT_THAT(c_.problem.description.remarks.back(),
              HasSubstr("could not be renewed: of the test"));
}

TEST_F(UntilSettledTest, AnInterruptLeavesWhatAResumptionBeginsFrom) {
  HalvingFit fit;
  fit.interrupted_at = 2;
  const double before = BasisAt();
  RenewBasisUntilSettled(std::ref(fit), &c_, &summary_, &model_);
  EXPECT_EQ(model_.parameters[0], 0.0);
  EXPECT_EQ(BasisAt(), before);
  EXPECT_EQ(summary_.termination, Termination::kInterrupted);
  EXPECT_FALSE(summary_.usable);
}

}  // namespace
}  // namespace pinode
