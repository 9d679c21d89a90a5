#include "pinode/problem/motion_levels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/estimate_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// A record of two floors that move by sines of unit amplitude, times `first` in
// the first half and `second` in the other.
IdentificationProblem TwoHalves(double first, double second) {
  IdentificationProblem problem;
  problem.dynamics = testing::MakeGroupedChain(2, 100.0, 0.5);
  IdentificationRecord record =
      testing::MakeExcitedRecord(*problem.dynamics, 400, 0.05);
  const Eigen::Index n = record.num_samples();
  for (int i = 0; i < 2; ++i) {
    record.channels.push_back(testing::MakeChannel(
        "a" + std::to_string(i + 1), Quantity::kAbsoluteAcceleration, 2, i));
    Vector& values = record.channels.back().values;
    values.resize(n);
    for (Eigen::Index s = 0; s < n; ++s) {
      values[s] = (i + 1.0) * (2 * s < n ? first : second) *
                  std::sin(kTwoPi * static_cast<double>(s) / 20.0);
    }
  }
  problem.records.push_back(std::move(record));
  return problem;
}

TEST(MotionLevels, AreRmsOfPartsOfEqualEnergy) {
  IdentificationProblem problem = TwoHalves(1.0, 3.0);
  // Missing samples do not count.
  problem.records[0].channels[0].values[7] = kNaN;
  const std::vector<MotionLevel> levels = MotionLevels(problem);
  ASSERT_THAT(levels, SizeIs(2));
  EXPECT_EQ(levels[1].channel, "a2");
  EXPECT_EQ(levels[1].dof, problem.LocationOf(problem.records[0].channels[1]));
  EXPECT_EQ(levels[1].quantity, "absolute_acceleration");
  EXPECT_EQ(levels[1].unit, "m/s^2");
  // A tenth of the energy is in the first half, so that one part has all of it
  // and some of the second half; the other three parts lie in that.
  EXPECT_NEAR(levels[1].highest, 2.0 * 3.0 / kRootTwo, 0.3);
  EXPECT_GT(levels[1].lowest, 2.0 / kRootTwo);
  EXPECT_LT(levels[1].lowest, 2.0 * 2.2 / kRootTwo);
  EXPECT_GT(levels[1].mean, levels[1].lowest);
  EXPECT_LT(levels[1].mean, levels[1].highest);
  EXPECT_NEAR(levels[1].highest, 2.0 * levels[0].highest, 0.2);
  EXPECT_THAT(LevelSentence(levels), HasSubstr("m/s^2 RMS at sensor 'a2'"));
}

TEST(MotionLevels, JoinTrainingRecordsAlone) {
  IdentificationProblem problem = TwoHalves(1.0, 1.0);
  const double own = MotionLevels(problem)[0].mean;
  problem.records.push_back(TwoHalves(3.0, 3.0).records[0]);
  problem.records.push_back(TwoHalves(9.0, 9.0).records[0]);
  problem.records[2].role = IdentificationRecord::Role::kHoldout;
  problem.records[1].channels[1].fit = false;
  const std::vector<MotionLevel> levels = MotionLevels(problem);
  ASSERT_THAT(levels, SizeIs(2));
  EXPECT_NEAR(levels[0].mean, 2.0 * own, 1e-9);
  EXPECT_NEAR(levels[0].lowest, own, 0.1 * own);
  EXPECT_NEAR(levels[0].highest, 3.0 * own, 0.3 * own);
  EXPECT_NEAR(levels[1].highest, 2.0 * own, 0.2 * own);
}

TEST(MotionLevels, AmbientRecordsHaveThem) {
  IdentificationProblem problem = TwoHalves(1.0, 3.0);
  const std::vector<MotionLevel> wanted = MotionLevels(problem);
  AmbientRecord record;
  const IdentificationRecord& measured = problem.records[0];
  record.samples.resize(2, measured.num_samples());
  for (Eigen::Index i = 0; i < 2; ++i) {
    const MeasuredChannel& channel = measured.channels[static_cast<size_t>(i)];
    record.channels.push_back(channel.observation);
    record.samples.row(i) = channel.values.transpose();
  }
  problem.ambient.push_back(record);
  problem.records.clear();
  const std::vector<MotionLevel> levels = MotionLevels(problem);
  ASSERT_THAT(levels, SizeIs(2));
  EXPECT_EQ(levels[1].dof, wanted[1].dof);
  EXPECT_EQ(levels[1].unit, wanted[1].unit);
  EXPECT_DOUBLE_EQ(levels[1].mean, wanted[1].mean);
}

TEST(MotionLevels, RecordsWithoutMotionHaveNone) {
  EXPECT_THAT(MotionLevels(TwoHalves(0.0, 0.0)), IsEmpty());
  EXPECT_EQ(LevelSentence({}), "");
  EXPECT_EQ(CompareLevels({}, MotionLevels(TwoHalves(1.0, 1.0))),
            LevelComparison::kUnknown);
}

