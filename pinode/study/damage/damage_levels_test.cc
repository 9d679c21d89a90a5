// Verdicts between levels of motion.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pinode/study/damage/damage_analysis.h"
#include "pinode/study/damage/healthy_records.h"
#include "tests/support/identify_testing.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// Three floors: healthy records of two seeds, and a second storey that has
// lost a tenth.
class DamageLevelsTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const auto healthy = ChainAt(Vector{{0.05, -0.02, 0.01}});
    healthy_ = new TestFit(FitOf(MeasuredChain(3, *healthy, 1)));
    again_ = new TestFit(FitOf(MeasuredChain(3, *healthy, 9)));
    const auto damaged = ChainAt(Vector{{0.05, -0.02 - 0.098, 0.01}});
    damaged_ = new TestFit(FitOf(MeasuredChain(3, *damaged, 2)));
  }
  static void TearDownTestSuite() {
    delete healthy_;
    delete again_;
    delete damaged_;
  }

  // A baseline at a tenth of its level, of a model that misses motion.
  static Baseline BaselineOf(const TestFit& fit) {
    Baseline baseline;
    std::string error;
    EXPECT_TRUE(BaselineFrom("before", fit.problem, fit.summary, fit.model,
                             &baseline, &error))
        << error;
    EXPECT_EQ(baseline.levels.size(), 3u);
    EXPECT_TRUE(baseline.has_records);
    for (MotionLevel& level : baseline.levels) {
      level.lowest *= 0.1;
      level.mean *= 0.1;
      level.highest *= 0.1;
    }
    baseline.doubts.misses_motion = true;
    return baseline;
  }

  static Judgement Judge(const TestFit& fit,
                         const std::vector<Baseline>& baselines) {
    DamageResult result;
    std::string error;
    EXPECT_TRUE(AnalyseDamage(fit.problem, fit.summary, fit.model, baselines,
                              {}, &result, &error))
        << error;
    return result.judgement;
  }

  static TestFit* healthy_;
  static TestFit* again_;
  static TestFit* damaged_;
};

TestFit* DamageLevelsTest::healthy_ = nullptr;
TestFit* DamageLevelsTest::again_ = nullptr;
TestFit* DamageLevelsTest::damaged_ = nullptr;

// A fit that leaves motion unexplained unless there is friction. With that, the
// first group differs by `shift`.
TestFit WithFriction(TestFit fit, double shift) {
  Finding finding;
  finding.check = kUnexplainedMotion;
  finding.grade = Grade::kWithCare;
  fit.summary.verdict = Verdict({finding});
  Explanation friction;
  friction.kind = "nonlinear";
  friction.place = "k1";
  friction.log_odds = 50.0;
  friction.leaves = 0.001;
  for (const ParameterEstimate& own : fit.summary.parameters) {
    const double value = own.value + (own.name == "k1" ? shift : 0.0);
    friction.values.push_back({own.name, value, value - 0.01, value + 0.01});
  }
  fit.summary.explanations = {friction};
  return fit;
}

TEST(DoubtsOfFriction, StillMissMotion) {
  const auto healthy = ChainAt(Vector{{0.05, -0.02, 0.01}});
  const TestFit fit = WithFriction(FitOf(MeasuredChain(3, *healthy, 1)), 0.0);
  const Doubts doubts = DoubtsOf(fit.summary);
  EXPECT_TRUE(doubts.misses_motion);
  EXPECT_TRUE(doubts.whole.has_value());
}

// Values of the model as it is depend on the level. With several baselines
// these are compared, even if friction explains all.
TEST_F(DamageLevelsTest, AnExplanationServesOneBaselineAlone) {
  const TestFit damaged = WithFriction(*damaged_, 0.0);
  Baseline one = BaselineOf(WithFriction(*healthy_, 0.0));
  const Baseline two = BaselineOf(WithFriction(*again_, 0.0));
  EXPECT_EQ(Judge(damaged, {one}).verdict, DamageVerdict::kDamage);
  const Judgement both = Judge(damaged, {one, two});
  EXPECT_EQ(both.verdict, DamageVerdict::kCannotTell) << both.sentence;
  EXPECT_EQ(both.reasons[1], Reason::kOtherLevel);
  // One side has no explanation, or another one.
  EXPECT_EQ(Judge(*damaged_, {one}).verdict, DamageVerdict::kCannotTell);
  one.doubts.whole->place = "k2";
  EXPECT_EQ(Judge(damaged, {one}).verdict, DamageVerdict::kCannotTell);
}

