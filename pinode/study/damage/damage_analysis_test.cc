#include "pinode/study/damage/damage_analysis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/dynamics/memory_network.h"
#include "pinode/study/damage/change_refit.h"
#include "pinode/study/identify/identify.h"
#include "tests/support/decay_testing.h"
#include "tests/support/identify_testing.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Three floors: healthy records, and a structure that has lost a tenth of its
// second storey.
class AnalyseDamageTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const auto healthy = ChainAt(Vector{{0.05, -0.02, 0.01}});
    healthy_ = new TestFit(FitOf(MeasuredChain(3, *healthy, 1)));
    const auto damaged = ChainAt(Vector{{0.05, -0.02 - 0.098, 0.01}});
    damaged_ = new TestFit(FitOf(MeasuredChain(3, *damaged, 2)));
  }
  static void TearDownTestSuite() {
    delete healthy_;
    delete damaged_;
  }

  static Baseline BaselineOrFail() {
    Baseline baseline;
    std::string error;
    EXPECT_TRUE(BaselineFrom("spring", healthy_->problem, healthy_->summary,
                             healthy_->model, &baseline, &error))
        << error;
    return baseline;
  }

  static bool Analyse(const TestFit& fit,
                      const std::vector<Baseline>& baselines,
                      const DamageAnalysisOptions& options,
                      DamageResult* result, std::string* error) {
    error->clear();
    return AnalyseDamage(fit.problem, fit.summary, fit.model, baselines,
                         options, result, error);
  }

  static TestFit* healthy_;
  static TestFit* damaged_;
};

TestFit* AnalyseDamageTest::healthy_ = nullptr;
TestFit* AnalyseDamageTest::damaged_ = nullptr;

TEST_F(AnalyseDamageTest, FindsWhatWasLostWithoutAFile) {
  const Baseline baseline = BaselineOrFail();
  EXPECT_THAT(baseline.group_names, ElementsAre("k1", "k2", "k3"));
  EXPECT_EQ(BeginFromBaseline(baseline, damaged_->problem).parameters,
            healthy_->model.parameters);
  DamageResult result;
  std::string error;
  ASSERT_TRUE(Analyse(*damaged_, {baseline}, {}, &result, &error)) << error;
  EXPECT_EQ(result.judgement.verdict, DamageVerdict::kDamage)
      << result.judgement.sentence;
  EXPECT_THAT(result.baselines, ElementsAre("spring"));
  ASSERT_EQ(result.estimate.groups.size(), 3u);
  EXPECT_FALSE(result.estimate.groups[0].changed);
  EXPECT_TRUE(result.estimate.groups[1].changed);
  EXPECT_NEAR(result.estimate.groups[1].change, -0.1, 0.002);
  EXPECT_FALSE(result.estimate.groups[2].changed);
  EXPECT_TRUE(result.added.empty());
  EXPECT_TRUE(result.places.empty());
}

TEST_F(AnalyseDamageTest, LooksForOtherKindsWhereItIsTold) {
  const Baseline baseline = BaselineOrFail();
  auto heavier = ChainAt(Vector{{0.05, -0.02, 0.01}});
  GroupTerm mass;
  mass.group.name = "more";
  mass.group.target = MatrixGroup::Target::kMass;
  mass.group.matrix = Vector(Vector::Unit(3, 1)).asDiagonal();
  mass.alpha.value = 0.1;
  std::string error;
  ASSERT_TRUE(heavier->AddGroup(mass, &error)) << error;
  const TestFit fit = FitOf(MeasuredChain(3, *heavier, 3));
  DamageAnalysisOptions options;
  options.search = LookEverywhere(fit.problem);
  struct CountingWatch : IdentificationWatch {
    void OnFitEnd(Termination) override { ++fits; }
    int fits = 0;
  } watch;
  options.watch = &watch;
  DamageResult result;
  ASSERT_TRUE(Analyse(fit, {baseline}, options, &result, &error)) << error;
  EXPECT_EQ(result.judgement.verdict, DamageVerdict::kOtherChange)
      << result.judgement.sentence;
  // The healthy records were fitted before.
  EXPECT_GE(watch.fits, 2);
  EXPECT_TRUE(result.summary.usable()) << result.summary.message;
  ASSERT_EQ(result.added.size(), 1u);
  EXPECT_EQ(result.added[0].subject.name, "mass.u2");
  EXPECT_EQ(result.problem.dynamics->groups().size(), 4u);
  ASSERT_GE(result.subjects.size(), 4u);
  EXPECT_EQ(result.subjects[3].kind, ChangeKind::kMass);
  EXPECT_NEAR(result.estimate.groups[3].change, 0.1, 0.005);
  EXPECT_TRUE(result.remarks.empty()) << result.remarks[0];

  // Without healthy records the kinds cannot be told apart.
  Baseline values_alone = baseline;
  values_alone.fit = nullptr;
  ASSERT_TRUE(Analyse(fit, {values_alone}, options, &result, &error)) << error;
  ASSERT_FALSE(result.remarks.empty());
  EXPECT_THAT(result.remarks[0], HasSubstr("the baseline has no records"));
  EXPECT_TRUE(result.added.empty());
}

