#include "pinode/record/sample_faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/record/channel_faults.h"
#include "pinode/record/files/array_table.h"
#include "pinode/record/table.h"
#include "tests/support/gaussian_testing.h"
#include "tests/support/measured_data_testing.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr Eigen::Index kLength = 1000;
constexpr double kSamplingStep = 0.01;

// White noise as a load and the acceleration of an oscillator that it drives (2
// Hz, 2 % damping), with a little noise; or driven by `load`.
std::vector<WatchedSignal> Shaken(Vector load = Vector()) {
  testing::Gaussian random(5);
  if (load.size() == 0) {
    load.resize(kLength);
    for (double& value : load) value = random.Next();
  }
  Vector response(kLength);
  double x = 0.0;
  double v = 0.0;
  const double omega = 4.0 * kPi;
  for (Eigen::Index k = 0; k < kLength; ++k) {
    const double a = load[k] - 0.04 * omega * v - omega * omega * x;
    response[k] = a + 0.02 * random.Next();
    v += kSamplingStep * a;
    x += kSamplingStep * v;
  }
  return {{"ground x", "m/s^2", WatchedSignal::Kind::kLoad, load},
          {"channel a1", "m/s^2", WatchedSignal::Kind::kResponse, response}};
}

std::vector<std::string> FaultsOf(const std::vector<WatchedSignal>& signals) {
  return FindSampleFaults(signals, 10.0, kSamplingStep, "s");
}

TEST(SampleFaults, NamesMarksOfMissingSamples) {
  std::vector<WatchedSignal> signals = Shaken();
  signals[1].values.segment(400, 5).setConstant(-9999.0);
  EXPECT_THAT(FaultsOf(signals),
              ElementsAre(AllOf(HasSubstr("channel a1: 5 samples are -9999 "
                                          "m/s^2, the first at 14 s"),
                                HasSubstr("Empty cells are read as missing"))));
  // The same with empty cells, and with any number of them.
  signals[1].values.segment(100, 200).setConstant(-9999.0);
  signals[1].values.segment(700, 20).setConstant(kNaN);
  EXPECT_THAT(FaultsOf(signals),
              ElementsAre(HasSubstr("205 samples are -9999 m/s^2")));
}

TEST(SampleFaults, NamesASpike) {
  std::vector<WatchedSignal> signals = Shaken();
  signals[1].values[500] += 1000.0;
  EXPECT_THAT(FaultsOf(signals),
              ElementsAre(AllOf(HasSubstr("channel a1: the sample at 15 s, "),
                                HasSubstr("Check this sample."))));
  // A load without any response to it, and a temperature.
  signals = Shaken();
  signals[0].values[500] = 100.0;
  EXPECT_THAT(
      FaultsOf(signals),
      ElementsAre(AllOf(HasSubstr("ground x: the sample at 15 s, 100 m/s^2"),
                        HasSubstr("did not feel"))));
  signals[0].kind = WatchedSignal::Kind::kCovariate;
  EXPECT_THAT(FaultsOf(signals),
              ElementsAre(HasSubstr("ground x: the sample")));
}

// Within the range of a slow signal.
TEST(SampleFaults, NamesASpikeAmongItsNeighbours) {
  std::vector<WatchedSignal> signals = Shaken();
  for (Eigen::Index k = 0; k < kLength; ++k) {
    signals[1].values[k] = 5.0 * std::sin(0.02 * static_cast<double>(k));
  }
  signals[1].values[300] += 1.0;
  EXPECT_THAT(FaultsOf(signals),
              ElementsAre(HasSubstr("channel a1: the sample at 13 s")));
}

TEST(SampleFaults, LeavesBlowsAlone) {
  // One sample each, and the response to it.
  Vector load = Vector::Zero(kLength);
  testing::Gaussian random(9);
  for (double& value : load) value = 0.01 * random.Next();
  load[200] = 50.0;
  load[600] = 80.0;
  EXPECT_THAT(FaultsOf(Shaken(load)), IsEmpty());
  // Before a step of the load's level.
  load.tail(300).array() += 5.0;
  EXPECT_THAT(FaultsOf(Shaken(load)), IsEmpty());
  // The load of a simulation, a pulse alone.
  load.setZero();
  load.segment(100, 3).setConstant(20.0);
  EXPECT_THAT(FaultsOf(Shaken(load)), IsEmpty());
}

TEST(SampleFaults, NamesWhatHangsOrIsReadTooRarely) {
  std::vector<WatchedSignal> signals = Shaken();
  Vector held = signals[1].values;
  for (Eigen::Index k = 0; k < kLength; ++k) held[k] = held[k - k % 10];
  signals[1].values = held;
  EXPECT_THAT(
      FaultsOf(signals),
      ElementsAre(HasSubstr(" % of its samples are equal to the one before")));
  // A load may be held.
  signals = Shaken();
  signals[0].values = held;
  EXPECT_THAT(FaultsOf(signals), IsEmpty());

  signals = Shaken();
  signals[1].values.segment(300, 40).setConstant(signals[1].values[300]);
  EXPECT_THAT(FaultsOf(signals),
              ElementsAre(AllOf(HasSubstr("channel a1: stays at "),
                                HasSubstr("for 40 samples from 13 s on"))));
}

