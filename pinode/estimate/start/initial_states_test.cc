#include "pinode/estimate/start/initial_states.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/statistics.h"
#include "pinode/dynamics/memory_network.h"
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

// Free decay of a hardening spring over seven periods: from rest the search for
// the start ends in another minimum.
TEST(InitialTrajectories, WholeRecordsBeginAtKnownStarts) {
  auto dynamics = std::make_shared<StructuralDynamics>(
      MakeStructuralModel(Matrix::Ones(1, 1), Matrix::Constant(1, 1, 0.08),
                          Matrix::Ones(1, 1), {"u"}),
      std::vector<InputSpec>());
  std::string error;
  ASSERT_TRUE(dynamics->AddLaw(
      testing::MakeElement("spring", "cubic", 1, Feature::kGround, 0, {0.8}),
      &error))
      << error;
  IdentificationRecord record;
  record.name = "free";
  record.excitation.emplace(0.0, 0.1, Matrix(0, 400), Interpolation::kLinear);
  record.start = IdentificationRecord::Start::kFree;
  record.substeps = 2;
  record.channels = {testing::MakeChannel("x", Quantity::kDisplacement, 1, 0),
                     testing::MakeChannel("v", Quantity::kVelocity, 1, 0)};
  const Vector truth = Eigen::Vector2d(1.5, 0.0);
  testing::Simulate(*dynamics, dynamics->Parameters(), truth, 0.01, 1, &record);
  IdentificationProblem problem;
  problem.dynamics = dynamics;
  problem.records = {record};
  const ParameterLayout layout(problem);
  const auto start_from = [&](const std::vector<Vector>& known) {
    MultipleShooting shooting(problem, layout, MultipleShooting::Options());
    shooting.SetSigmas({Vector(Eigen::Vector2d(0.01, 0.01))});
    TrajectoryOutlines trajectories;
    EXPECT_TRUE(
        InitialTrajectories(problem, 0, layout.Free(layout.InitialValues()),
                            StageTuning(), &shooting, &trajectories, known));
    return Vector(shooting.starts()[0].col(0));
  };
  const Vector near = Eigen::Vector2d(1.45, 0.05);
  EXPECT_LT((start_from({near}) - truth).norm(), 0.01);
  EXPECT_GT((start_from({}) - truth).norm(), 0.1);
  // A start that is far off does no harm beyond that of none.
  const Vector far = Eigen::Vector2d(-30.0, 100.0);
  EXPECT_LT((start_from({far}) - start_from({})).norm(), 1e-6);
}

// The dissipated energies are numbers, and do not grow at rest.
TEST(GuessStateScales, EnergiesDoNotDependOnTheUnits) {
  const auto internal_of = [](double length) {
    auto dynamics = testing::MakeGroupedChain(1, 50.0, 0.5);
    MemoryNetworkShape shape;
    shape.deformation = 0.02 * length;
    shape.rate = 0.1 * length;
    shape.force = 2.0 * length;
    std::string error;
    const Vector weights = MemoryNetwork(shape).DrawWeights(2);
    EXPECT_TRUE(dynamics->AddLaw(
        MakeMemoryNetwork("device", shape,
                          {Feature::Displacement(0), Feature::Velocity(0)}, 1,
                          weights, 3.0),
        &error))
        << error;
    EXPECT_TRUE(dynamics->AddElement(
        "baber", "baber_noori", Feature::kGround, 0,
        {40.0, 0.8 * length, 0.5, 1.0, 0.1, 0.1, 0.0, 0.5, 0.1, 0.2, 0.0, 0.5},
        &error))
        << error;
    IdentificationRecord record =
        testing::MakeExcitedRecord(*dynamics, 100, 0.02);
    record.channels = {
        testing::MakeChannel("x", Quantity::kDisplacement, 1, 0)};
    record.channels[0].values.resize(100);
    for (int i = 0; i < 100; ++i) {
      record.channels[0].values[i] = 0.03 * length * std::sin(0.14 * i);
    }
    IdentificationProblem problem;
    problem.dynamics = dynamics;
    problem.records = {record};
    return Vector(GuessStateScales(problem, record).tail(4));
  };
  const Vector metres = internal_of(1.0);
  EXPECT_TRUE(internal_of(1000.0).isApprox(metres, 1e-9))
      << internal_of(1000.0).transpose() << ", " << metres.transpose();
  // A quarter of a cycle to 1.5 of its deformation scale.
  EXPECT_GT(metres[1], 0.1);
  EXPECT_LT(metres[1], 30.0);
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