// Costs of sets are compared with the noise that all that was found leaves, not
// with what each of them leaves.
TEST_F(AnalyseDamageTest, ASetThatDescribesLittleCostsMore) {
  auto heavier = ChainAt(Vector{{0.05, -0.02, 0.01}});
  GroupTerm mass;
  mass.group.name = "more";
  mass.group.target = MatrixGroup::Target::kMass;
  mass.group.matrix = Vector(Vector::Unit(3, 1)).asDiagonal();
  mass.alpha.value = 0.3;
  std::string error;
  ASSERT_TRUE(heavier->AddGroup(mass, &error)) << error;
  const TestFit fit = FitOf(MeasuredChain(3, *heavier, 3));
  DamageAnalysisOptions options;
  options.search = LookEverywhere(fit.problem);
  DamageResult result;
  ASSERT_TRUE(Analyse(fit, {BaselineOrFail()}, options, &result, &error))
      << error;
  ASSERT_EQ(result.added.size(), 1u);
  const FitOfRecords groups_alone = {"new", fit.problem, fit.summary,
                                     fit.model};
  const FitOfRecords with_all = {"new", result.problem, result.summary,
                                 result.model};
  InnerFit inner;
  const std::vector<std::string> groups = {"k1", "k2", "k3"};
  ChangeRefitter refitter(groups_alone, with_all, groups,
                          IdentificationOptions(), &inner);
  ComparedCost cost;
  ASSERT_TRUE(refitter.AllFree(&cost));
  EXPECT_GT(cost.cost, 100.0 * refitter.cost_with_all());
  EXPECT_EQ(refitter.WhyNot(), "");
  FitOfRecords with_network = groups_alone;
  auto device = std::make_shared<StructuralDynamics>(*fit.problem.dynamics);
  const MemoryNetworkShape shape;
  ASSERT_TRUE(device->AddLaw(
      MakeMemoryNetwork("device", shape,
                        {Feature::Displacement(0), Feature::Velocity(0)}, 3,
                        MemoryNetwork(shape).DrawWeights(1), 3.0),
      &error))
      << error;
  with_network.problem.dynamics = device;
  EXPECT_EQ(ChangeRefitter(with_network, with_all, groups,
                           IdentificationOptions(), &inner)
                .WhyNot(),
            "there is a network");
}

