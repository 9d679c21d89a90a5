#include "pinode/estimate/certainty/fitted_cost.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <vector>

#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

// A two-DOF chain at rest first; its groups k1 and k2 are what they are in
// `truth`.
class FittedCostTest : public ::testing::Test {
 protected:
  void Make(const Vector& truth, double noise) {
    auto dynamics = testing::MakeGroupedChain(2, 30.0, 0.3);
    IdentificationRecord record =
        testing::MakeExcitedRecord(*dynamics, 400, 0.05);
    record.channels = {
        testing::MakeChannel("x1", Quantity::kDisplacement, 2, 0),
        testing::MakeChannel("x2", Quantity::kDisplacement, 2, 1)};
    record.start = IdentificationRecord::Start::kRest;
    RecordScore score;
    score.finite = true;
    score.states =
        testing::Simulate(*dynamics, truth, Vector::Zero(4), noise, 3, &record);
    scores_ = {score};
    problem_.records = {record};
    problem_.dynamics = dynamics;
  }

  FittedCost At(const Vector& parameters, double sigma) {
    const ParameterLayout layout(problem_);
    IdentifiedModel model;
    model.parameters = parameters;
    model.sigmas = {Vector::Constant(2, sigma)};
    FittedCost cost;
    EXPECT_TRUE(LinearizeAtFit(problem_, layout, model, scores_, 1, &cost));
    return cost;
  }

  IdentificationProblem problem_;
  std::vector<RecordScore> scores_;
};

// One step from where k2 was not known leads to it, but for the square of how
// far it is.
TEST_F(FittedCostTest, OneStepLeadsToAnUnknownThatTheFitLacked) {
  const Eigen::Vector2d fitted(0.1, -0.05);
  const Eigen::Vector2d truth(0.1, -0.045);
  Make(truth, 1e-9);
  const FittedCost cost = At(fitted, 0.01);
  const Vector step = -cost.system.hessian.llt().solve(cost.system.gradient);
  EXPECT_LT((fitted + step - truth).norm(), 2e-4);
  EXPECT_GT(step.norm(), 4e-3);
  // Half the noise, four times the weight.
  const FittedCost surer = At(fitted, 0.005);
  EXPECT_TRUE(surer.system.hessian.isApprox(4.0 * cost.system.hessian, 1e-9));
}

// White residuals have no memory; those of a lacking term do.
TEST_F(FittedCostTest, CountsTheMemoryOfTheResiduals) {
  const Eigen::Vector2d truth(0.1, -0.05);
  Make(truth, 0.05);
  EXPECT_LT(At(truth, 0.01).memory, 1.3);
  EXPECT_GT(At(truth + Eigen::Vector2d(0.0, 0.2), 0.01).memory, 2.0);
}

TEST_F(FittedCostTest, TheSystemAloneIsTheSame) {
  const Eigen::Vector2d truth(0.1, -0.05);
  Make(truth, 0.05);
  const Vector near = truth + Eigen::Vector2d(0.0, 0.2);
  const FittedCost cost = At(near, 0.01);
  IdentifiedModel model;
  model.parameters = near;
  model.sigmas = {Vector::Constant(2, 0.01)};
  const ParameterLayout layout(problem_);
  CondensedSystem system;
  ASSERT_TRUE(LinearizeAtFit(problem_, layout, model, scores_, 1, &system));
  EXPECT_EQ(system.cost, cost.system.cost);
  EXPECT_EQ(system.gradient, cost.system.gradient);
  EXPECT_EQ(system.hessian, cost.system.hessian);
  scores_[0].finite = false;
  EXPECT_FALSE(LinearizeAtFit(problem_, layout, model, scores_, 1, &system));
}

TEST_F(FittedCostTest, ARunThatIsNotFiniteHasNone) {
  Make(Eigen::Vector2d(0.1, -0.05), 0.01);
  scores_[0].finite = false;
  const ParameterLayout layout(problem_);
  IdentifiedModel model;
  model.parameters = layout.InitialValues();
  model.sigmas = {Vector::Constant(2, 0.01)};
  FittedCost cost;
  EXPECT_FALSE(LinearizeAtFit(problem_, layout, model, scores_, 1, &cost));
}

}  // namespace
}  // namespace pinode
