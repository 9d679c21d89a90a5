#include "pinode/estimate/start/initial_states.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pinode/base/statistics.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/estimate/shooting/trajectory_outline.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

// Three DOFs seen by accelerometers alone, under ground motion, moving when the
// record begins.
class InitialStatesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto dynamics = testing::MakeGroupedChain(3, 50.0, 0.5);
    IdentificationRecord record =
        testing::MakeExcitedRecord(*dynamics, 600, 0.02);
    for (int i = 0; i < 3; ++i) {
      record.channels.push_back(testing::MakeChannel(
          "a" + std::to_string(i + 1), Quantity::kAbsoluteAcceleration, 3, i));
    }
    Vector start(6);
    start << 0.02, 0.05, 0.07, 0.1, -0.2, 0.15;
    truth_ =
        testing::Simulate(*dynamics, Vector::Zero(3), start, 0.0, 1, &record);
    record.start = IdentificationRecord::Start::kFree;
    problem_.records.push_back(record);
    problem_.dynamics = dynamics;
  }
  IdentificationProblem problem_;
  Matrix truth_;
};

TEST_F(InitialStatesTest, AccelerationsAloneGiveTheStates) {
  const ParameterLayout layout(problem_);
  MultipleShooting shooting(problem_, layout, MultipleShooting::Options());
  Vector sigmas(3);
  for (int c = 0; c < 3; ++c) {
    sigmas[c] =
        0.05 * StandardDeviationOfPresent(
                   problem_.records[0].channels[static_cast<size_t>(c)].values);
  }
  shooting.SetSigmas({sigmas});
  TrajectoryOutlines trajectories;
  std::vector<Matrix> states;
  ASSERT_TRUE(InitialTrajectories(problem_, 25, Vector::Zero(3), StageTuning(),
                                  &shooting, &trajectories));
  ASSERT_TRUE(RunTrajectories(shooting, trajectories, &states));
  ASSERT_GT(shooting.record(0).num_segments(), 3);
  ASSERT_EQ(states.size(), 1u);
  ASSERT_EQ(states[0].cols(), truth_.cols());
  const auto inside = truth_.middleCols(60, 480);
  const auto error = states[0].middleCols(60, 480) - inside;
  for (int k = 0; k < 6; ++k) {
    EXPECT_LT(error.row(k).norm(), 0.02 * inside.row(k).norm())
        << problem_.dynamics->StateNames()[static_cast<size_t>(k)];
  }
}

TEST_F(InitialStatesTest, ScalesAreRmsAndNeverZero) {
  Matrix states = Matrix::Zero(6, 4);
  states.row(0) << 1.0, -1.0, 1.0, -1.0;
  states.row(1) << 3.0, 0.0, 0.0, 0.0;
  states.row(4) << 0.0, 20.0, 0.0, 0.0;
  const Vector scales = StateScales(problem_, states);
  EXPECT_DOUBLE_EQ(scales[0], 1.0);
  EXPECT_DOUBLE_EQ(scales[1], 1.5);
  EXPECT_DOUBLE_EQ(scales[2], 1.5e-3);
  EXPECT_DOUBLE_EQ(scales[3], 1e-2);
  EXPECT_DOUBLE_EQ(scales[4], 10.0);
  EXPECT_GT(StateScales(problem_, Matrix::Zero(6, 4)).minCoeff(), 0.0);
}

}  // namespace
}  // namespace pinode
