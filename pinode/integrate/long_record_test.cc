// Records of more samples than an int can count. Without inputs a grid of them
// takes no memory.

#include <gtest/gtest.h>

#include <string>
#include <type_traits>

#include "pinode/base/logging.h"
#include "pinode/integrate/free_run.h"
#include "pinode/integrate/history_pass.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/integrate/segment.h"
#include "tests/support/dynamics_testing.h"

namespace pinode {
namespace {

constexpr Eigen::Index kLongSamples = 5000000000;
constexpr int kLongPart = 300;  // at the end of them
constexpr double kLongStep = 0.015625;

static_assert(sizeof(Eigen::Index) == 8, "sizes are 64 bits");
static_assert(
    std::is_same_v<decltype(IntegrationGrid().num_samples()), Eigen::Index>);
static_assert(
    std::is_same_v<decltype(Trajectory().num_samples()), Eigen::Index>);
static_assert(
    std::is_same_v<decltype(Trajectory::failed_sample), Eigen::Index>);
static_assert(
    std::is_same_v<decltype(SegmentTangents::failed_sample), Eigen::Index>);

TEST(LongRecord, AGridCountsItsSamplesAndSteps) {
  const IntegrationGrid grid(-1.0, kLongStep, kLongSamples, 1000);
  EXPECT_EQ(grid.num_samples(), kLongSamples);
  EXPECT_EQ(grid.num_intervals(), kLongSamples - 1);
  EXPECT_EQ(grid.time(kLongSamples - 1), -1.0 + kLongStep * 4999999999.0);
  Matrix nodes;
  grid.GetNodes(kLongSamples - 11, 10, &nodes);
  EXPECT_EQ(nodes.size(), 0);
}

TEST(LongRecord, IsPassedInPieces) {
  const int pieces = HistoryPass::NumPieces(kLongSamples);
  EXPECT_EQ(pieces, 2441407);  // of 2048 samples
  EXPECT_EQ(HistoryPass::PieceOf(kLongSamples - 1), pieces - 1);
  EXPECT_EQ(HistoryPass::PieceOf(2048 * Eigen::Index{2000000}), 2000000);
  EXPECT_LT(FairBound(0, pieces, 1, 2, 0.1), pieces);
}

class LongRecordRun : public ::testing::Test {
 protected:
  LongRecordRun()
      : dynamics_(testing::MakeChain(2, 40.0, 0.1), {}),
        observation_(
            dynamics_,
            {{"x", Quantity::kDisplacement, Vector::Unit(2, 0)},
             {"a", Quantity::kRelativeAcceleration, Vector::Unit(2, 1)}}),
        long_(0.0, kLongStep, kLongSamples, 2),
        short_(0.0, kLongStep, kLongPart, 2),
        start_(Vector::LinSpaced(4, -1.0, 0.5)) {
    std::string error;
    CHECK(dynamics_.Prepare(Vector(), &prepared_, &error)) << error;
  }

  const StructuralDynamics dynamics_;
  StructuralDynamics::Prepared prepared_;
  const ObservationMap observation_;
  const IntegrationGrid long_;
  const IntegrationGrid short_;
  const Vector start_;
};

// Nothing depends on time: the last samples are like the first ones.
TEST_F(LongRecordRun, EndsAsItBegins) {
  for (const int last : {40, kLongPart - 1}) {  // by steps, by modes
    Trajectory begin, end;
    ASSERT_TRUE(FreeRun(dynamics_, prepared_, observation_, short_, start_, 0,
                        last, &begin));
    const Eigen::Index first = kLongSamples - 1 - last;
    ASSERT_TRUE(FreeRun(dynamics_, prepared_, observation_, long_, start_,
                        first, kLongSamples - 1, &end));
    EXPECT_EQ(end.first_sample, first);
    EXPECT_EQ(end.states, begin.states);
    EXPECT_EQ(end.channels, begin.channels);
  }
}

TEST_F(LongRecordRun, AndSoDoDerivatives) {
  for (const auto method :
       {DerivativeMethod::kTangents, DerivativeMethod::kJets}) {
    SegmentPropagator propagator(dynamics_, method);
    SegmentTangents begin, end;
    ASSERT_TRUE(propagator.Propagate(prepared_, observation_, short_, start_, 0,
                                     kLongPart - 1, true,
                                     SegmentColumns::kStart, &begin));
    ASSERT_TRUE(propagator.Propagate(prepared_, observation_, long_, start_,
                                     kLongSamples - kLongPart, kLongSamples - 1,
                                     true, SegmentColumns::kStart, &end));
    EXPECT_EQ(end.channels, begin.channels);
    EXPECT_EQ(end.jacobian(), begin.jacobian());
    EXPECT_EQ(end.end_sensitivity, begin.end_sensitivity);
  }
}

TEST_F(LongRecordRun, SaysWhereItFails) {
  const StructuralDynamics growing(testing::MakeChain(2, 40.0, -900.0), {});
  StructuralDynamics::Prepared prepared;
  std::string error;
  ASSERT_TRUE(growing.Prepare(Vector(), &prepared, &error)) << error;
  const Eigen::Index first = kLongSamples - kLongPart;
  Trajectory begin, end;
  EXPECT_FALSE(FreeRun(growing, prepared, observation_, short_, start_, 0,
                       kLongPart - 1, &begin));
  EXPECT_FALSE(FreeRun(growing, prepared, observation_, long_, start_, first,
                       kLongSamples - 1, &end));
  ASSERT_GT(begin.failed_sample, 0);
  EXPECT_EQ(end.failed_sample, first + begin.failed_sample);
}

}  // namespace
}  // namespace pinode