TEST(SampleFaults, NamesWhatIsClipped) {
  std::vector<WatchedSignal> signals = Shaken();
  Vector& values = signals[1].values;
  const double limit = 0.5 * values.maxCoeff();
  values = values.cwiseMin(limit).cwiseMax(-limit);
  EXPECT_THAT(FaultsOf(signals),
              ElementsAre(HasSubstr("channel a1: is clipped")));
}

// Coarse loggers repeat values at the turning points of a slow motion, and in
// small motions.
TEST(SampleFaults, LeavesCoarseLoggersAlone) {
  std::vector<WatchedSignal> signals = Shaken();
  for (Eigen::Index k = 0; k < kLength; ++k) {
    signals[1].values[k] =
        std::round(50.0 * std::sin(0.02 * static_cast<double>(k)));
  }
  EXPECT_THAT(FaultsOf(signals), IsEmpty());
  signals = Shaken();
  const double largest = signals[1].values.maxCoeff();
  signals[1].values =
      (signals[1].values / largest * 6.0).array().round().matrix();
  EXPECT_THAT(FaultsOf(signals), IsEmpty());
}

TEST(SampleFaults, NamesAColumnTakenTwice) {
  std::vector<WatchedSignal> signals = Shaken();
  signals.push_back(signals[1]);
  signals[2].label = "channel a2";
  EXPECT_THAT(FaultsOf(signals),
              ElementsAre(HasSubstr("channel a2: is channel a1 again")));
}

// No false alarms on a shake table and its frames.
TEST(SampleFaults, LeavesMeasuredRecordsAlone) {
  PINODE_FIND_MEASURED_DATA(folder, "mini_shake_table");
  const std::vector<std::string> columns = {"ground_ax", "floor1_ax",
                                            "floor2_ax", "floor3_ax"};
  for (const char* frame : {"flexible", "stiff"}) {
    for (const char* motion : {"northridge", "sine_1p0", "sine_1p5"}) {
      const std::string path =
          folder + "/" + frame + "3story_" + motion + ".csv";
      Table table;
      std::string error;
      ASSERT_TRUE(ReadTable(path, columns, {}, &table, &error)) << error;
      std::vector<WatchedSignal> signals;
      for (size_t c = 0; c < columns.size(); ++c) {
        signals.push_back({columns[c], "m/s^2",
                           c == 0 ? WatchedSignal::Kind::kLoad
                                  : WatchedSignal::Kind::kResponse,
                           table.values.col(static_cast<Eigen::Index>(c))});
      }
      EXPECT_THAT(FaultsOf(signals), IsEmpty()) << path;
      signals[2].values[signals[2].values.size() / 2] = -999.0;
      EXPECT_THAT(FaultsOf(signals),
                  ElementsAre(HasSubstr("floor2_ax: the sample at")))
          << path;
    }
  }
}

TEST(SampleFaults, SaysNothingOfShortOrInfiniteColumns) {
  std::vector<WatchedSignal> signals = Shaken();
  for (WatchedSignal& signal : signals) {
    signal.values = signal.values.head(20).eval();
  }
  signals[1].values[5] = 1e6;
  EXPECT_THAT(FaultsOf(signals), IsEmpty());
  signals = Shaken();
  signals[1].values[5] = kInfinity;
  EXPECT_THAT(FaultsOf(signals), IsEmpty());
  EXPECT_THAT(FindOutliers(Vector()).samples, IsEmpty());
  EXPECT_THAT(FindOutliers(Vector::Constant(100, kNaN)).samples, IsEmpty());
  EXPECT_THAT(FindOutliers(Vector::Zero(100)).samples, IsEmpty());
}

// Records of ambient vibration have no load that tells blows from codes.
TEST(ChannelFaultsTest, CodesForMissingValues) {
  Matrix samples(2, 2000);
  for (Eigen::Index i = 0; i < samples.cols(); ++i) {
    const double t = 0.01 * static_cast<double>(i);
    samples(0, i) = std::sin(19.0 * t) + 0.3 * std::sin(57.0 * t);
    samples(1, i) = std::cos(19.0 * t) - 0.4 * std::sin(57.0 * t);
  }
  EXPECT_TRUE(FindChannelFaults({"a", "b"}, samples).empty());
  // One sample far out may be a blow.
  samples(0, 300) = -9999.0;
  EXPECT_TRUE(FindChannelFaults({"a", "b"}, samples).empty());
  samples(0, 301) = samples(0, 900) = -9999.0;
  const std::vector<std::string> faults =
      FindChannelFaults({"a", "b"}, samples);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0],
            "Channel 'a' has 3 samples of -9999 (unit and gain applied; the "
            "first is sample 301), far from all others: perhaps a code for "
            "missing values. Write nan in their place.");
}

}  // namespace
}  // namespace pinode