TEST_F(AnalyseDamageTest, RefusesWhatDoesNotFitTogether) {
  const Baseline good = BaselineOrFail();
  DamageResult result;
  std::string error;
  const auto refusal = [&](const TestFit& fit,
                           const std::vector<Baseline>& baselines,
                           const DamageAnalysisOptions& options) {
    EXPECT_FALSE(Analyse(fit, baselines, options, &result, &error));
    return error;
  };
  EXPECT_THAT(refusal(*damaged_, {}, {}), HasSubstr("no baseline"));
  Baseline bad = good;
  bad.group_names = {"k1", "k2"};
  EXPECT_THAT(refusal(*damaged_, {good, bad}, {}),
              HasSubstr("has the groups k1, k2, expected k1, k2, k3"));
  bad = good;
  bad.name = "copy";
  EXPECT_THAT(refusal(*damaged_, {good, bad}, {}),
              HasSubstr("'spring' and 'copy' are the same result"));
  bad = good;
  bad.groups.values.conservativeResize(2);
  EXPECT_THAT(refusal(*damaged_, {bad}, {}), HasSubstr("'spring'"));
  bad = good;
  bad.groups.covariance(1, 1) = kNaN;
  EXPECT_THAT(refusal(*damaged_, {bad}, {}), HasSubstr("'spring'"));

  DamageAnalysisOptions options;
  options.change.threshold = 2.0;
  EXPECT_THAT(refusal(*damaged_, {good}, options), HasSubstr("threshold"));
  options = {};
  options.search.springs = {{"gap", 0, 3}};
  EXPECT_THAT(refusal(*damaged_, {good}, options), HasSubstr("'gap'"));
  options.search = {};
  options.search.masses = {{"roof", {}}};
  EXPECT_THAT(refusal(*damaged_, {good}, options), HasSubstr("'roof'"));
  options = {};
  options.identification.covariance = IdentificationOptions::Covariance::kNone;
  EXPECT_THAT(refusal(*damaged_, {good}, options), HasSubstr("no intervals"));
  const Identification none =
      Identify(damaged_->problem, options.identification, {}, nullptr);
  EXPECT_EQ(none.summary.termination, Termination::kFailure);
  EXPECT_FALSE(none.summary.usable());
  EXPECT_THAT(none.summary.message, HasSubstr("no intervals"));

  TestFit fit = *damaged_;
  fit.model.parameters.conservativeResize(2);
  EXPECT_THAT(refusal(fit, {good}, {}), HasSubstr("parameters"));
  fit = *damaged_;
  fit.model.sigmas.clear();
  EXPECT_THAT(refusal(fit, {good}, {}), HasSubstr("records"));
  fit = *damaged_;
  fit.summary.records[0].states.resize(6, 3);
  EXPECT_THAT(refusal(fit, {good}, {}), HasSubstr("samples"));
  fit = *damaged_;
  fit.summary.covariance.resize(0, 0);
  EXPECT_THAT(refusal(fit, {good}, {}), HasSubstr("covariance"));
  fit = *damaged_;
  fit.summary.verdict = testing::NotUsable();
  fit.summary.message = "of the test";
  EXPECT_THAT(refusal(fit, {good}, {}), HasSubstr("of the test"));
}

// A sensor's gain is no subject, so that the verdict cannot name it.
TEST_F(AnalyseDamageTest, SaysWhatExplainsTheNewRecordsInstead) {
  const auto same = ChainAt(Vector{{0.05, -0.02, 0.01}});
  IdentificationProblem problem = MeasuredChain(3, *same, 4);
  problem.records[0].channels[1].values *= 1.3;
  Identification later = Identify(problem, {}, {}, nullptr);
  TestFit fit;
  fit.problem = std::move(later.problem);
  fit.summary = std::move(later.summary);
  fit.model = std::move(later.model);
  DamageAnalysisOptions options;
  options.search = LookEverywhere(fit.problem);
  DamageResult result;
  std::string error;
  ASSERT_TRUE(Analyse(fit, {BaselineOrFail()}, options, &result, &error))
      << error;
  EXPECT_EQ(result.judgement.verdict, DamageVerdict::kCannotTell)
      << result.judgement.sentence;
  ASSERT_FALSE(result.summary.explanations.empty());
  EXPECT_EQ(result.summary.explanations[0].kind, "sensor_gain");
  EXPECT_EQ(result.summary.explanations[0].place, "a2");
  EXPECT_NEAR(result.summary.explanations[0].value, 1.3, 0.01);
  ASSERT_FALSE(result.remarks.empty());
  EXPECT_THAT(result.remarks.back(), HasSubstr("the gain of sensor 'a2', 1.3"));
}

