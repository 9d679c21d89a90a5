#include "pinode/integrate/parallel_segment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/dynamics_testing.h"
#include "tests/support/integrate_testing.h"

namespace pinode {
namespace {

constexpr int kLongRun = 2100;

// Hysteresis, and prescribed motion: a state that only the input moves.
class ParallelSegmentTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string error;
    dynamics_ = std::make_unique<StructuralDynamics>(
        testing::MakeChain(3, 10.0, 0.5),
        std::vector<InputSpec>{
            {InputSpec::Kind::kForce, 1, "force"},
            {InputSpec::Kind::kPrescribedDisplacement, 2, "x"},
            {InputSpec::Kind::kPrescribedVelocity, 2, "v"},
            {InputSpec::Kind::kPrescribedAcceleration, 2, "a"}});
    testing::AddGroupsOfAllKinds(SpringMatrix(3, 0, 1), dynamics_.get());
    ASSERT_TRUE(dynamics_->AddElement("slip", "bouc_wen", 0, 1,
                                      {1.0, 5.0, 2.0, 1.0, 2.0}, &error))
        << error;
    ASSERT_TRUE(
        dynamics_->Prepare(dynamics_->Parameters(), &prepared_, &error));
    Matrix inputs(4, kLongRun);
    for (int i = 0; i < kLongRun; ++i) {
      const double t = 0.05 * i;
      inputs.col(i) << std::sin(1.3 * t) + std::cos(0.4 * t),
          0.1 * std::sin(2.0 * t), 0.2 * std::cos(2.0 * t),
          -0.4 * std::sin(2.0 * t);
    }
    grid_ = IntegrationGrid(
        Excitation(0.0, 0.05, inputs, Interpolation::kLinear), 2);
    observation_ = testing::ChannelRunner(*dynamics_).observation;
    start_ = Vector::LinSpaced(dynamics_->num_states(), -0.3, 0.4);
  }

  std::unique_ptr<StructuralDynamics> dynamics_;
  StructuralDynamics::Prepared prepared_;
  ObservationMap observation_;
  IntegrationGrid grid_;
  Vector start_;
};

class ParallelSegmentColumns
    : public ParallelSegmentTest,
      public ::testing::WithParamInterface<SegmentColumns> {};

TEST_P(ParallelSegmentColumns, AreThoseOfOneThread) {
  SegmentPropagator one(*dynamics_, DerivativeMethod::kTangents);
  ParallelSegment three(*dynamics_, DerivativeMethod::kTangents, 3);
  for (const bool observe_last : {false, true}) {
    SegmentTangents expected, result;
    ASSERT_TRUE(one.Propagate(prepared_, observation_, grid_, start_, 7,
                              kLongRun - 2, observe_last, GetParam(),
                              &expected));
    ASSERT_TRUE(three.Propagate(prepared_, observation_, grid_, start_, 7,
                                kLongRun - 2, observe_last, GetParam(),
                                &result));
    ASSERT_EQ(result.jacobian().rows(), expected.jacobian().rows());
    ASSERT_EQ(result.jacobian().cols(), expected.jacobian().cols());
    EXPECT_LT((result.channels - expected.channels).norm(),
              1e-12 * expected.channels.norm());
    EXPECT_LT((result.end_state - expected.end_state).norm(),
              1e-12 * expected.end_state.norm());
    EXPECT_LT((result.jacobian() - expected.jacobian()).norm(),
              1e-11 * expected.jacobian().norm());
    EXPECT_LT((result.end_sensitivity - expected.end_sensitivity).norm(),
              1e-11 * expected.end_sensitivity.norm() + 1e-14);
  }
}

INSTANTIATE_TEST_SUITE_P(Columns, ParallelSegmentColumns,
                         ::testing::Values(SegmentColumns::kStart,
                                           SegmentColumns::kParameters,
                                           SegmentColumns::kAll));

TEST_F(ParallelSegmentTest, SaysWhereItFails) {
  start_[0] = 1e200;
  ParallelSegment two(*dynamics_, DerivativeMethod::kTangents, 2);
  SegmentTangents result;
  EXPECT_FALSE(two.Propagate(prepared_, observation_, grid_, start_, 0,
                             kLongRun - 1, true, SegmentColumns::kAll,
                             &result));
  EXPECT_EQ(result.failed_sample, 0);
  EXPECT_EQ(result.failed_state, 0);
}

TEST_F(ParallelSegmentTest, IsNotForShortSegmentsNorLinearModels) {
  ParallelSegment two(*dynamics_, DerivativeMethod::kTangents, 2);
  EXPECT_TRUE(two.IsWorthwhile(grid_, 0, kLongRun - 1, SegmentColumns::kAll));
  EXPECT_FALSE(two.IsWorthwhile(grid_, 0, 900, SegmentColumns::kAll));
  EXPECT_FALSE(two.IsWorthwhile(grid_, 0, kLongRun - 1, SegmentColumns::kNone));
  const StructuralDynamics linear(
      testing::MakeChain(3, 10.0, 0.5),
      std::vector<InputSpec>{{InputSpec::Kind::kForce, 1, "force"}});
  EXPECT_FALSE(ParallelSegment(linear, DerivativeMethod::kTangents, 2)
                   .IsWorthwhile(grid_, 0, kLongRun - 1, SegmentColumns::kAll));
}

}  // namespace
}  // namespace pinode
