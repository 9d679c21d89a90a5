#include "pinode/estimate/fit/ways.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "pinode/estimate/shooting/score.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// Two storeys under the ground's motion with a cubic spring, which is 0 to
// begin with and 30 in the record.
class WaysTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto chain = testing::MakeGroupedChain(2, 40.0, 0.4);
    dynamics_ = std::make_shared<StructuralDynamics>(*chain);
    std::string error;
    ASSERT_TRUE(dynamics_->AddElement("spring", "cubic", Feature::kGround, 0,
                                      {30.0}, &error))
        << error;
    record_.name = "r";
    record_.start = IdentificationRecord::Start::kRest;
    record_.substeps = 2;
    Matrix ground(1, 600);
    for (int i = 0; i < 600; ++i) {
      const double t = 0.05 * i;
      ground(0, i) = 3.0 * std::sin(4.1 * t) + 2.0 * std::sin(9.7 * t + 1.0);
    }
    record_.excitation.emplace(0.0, 0.05, ground, Interpolation::kLinear);
    for (int dof = 0; dof < 2; ++dof) {
      MeasuredChannel channel;
      channel.observation.name = "x" + std::to_string(dof + 1);
      channel.observation.quantity = Quantity::kDisplacement;
      channel.observation.weights = Vector::Unit(2, dof);
      record_.channels.push_back(channel);
    }
  }

  IdentificationProblem Problem(double noise, const Vector& truth) {
    testing::Simulate(*dynamics_, truth, Vector::Zero(4), noise, 3, &record_);
    Vector begin = dynamics_->Parameters();
    begin.setZero();
    auto start = std::make_shared<StructuralDynamics>(*dynamics_);
    start->SetParameters(begin);
    IdentificationProblem problem;
    problem.dynamics = start;
    problem.records = {record_};
    return problem;
  }

  std::shared_ptr<StructuralDynamics> dynamics_;
  IdentificationRecord record_;
};

TEST_F(WaysTest, LinearPartHasTheSameParametersAndFewerFreeOnes) {
  const Vector truth = dynamics_->Parameters();
  const IdentificationProblem problem = Problem(0.01, truth);
  const auto linear = LinearPart(problem);
  ASSERT_NE(linear, nullptr);
  const ParameterLayout all(problem), less(*linear);
  EXPECT_EQ(less.num_parameters(), all.num_parameters());
  EXPECT_EQ(less.num_free(), 2);
  EXPECT_EQ(all.num_free(), 3);
  EXPECT_EQ(LinearPart(*linear), nullptr) << "that is the problem itself";
  // A spring that begins at zero does nothing, and all is solved as a linear
  // model is; one that does not is there, and stays.
  EXPECT_TRUE(linear->dynamics->IsLinear());
  IdentificationProblem stiff = problem;
  auto dynamics = std::make_shared<StructuralDynamics>(*dynamics_);
  dynamics->SetParameters(truth);
  stiff.dynamics = dynamics;
  EXPECT_FALSE(LinearPart(stiff)->dynamics->IsLinear());
}

TEST_F(WaysTest, EndsWhereOnlyNoiseIsLeft) {
  Vector truth = dynamics_->Parameters();
  truth.head(2) << -0.2, 0.15;
  const IdentificationProblem problem = Problem(0.02, truth);
  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(problem, IdentificationOptions(), nullptr, &summary,
                       &model);
  EXPECT_TRUE(summary.usable()) << summary.message;
  // The minimum was reached, not only approached: no step promises a decrease.
  EXPECT_LT(summary.promised_share, 1e-12);
  EXPECT_EQ(summary.way, "linear terms first, then all on whole records");
  EXPECT_LT((model.parameters - truth).cwiseQuotient(truth).norm(), 0.05);
  // The cubic spring is worth having.
  EXPECT_GT(summary.linear_error, 2.0 * summary.records[0].nrmse);
  EXPECT_GT(summary.records[0].channels[0].noise_share, 0.8);
}