// The healthy values may be those of the other solution, and the change with
// them: frequencies of a beam on two supports named the wrong one of two
// mirrored elements.
TEST_F(AnalyseDamageTest, ABaselineWithAnotherSolutionNamesNoGroup) {
  Baseline baseline = BaselineOrFail();
  IdentificationSummary summary = healthy_->summary;
  Finding finding;
  finding.check = "other_solution";
  finding.grade = Grade::kWithCare;
  summary.verdict = Verdict({finding});
  baseline.doubts = DoubtsOf(summary);
  DamageResult result;
  std::string error;
  ASSERT_TRUE(Analyse(*damaged_, {baseline}, {}, &result, &error)) << error;
  EXPECT_EQ(result.judgement.verdict, DamageVerdict::kCannotTell)
      << result.judgement.sentence;
  ASSERT_FALSE(result.remarks.empty());
  EXPECT_THAT(result.remarks.back(), HasSubstr("Another solution"));
  // A second baseline does not decide between the solutions.
  const auto healthy = ChainAt(Vector{{0.05, -0.02, 0.01}});
  const TestFit again = FitOf(MeasuredChain(3, *healthy, 9));
  Baseline second;
  ASSERT_TRUE(BaselineFrom("second", again.problem, again.summary, again.model,
                           &second, &error))
      << error;
  ASSERT_TRUE(Analyse(*damaged_, {baseline, second}, {}, &result, &error))
      << error;
  EXPECT_EQ(result.judgement.verdict, DamageVerdict::kCannotTell)
      << result.judgement.sentence;
}

// A model that leaves motion unexplained has other values at another level of
// motion, however many baselines there are at the same level.
TEST_F(AnalyseDamageTest, AnotherLevelOfMotionMayBeAllThatChanged) {
  const auto healthy = ChainAt(Vector{{0.05, -0.02, 0.01}});
  const TestFit again = FitOf(MeasuredChain(3, *healthy, 9));
  std::vector<Baseline> baselines = {BaselineOrFail(), Baseline()};
  std::string error;
  ASSERT_TRUE(BaselineFrom("second", again.problem, again.summary, again.model,
                           &baselines[1], &error))
      << error;
  const auto scale_levels = [&baselines](double factor) {
    for (MotionLevel& level : baselines[0].levels) {
      level.lowest *= factor;
      level.mean *= factor;
      level.highest *= factor;
    }
    baselines[1].levels = baselines[0].levels;
  };
  const auto judge = [&](const std::vector<Baseline>& chosen) {
    DamageResult result;
    EXPECT_TRUE(Analyse(*damaged_, chosen, {}, &result, &error)) << error;
    return result.judgement;
  };
  ASSERT_EQ(baselines[0].levels.size(), 3u);
  scale_levels(0.1);
  // Complete models do not depend on the level.
  EXPECT_EQ(judge(baselines).verdict, DamageVerdict::kDamage);
  baselines[0].doubts.misses_motion = true;
  EXPECT_EQ(judge(baselines).verdict, DamageVerdict::kCannotTell);
  const Judgement alone = judge({baselines[0]});
  EXPECT_EQ(alone.verdict, DamageVerdict::kCannotTell);
  EXPECT_EQ(alone.reasons[1], Reason::kOtherLevel);
  scale_levels(10.0);
  EXPECT_EQ(judge(baselines).verdict, DamageVerdict::kDamage);
}

// An extra pole that the fit left out says nothing against the values of the
// other modes. Any other reason for care, or a likely explanation, does.
TEST(DoubtsOf, AnUnusedModeAloneWidensNothing) {
  IdentificationSummary summary;
  ParameterEstimate k1;
  k1.name = "k1";
  k1.value = 0.1;
  k1.half_width95 = 0.02;
  summary.parameters = {k1};
  Finding unused, other;
  unused.check = "mode_not_used";
  unused.grade = Grade::kWithCare;
  other.check = "shape_not_met";
  other.grade = Grade::kWithCare;
  summary.verdict = Verdict({unused});
  EXPECT_TRUE(DoubtsOf(summary).reach.empty());
  summary.verdict = Verdict({unused, other});
  ASSERT_EQ(DoubtsOf(summary).reach.size(), 1u);
  EXPECT_DOUBLE_EQ(DoubtsOf(summary).reach[0].lower95, 0.08);
  summary.verdict = Verdict({unused});
  Explanation sign;
  sign.log_odds = 2.9;
  summary.explanations = {sign};
  EXPECT_TRUE(DoubtsOf(summary).reach.empty());
  summary.explanations[0].log_odds = 3.1;
  EXPECT_EQ(DoubtsOf(summary).reach.size(), 1u);
}