TEST_F(DamageLevelsTest, ALossUnderAnExplanationIsNotHidden) {
  Baseline one = BaselineOf(WithFriction(*healthy_, 0.0));
  EXPECT_EQ(Judge(WithFriction(*again_, 0.0), {one}).verdict,
            DamageVerdict::kNoDamage);
  const TestFit lost = WithFriction(*again_, -0.2);
  const Judgement judgement = Judge(lost, {one});
  EXPECT_EQ(judgement.verdict, DamageVerdict::kCannotTell);
  EXPECT_THAT(judgement.sentence, HasSubstr("which may hide a loss"));
}

// Stiffness that grows at low motion may stand against a loss.
TEST_F(DamageLevelsTest, AnotherLevelMayHideALoss) {
  std::vector<Baseline> baselines = {BaselineOf(*healthy_)};
  const Judgement judgement = Judge(*again_, baselines);
  EXPECT_EQ(judgement.verdict, DamageVerdict::kCannotTell);
  EXPECT_THAT(judgement.sentence,
              HasSubstr("The new records are at another level of motion, which "
                        "may hide a loss."));
  // A complete model has no level.
  baselines[0].doubts.misses_motion = false;
  EXPECT_EQ(Judge(*again_, baselines).verdict, DamageVerdict::kNoDamage);
}

TEST_F(DamageLevelsTest, LevelsOfOtherSensorsAreUnknown) {
  Baseline moved = BaselineOf(*healthy_);
  for (MotionLevel& level : moved.levels) level.dof = "u9";
  for (const TestFit* fit : {damaged_, again_}) {
    const Judgement judgement = Judge(*fit, {moved});
    EXPECT_EQ(judgement.verdict, DamageVerdict::kCannotTell);
    EXPECT_THAT(
        judgement.sentence,
        HasSubstr("The model leaves motion unexplained, and the levels of "
                  "motion cannot be compared: no sensor is common."));
  }
  moved.doubts.misses_motion = false;
  EXPECT_EQ(Judge(*damaged_, {moved}).verdict, DamageVerdict::kDamage);
  EXPECT_EQ(Judge(*again_, {moved}).verdict, DamageVerdict::kNoDamage);
}

TEST_F(DamageLevelsTest, ResultsWithoutLevelsAreJudgedAsEver) {
  // A short record, or a result of an earlier version.
  Baseline earlier = BaselineOf(*healthy_);
  earlier.levels.clear();
  EXPECT_EQ(Judge(*damaged_, {earlier}).verdict, DamageVerdict::kDamage);
  EXPECT_EQ(Judge(*again_, {earlier}).verdict, DamageVerdict::kNoDamage);
  // Beside it the baselines with levels decide.
  EXPECT_EQ(Judge(*damaged_, {earlier, BaselineOf(*again_)}).verdict,
            DamageVerdict::kCannotTell);
  // Modes alone are of another kind of motion.
  earlier.has_records = false;
  EXPECT_EQ(Judge(*damaged_, {earlier}).verdict, DamageVerdict::kCannotTell);
}

TEST_F(DamageLevelsTest, ANewFitOfABaselineSaysWhatItMisses) {
  const std::vector<Baseline> baselines = {BaselineOf(*healthy_)};
  const std::vector<std::string> groups =
      FreeGroups(*damaged_->problem.dynamics);
  const IdentificationOptions options;
  HealthyRecords records(baselines, damaged_->problem, groups, options);
  EXPECT_TRUE(records.LeavesMotion(0)) << "as its doubts say";
  FitOfRecords fit{"before", healthy_->problem, healthy_->summary,
                   healthy_->model};
  records.Restore({fit});
  EXPECT_TRUE(records.LeavesMotion(0)) << "the same fit";
  // With other terms.
  fit.problem.dynamics = again_->problem.dynamics;
  records.Restore({fit});
  EXPECT_FALSE(records.LeavesMotion(0));
  RecordScore& score = fit.summary.records[0];
  score.nrmse = 0.3;
  for (ChannelScore& channel : score.channels) channel.noise_share = 0.5;
  records.Restore({fit});
  EXPECT_TRUE(records.LeavesMotion(0)) << MissedOf(fit.summary, 0.0);
}

}  // namespace
}  // namespace pinode