// The levels of one sensor with these values.
std::vector<MotionLevel> LevelsOf(const Vector& values) {
  IdentificationProblem problem;
  problem.dynamics = testing::MakeGroupedChain(2, 100.0, 0.5);
  IdentificationRecord record = testing::MakeExcitedRecord(
      *problem.dynamics, static_cast<int>(values.size()), 0.05);
  record.channels.push_back(
      testing::MakeChannel("a1", Quantity::kAbsoluteAcceleration, 2, 0));
  record.channels[0].values = values;
  problem.records.push_back(std::move(record));
  return MotionLevels(problem);
}

// The levels, which must enclose their mean and be at their own level.
MotionLevel SoundLevelOf(const Vector& values) {
  const std::vector<MotionLevel> levels = LevelsOf(values);
  EXPECT_THAT(levels, SizeIs(1));
  if (levels.size() != 1) return {};
  EXPECT_LE(levels[0].lowest, levels[0].mean);
  EXPECT_LE(levels[0].mean, levels[0].highest);
  EXPECT_EQ(CompareLevels(levels, levels), LevelComparison::kSame);
  return levels[0];
}

Vector Noise(Eigen::Index n, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  return Vector::NullaryExpr(n, [&]() { return normal(generator); });
}

TEST(MotionLevels, EncloseTheirMeanInTheShortestRecords) {
  for (unsigned seed = 1; seed <= 100; ++seed) SoundLevelOf(Noise(40, seed));
}

TEST(MotionLevels, EncloseTheirMeanIfTheMotionComesLate) {
  Vector late = Vector::Zero(1000);
  late.tail(25) = Noise(25, 1);
  const MotionLevel level = SoundLevelOf(late);
  EXPECT_NEAR(level.highest, 1.0, 0.5);
  EXPECT_LT(level.lowest, 0.5);
}

TEST(MotionLevels, DoNotDependOnMissingSamples) {
  const Vector whole = Noise(4000, 1);
  Vector every_second = whole;
  for (Eigen::Index i = 0; i < whole.size(); i += 2) every_second[i] = kNaN;
  const MotionLevel level = SoundLevelOf(every_second);
  EXPECT_NEAR(level.mean, 1.0, 0.1);
  EXPECT_NEAR(level.mean, SoundLevelOf(whole).mean, 0.1);
  // Parts with too few samples have no level.
  Vector first = whole;
  first.tail(3000).setConstant(kNaN);
  first[3999] = 30.0;
  SoundLevelOf(first);
  first.head(1000).setConstant(kNaN);
  EXPECT_THAT(LevelsOf(first), IsEmpty());
}

TEST(CompareLevels, ComparesMeansWithRanges) {
  const auto levels = [](double first, double second) {
    return MotionLevels(TwoHalves(first, second));
  };
  EXPECT_EQ(CompareLevels(levels(1.0, 1.0), levels(1.2, 1.2)),
            LevelComparison::kSame);
  EXPECT_EQ(CompareLevels(levels(1.0, 1.0), levels(1.5, 1.5)),
            LevelComparison::kOther);
  EXPECT_EQ(CompareLevels(levels(1.5, 1.5), levels(1.0, 1.0)),
            LevelComparison::kOther);
  // The new records go far beyond the baseline's, though they begin there.
  EXPECT_EQ(CompareLevels(levels(1.0, 1.0), levels(1.0, 9.0)),
            LevelComparison::kOther);
  // A second baseline has their level.
  std::vector<MotionLevel> both = levels(1.0, 1.0);
  for (const MotionLevel& level : levels(9.0, 9.0)) both.push_back(level);
  EXPECT_EQ(CompareLevels(both, levels(1.0, 9.0)), LevelComparison::kSame);
  EXPECT_EQ(CompareLevels(both, levels(3.0, 3.0)), LevelComparison::kSame);
  // Other sensors are not compared.
  std::vector<MotionLevel> elsewhere = levels(9.0, 9.0);
  for (MotionLevel& level : elsewhere) level.dof = "u9";
  EXPECT_EQ(CompareLevels(levels(1.0, 1.0), elsewhere),
            LevelComparison::kUnknown);
  // Nor are other units.
  std::vector<MotionLevel> in_inches = levels(9.0, 9.0);
  for (MotionLevel& level : in_inches) level.unit = "in/s^2";
  EXPECT_EQ(CompareLevels(levels(1.0, 1.0), in_inches),
            LevelComparison::kUnknown);
  // One baseline of which the levels are known suffices.
  for (const MotionLevel& level : levels(1.0, 1.0)) in_inches.push_back(level);
  EXPECT_EQ(CompareLevels(in_inches, levels(1.0, 1.0)), LevelComparison::kSame);
}

}  // namespace
}  // namespace pinode