// Fits of healthy records of another size are no reason to end.
TEST_F(AnalyseDamageTest, SaysWhereHealthyRecordsDoNotFit) {
  DamageAnalysisOptions options;
  options.search = LookEverywhere(damaged_->problem);
  Baseline baseline = BaselineOrFail();
  HealthyFit other = *baseline.fit;
  const auto small = ChainAt(Vector{{0.0, 0.0}});
  const TestFit fit = FitOf(MeasuredChain(2, *small, 4));
  other.problem = fit.problem;
  other.summary = fit.summary;
  other.model = fit.model;
  baseline.fit = std::make_shared<const HealthyFit>(other);
  DamageResult result;
  std::string error;
  ASSERT_TRUE(Analyse(*damaged_, {baseline}, options, &result, &error))
      << error;
  ASSERT_FALSE(result.remarks.empty());
  EXPECT_THAT(result.remarks[0],
              HasSubstr("kinds of change could not be told"));
  EXPECT_EQ(result.judgement.verdict, DamageVerdict::kDamage);
}

TEST_F(AnalyseDamageTest, BaselinesAreOfUsableFits) {
  Baseline baseline;
  std::string error;
  TestFit fit = *healthy_;
  fit.summary.verdict = testing::NotUsable();
  EXPECT_FALSE(BaselineFrom("D", fit.problem, fit.summary, fit.model, &baseline,
                            &error));
  EXPECT_THAT(error, HasSubstr("baseline 'D': the fit is not usable"));
  fit = *healthy_;
  fit.summary.covariance_names[1] = "c";
  EXPECT_FALSE(BaselineFrom("D", fit.problem, fit.summary, fit.model, &baseline,
                            &error));
  EXPECT_THAT(error, HasSubstr("'k2' has no covariance"));
}

// Of a group that is there twice before the fit, a change of it is half of one
// of the group's matrix; the next problem begins with what was found.
TEST_F(AnalyseDamageTest, WhatIsPresentCounts) {
  const Baseline baseline = BaselineOrFail();
  IdentificationProblem twice = damaged_->problem;
  StructureTerms terms = TermsOf(*twice.dynamics);
  terms.groups[1].present = 2.0;
  std::string error;
  ASSERT_TRUE(Assemble(twice.dynamics->model(), twice.dynamics->inputs(), terms,
                       &twice.dynamics, &error))
      << error;
  EXPECT_EQ(AlreadyPresent(*twice.dynamics, {"k1", "k2", "k4"}),
            (Vector{{0.0, 1.0, 0.0}}));
  EXPECT_NEAR(BeginFromBaseline(baseline, twice).parameters[1],
              healthy_->model.parameters[1] - 1.0, 1e-15);
}

// An added mass lowers stiffness and damping over mass, as a loss with less
// damping does. A decay does not know which.
TEST(AnalyseFreeDecay, DoesNotRuleOutALossBesideLessDamping) {
  const TestFit healthy = FitOfDecay(Vector{{1.05}}, 1.1, 1);
  Baseline baseline;
  std::string error;
  ASSERT_TRUE(BaselineFrom("before", healthy.problem, healthy.summary,
                           healthy.model, &baseline, &error))
      << error;
  for (const double damping : {0.75, 0.83, 0.9, 1.0}) {
    const TestFit fit = FitOfDecay(Vector{{0.83 * 1.05}}, damping * 1.1, 2);
    DamageAnalysisOptions options;
    options.search = LookEverywhere(fit.problem);
    DamageResult result;
    ASSERT_TRUE(AnalyseDamage(fit.problem, fit.summary, fit.model, {baseline},
                              options, &result, &error))
        << error;
    const DamageVerdict verdict = result.judgement.verdict;
    EXPECT_TRUE(verdict == DamageVerdict::kCannotTell ||
                verdict == DamageVerdict::kDamage)
        << damping << ": " << result.judgement.sentence;
    const GroupChange& k = result.estimate.groups[0];
    EXPECT_LT(k.lower95, -0.165) << damping;
    EXPECT_GT(k.upper95, -0.175) << damping;
  }
}

}  // namespace
}  // namespace pinode
