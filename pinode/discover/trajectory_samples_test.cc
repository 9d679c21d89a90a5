#include "pinode/discover/trajectory_samples.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "pinode/problem/parameter_layout.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;

// x'' = -4 x from x = 1, so x = cos(2 t); two training records, one held out
// between them.
class SampledOscillator : public ::testing::Test {
 protected:
  void SetUp() override {
    problem_.dynamics = std::make_shared<StructuralDynamics>(
        MakeStructuralModel(Matrix::Identity(1, 1), Matrix::Zero(1, 1),
                            Matrix::Constant(1, 1, 4.0)),
        std::vector<InputSpec>());
    IdentificationRecord record;
    record.name = "free";
    record.excitation.emplace(0.0, 0.05, Matrix(0, 41), Interpolation::kLinear);
    record.substeps = 3;
    problem_.records = {record, record, record};
    problem_.records[1].role = IdentificationRecord::Role::kHoldout;
    problem_.records[2].substeps = 1;
    model_.parameters = ParameterLayout(problem_).InitialValues();
    model_.starts = {Vector::Unit(2, 0), Vector(), Vector::Unit(2, 0)};
  }

  IdentificationProblem problem_;
  IdentifiedModel model_;
  TrajectorySamples samples_;
  std::string error_;
};

TEST_F(SampledOscillator, EveryStepOfTheTrainingRecords) {
  ASSERT_TRUE(SampleTrajectories(problem_, model_, &samples_, &error_))
      << error_;
  EXPECT_EQ(samples_.num_samples(), 40 * 3 + 1 + 40 + 1);
  EXPECT_THAT(samples_.record_starts, ElementsAre(0, 121));
  EXPECT_THAT(samples_.strides, ElementsAre(3, 1));
  for (int i = 0; i < samples_.num_samples(); ++i) {
    const double time = i < 121 ? 0.05 / 3.0 * i : 0.05 * (i - 121);
    ASSERT_NEAR(samples_.times[i], time, 1e-12);
    ASSERT_NEAR(samples_.states(0, i), std::cos(2.0 * time), 1e-5);
    ASSERT_EQ(samples_.rates(0, i), samples_.states(1, i));
    ASSERT_DOUBLE_EQ(samples_.rates(1, i), -4.0 * samples_.states(0, i));
  }
}

TEST_F(SampledOscillator, FeaturesSeeTheStates) {
  ASSERT_TRUE(SampleTrajectories(problem_, model_, &samples_, &error_))
      << error_;
  const Matrix values = FeatureValues(
      {Feature::Velocity(0), Feature::Displacement(0)}, 1, samples_);
  EXPECT_EQ(values.col(0), samples_.states.row(1).transpose());
  EXPECT_EQ(values.col(1), samples_.states.row(0).transpose());
}

TEST_F(SampledOscillator, ARunThatEndsNowhereIsNamed) {
  model_.starts[2][1] = std::nan("");
  EXPECT_FALSE(SampleTrajectories(problem_, model_, &samples_, &error_));
  EXPECT_THAT(error_, ::testing::HasSubstr("record 'free'"));
  EXPECT_THAT(error_, ::testing::HasSubstr("not finite from t = 0 on"));
}

}  // namespace
}  // namespace pinode