// The residual is a motion that the model cannot have. Both routes are tried,
// and the result is no worse than that of either alone, or than the linear
// terms.
TEST_F(WaysTest, TriesBothWhereMoreThanNoiseIsLeft) {
  Vector truth = dynamics_->Parameters();
  truth.head(2) << -0.2, 0.15;
  IdentificationProblem problem = Problem(0.0, truth);
  Vector& values = problem.records[0].channels[1].values;
  const double size = values.norm() / std::sqrt(values.size());
  for (int i = 0; i < values.size(); ++i) {
    values[i] += 0.3 * size * std::sin(0.11 * i);
  }
  IdentificationSummary summary, single;
  IdentifiedModel model;
  IdentificationOptions options;
  testing::FitAndJudge(problem, options, nullptr, &summary, &model);
  EXPECT_THAT(summary.way, HasSubstr("stages of multiple shooting"));
  EXPECT_THAT(summary.way, HasSubstr("linear terms first"));
  options.shooting = IdentificationOptions::Shooting::kSingle;
  testing::FitAndJudge(problem, options, nullptr, &single, &model);
  EXPECT_EQ(single.way, "");
  EXPECT_EQ(single.linear_error, kInfinity);
  EXPECT_LE(summary.records[0].nrmse, 1.001 * single.records[0].nrmse);
  EXPECT_LE(summary.records[0].nrmse, summary.linear_error);
}

// Without the spring nothing but groups is left: whole records first, and the
// stages only where that leaves more than noise.
TEST_F(WaysTest, LinearModelsAreFittedOnWholeRecordsFirst) {
  const auto chain = testing::MakeGroupedChain(2, 40.0, 0.4);
  dynamics_ = std::make_shared<StructuralDynamics>(*chain);
  const Vector truth = Eigen::Vector2d(-0.2, 0.15);
  IdentificationProblem problem = Problem(0.02, truth);
  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(problem, IdentificationOptions(), nullptr, &summary,
                       &model);
  EXPECT_TRUE(summary.usable()) << summary.message;
  EXPECT_EQ(summary.way, "whole records at once");
  EXPECT_EQ(summary.stages.size(), 1u);
  EXPECT_LT((model.parameters - truth).norm(), 0.02);

  Vector& values = problem.records[0].channels[1].values;
  const double size = values.norm() / std::sqrt(values.size());
  for (int i = 0; i < values.size(); ++i) {
    values[i] += 0.3 * size * std::sin(0.11 * i);
  }
  testing::FitAndJudge(problem, IdentificationOptions(), nullptr, &summary,
                       &model);
  EXPECT_THAT(summary.way, HasSubstr("whole records at once"));
  EXPECT_THAT(summary.way, HasSubstr("stages of multiple shooting"));
}

// Whole records come first. Where they leave more than noise, the stages are
// tried as well.
TEST_F(WaysTest, AFitFromAStartTriesWholeRecordsFirst) {
  Vector truth = dynamics_->Parameters();
  truth.head(2) << -0.2, 0.15;
  IdentificationProblem problem = Problem(0.02, truth);
  IdentificationSummary summary, direct;
  IdentifiedModel start, model, other;
  testing::FitAndJudge(problem, IdentificationOptions(), nullptr, &direct,
                       &start);
  start.parameters[0] += 0.1;
  testing::FitAndJudge(problem, IdentificationOptions(), &start, &summary,
                       &model);
  EXPECT_TRUE(summary.usable()) << summary.message;
  EXPECT_EQ(summary.way, "whole records at once");
  EXPECT_EQ(summary.stages.size(), 1u);
  EXPECT_NEAR(summary.records[0].nrmse, direct.records[0].nrmse, 1e-6);

  Vector& values = problem.records[0].channels[1].values;
  const double size = values.norm() / std::sqrt(values.size());
  for (int i = 0; i < values.size(); ++i) {
    values[i] += 0.3 * size * std::sin(0.11 * i);
  }
  testing::FitAndJudge(problem, IdentificationOptions(), &start, &summary,
                       &other);
  EXPECT_THAT(summary.way, HasSubstr("stages of multiple shooting"));
}

}  // namespace
}  // namespace pinode
