#include "pinode/discover/smoothed_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "pinode/structure/model/structural_model.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int kNumSmoothed = 201;

// u1 = sin(2 t) and u2 = cos(3 t): u1 by its displacement, twice as large and
// upside down, u2 by its own, and a channel that shows both.
class TwoMotions : public ::testing::Test {
 protected:
  void SetUp() override {
    problem_.dynamics = std::make_shared<StructuralDynamics>(
        MakeStructuralModel(Matrix::Identity(2, 2), Matrix::Zero(2, 2),
                            Matrix::Identity(2, 2)),
        std::vector<InputSpec>());
    record_.name = "both";
    record_.excitation.emplace(0.0, 0.02, Matrix(0, kNumSmoothed),
                               Interpolation::kLinear);
    for (int i = 0; i < kNumSmoothed; ++i) {
      u1_[i] = std::sin(2.0 * 0.02 * i);
      u2_[i] = std::cos(3.0 * 0.02 * i);
    }
    AddChannel("u1", -2.0, 0.0);
    AddChannel("u2", 0.0, 1.0);
    AddChannel("sum", 1.0, 1.0);
  }

  void AddChannel(const std::string& name, double on_u1, double on_u2) {
    MeasuredChannel channel;
    channel.observation.name = name;
    channel.observation.weights = Eigen::Vector2d(on_u1, on_u2);
    channel.values = on_u1 * u1_ + on_u2 * u2_;
    record_.channels.push_back(channel);
  }

  Vector u1_ = Vector(kNumSmoothed);
  Vector u2_ = Vector(kNumSmoothed);
  IdentificationProblem problem_;
  IdentificationRecord record_;
  SmoothedRecord smoothed_;
  std::string error_;
};

TEST_F(TwoMotions, EachFromItsOwnChannel) {
  // A channel that shows both must not be used.
  record_.channels[2].values.setConstant(7.0);
  record_.channels[2].sigma = 0.25;
  ASSERT_TRUE(SmoothRecord(problem_, record_, &smoothed_, &error_)) << error_;
  for (int i = 10; i < kNumSmoothed - 10; ++i) {
    const double t = 0.02 * i;
    ASSERT_NEAR(smoothed_.states(0, i), u1_[i], 1e-4);
    ASSERT_NEAR(smoothed_.states(1, i), u2_[i], 1e-4);
    ASSERT_NEAR(smoothed_.states(2, i), 2.0 * std::cos(2.0 * t), 1e-3);
    ASSERT_EQ(smoothed_.rates(0, i), smoothed_.states(2, i));
    ASSERT_NEAR(smoothed_.rates(3, i), -9.0 * u2_[i], 0.03);
  }
  EXPECT_GT(smoothed_.noise[0], 0.0);
  EXPECT_EQ(smoothed_.noise[2], 0.25);
}

TEST_F(TwoMotions, ADofThatNoChannelShowsAloneIsNamed) {
  record_.channels[1].fit = false;
  EXPECT_FALSE(SmoothRecord(problem_, record_, &smoothed_, &error_));
  EXPECT_THAT(error_, HasSubstr("record 'both', DOF 'u2'"));
  EXPECT_THAT(error_, HasSubstr("no displacement channel of it alone"));
}

TEST(WellKnownSamples, LeavesOutWhatAnyDofKnowsLittleOf) {
  Matrix sigma = Matrix::Ones(2, 6);
  sigma(0, 0) = 5.0;
  sigma(1, 5) = 2.1;
  sigma(1, 1) = 1.9;
  EXPECT_THAT(WellKnownSamples(sigma), ElementsAre(1, 2, 3, 4));
}

}  // namespace
}  // namespace pinode
