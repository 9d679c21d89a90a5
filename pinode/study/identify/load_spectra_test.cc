#include "pinode/study/identify/load_spectra.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/study/problem/checkpoint.h"
#include "tests/support/ambient_testing.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

IdentificationProblem TwoAmbientRecords() {
  IdentificationProblem problem;
  problem.dynamics = testing::MakeGroupedChain(3, 100.0, 0.5);
  problem.ambient.resize(2);
  problem.ambient[0].name = "monday";
  problem.ambient[1].name = "tuesday";
  problem.ambient[1].knots = 5;
  return problem;
}

FitSummary FitOf(const IdentificationProblem& problem, double probability) {
  FitSummary summary;
  summary.termination = Termination::kConverged;
  summary.seconds = 1.0;
  summary.final_cost = 10.0 - probability;
  for (const AmbientRecord& record : problem.ambient) {
    AmbientScore score;
    score.name = record.name;
    score.num_knots = record.knots > 0 ? record.knots : 7;
    score.probability = record.name == "monday" ? probability : 0.5;
    score.degrees_of_freedom = 100;
    score.most_information_left = 1.0;
    score.coherence_probability = 0.5;
    score.chi_square = 1e5 / score.num_knots;
    score.evidence.price = 10.0 * score.num_knots;
    summary.ambient.push_back(score);
  }
  return summary;
}

// Fits that end as they are told to, and remember what they were asked.
class Fits : public InnerFit {
 public:
  explicit Fits(std::vector<double> probabilities)
      : probabilities_(std::move(probabilities)) {}
  void Run(const std::string&, const IdentificationProblem& problem,
           const IdentificationOptions&, const IdentifiedModel* begin,
           FitSummary* summary, IdentifiedModel* model) override {
    knots.push_back(problem.ambient[0].knots);
    identities.push_back(ProblemIdentity(problem));
    EXPECT_NE(begin, nullptr);
    *summary = FitOf(problem, probabilities_[knots.size() - 1]);
    if (interrupts) summary->termination = Termination::kInterrupted;
    model->parameters = Vector::Constant(1, static_cast<double>(knots.back()));
  }
  std::vector<int> knots;
  std::vector<std::string> identities;
  bool interrupts = false;

 private:
  std::vector<double> probabilities_;
};

TEST(LoadSpectra, KnotsThatSomebodyGaveStay) {
  const IdentificationProblem given = TwoAmbientRecords();
  FitSummary summary = FitOf(given, 1e-9);
  summary.ambient[1].probability = 1e-9;
  IdentificationProblem problem = given;
  const std::vector<int> knots = {given.ambient[0].knots,
                                  given.ambient[1].knots};
  EXPECT_TRUE(RefineLoadSpectra(knots, summary, &problem));
  EXPECT_EQ(problem.ambient[0].knots, 13);
  EXPECT_EQ(problem.ambient[1].knots, 5);
  problem = given;
  summary.ambient[0].probability = 1e-3;
  EXPECT_FALSE(RefineLoadSpectra(knots, summary, &problem));
  EXPECT_EQ(problem.ambient[0].knots, 0);
}

TEST(LoadSpectra, RefinedUntilTheyDescribeTheRecords) {
  IdentificationProblem problem = TwoAmbientRecords();
  const std::string identity = ProblemIdentity(problem);
  FitSummary summary = FitOf(problem, 1e-18);
  IdentifiedModel model;
  Fits fits({1e-17, 0.3, 0.9});
  SettleLoadSpectra({}, &fits, &problem, &summary, &model);
  EXPECT_THAT(fits.knots, ElementsAre(0, 13));
  EXPECT_THAT(fits.identities, ElementsAre(identity, identity));
  EXPECT_EQ(problem.ambient[0].knots, 13);
  EXPECT_EQ(model.parameters[0], 13.0);
  EXPECT_EQ(summary.ambient[0].probability, 0.3);
  EXPECT_EQ(summary.seconds, 3.0);
  ASSERT_EQ(summary.remarks.size(), 1u);
  EXPECT_THAT(summary.remarks[0],
              HasSubstr("'monday' with 7 knots (probability 1e-18)"));
  EXPECT_THAT(summary.remarks[0],
              HasSubstr("result has 'monday' with 13 knots (probability 0.3)"));
}

TEST(LoadSpectra, TheBestStandsWhereNoneIsGood) {
  IdentificationProblem problem = TwoAmbientRecords();
  FitSummary summary = FitOf(problem, 1e-18);
  IdentifiedModel model;
  Fits fits({1e-19, 1e-7, 1e-9});
  SettleLoadSpectra({}, &fits, &problem, &summary, &model);
  EXPECT_THAT(fits.knots, ElementsAre(0, 13, 25));
  EXPECT_EQ(problem.ambient[0].knots, 13);
  EXPECT_EQ(model.parameters[0], 13.0);
  EXPECT_EQ(summary.ambient[0].probability, 1e-7);
}

// What is too small to be told from zero is smaller yet with coarser spectra.
TEST(LoadSpectra, NearerStandsWhereNoProbabilityIsLeft) {
  IdentificationProblem problem = TwoAmbientRecords();
  FitSummary summary = FitOf(problem, 0.0);
  summary.way = "by stages";
  summary.linear_error = 0.25;
  IdentifiedModel model;
  Fits fits({0.0, 0.0, 0.0});
  SettleLoadSpectra({}, &fits, &problem, &summary, &model);
  EXPECT_EQ(problem.ambient[0].knots, 25);
  EXPECT_EQ(model.parameters[0], 25.0);
  EXPECT_EQ(summary.way, "by stages");
  EXPECT_EQ(summary.linear_error, 0.25);
  ASSERT_EQ(summary.remarks.size(), 1u);
  EXPECT_THAT(summary.remarks[0], HasSubstr("13 knots (probability 0); then"));
}

// With the same knots: what the first fit took for loads was of its start.
TEST(LoadSpectra, FoundAnewAtTheModel) {
  IdentificationProblem problem = TwoAmbientRecords();
  FitSummary summary = FitOf(problem, 1e-3);
  summary.way = "by stages";
  IdentifiedModel model;
  Fits fits({0.4});
  SettleLoadSpectra({}, &fits, &problem, &summary, &model);
  EXPECT_THAT(fits.knots, ElementsAre(0));
  EXPECT_EQ(summary.ambient[0].probability, 0.4);
  EXPECT_EQ(summary.seconds, 2.0);
  EXPECT_EQ(summary.way, "by stages");
  EXPECT_EQ(model.parameters.size(), 1);
  EXPECT_TRUE(summary.remarks.empty());
  EXPECT_EQ(problem.ambient[0].knots, 0);
  // What costs more does not stand.
  summary = FitOf(problem, 1e-3);
  Fits worse({1e-5});
  SettleLoadSpectra({}, &worse, &problem, &summary, &model);
  EXPECT_THAT(worse.knots, ElementsAre(0));
  EXPECT_EQ(summary.ambient[0].probability, 1e-3);
}

// A fit whose first record would have `gain` of likelihood for a price of 60.
FitSummary FitWithPromise(const IdentificationProblem& problem, double gain) {
  FitSummary summary = FitOf(problem, 0.5);
  LoadEvidence& evidence = summary.ambient[0].evidence;
  evidence.finer_knots = 2 * summary.ambient[0].num_knots - 1;
  evidence.finer_gain = gain;
  evidence.finer_price = 60.0;
  return summary;
}

TEST(LoadSpectra, TheEvidenceAsksForMore) {
  const IdentificationProblem given = TwoAmbientRecords();
  const std::vector<int> knots = {0, 5};
  IdentificationProblem problem = given;
  FitSummary summary = FitWithPromise(problem, 61.0);
  // Of the second record, whose knots were given, it is not asked.
  summary.ambient[1].evidence = summary.ambient[0].evidence;
  EXPECT_TRUE(RefineByEvidence(knots, summary, &problem));
  EXPECT_EQ(problem.ambient[0].knots, 13);
  EXPECT_EQ(problem.ambient[1].knots, 5);
  problem = given;
  EXPECT_FALSE(RefineByEvidence({7, 5}, summary, &problem));
  // Of what is refused the other test says what is to be done.
  summary.ambient[0].probability = 1e-9;
  EXPECT_FALSE(RefineByEvidence(knots, summary, &problem));
  summary = FitWithPromise(problem, 61.0);
  summary.ambient[0].coherence_probability = 1e-9;
  EXPECT_FALSE(RefineByEvidence(knots, summary, &problem));
  summary = FitWithPromise(problem, 59.0);
  EXPECT_FALSE(RefineByEvidence(knots, summary, &problem));
  // A spectrum of which nothing is known.
  summary.ambient[0].evidence = {};
  EXPECT_FALSE(RefineByEvidence(knots, summary, &problem));
  EXPECT_EQ(problem.ambient[0].knots, 0);
}

// Fits whose evidence is told.
class FitsWithEvidence : public InnerFit {
 public:
  // Likelihoods; what the last one promises.
  FitsWithEvidence(std::vector<double> likelihoods, double promise)
      : likelihoods_(std::move(likelihoods)), promise_(promise) {}
  void Run(const std::string&, const IdentificationProblem& problem,
           const IdentificationOptions&, const IdentifiedModel* begin,
           FitSummary* summary, IdentifiedModel* model) override {
    ASSERT_LT(knots.size(), likelihoods_.size());
    EXPECT_NE(begin, nullptr);
    knots.push_back(problem.ambient[0].knots);
    EXPECT_EQ(problem.ambient[1].knots, 5);
    *summary = FitWithPromise(problem, promise_);
    summary->ambient[0].evidence.log_likelihood =
        likelihoods_[knots.size() - 1];
    summary->stalled = !sound;
    model->parameters = Vector::Constant(1, static_cast<double>(knots.back()));
  }
  std::vector<int> knots;
  bool sound = true;

 private:
  std::vector<double> likelihoods_;
  double promise_;
};

TEST(LoadSpectra, WhatHasMoreEvidenceStands) {
  IdentificationProblem problem = TwoAmbientRecords();
  const std::string identity = ProblemIdentity(problem);
  FitSummary summary = FitWithPromise(problem, 100.0);
  summary.way = "by stages";
  IdentifiedModel model;
  FitsWithEvidence fits({90.0}, 59.0);
  SettleLoadSpectra({}, &fits, &problem, &summary, &model);
  EXPECT_THAT(fits.knots, ElementsAre(13));
  EXPECT_EQ(problem.ambient[0].knots, 13);
  EXPECT_EQ(problem.ambient[1].knots, 5);
  EXPECT_EQ(ProblemIdentity(problem), identity);
  EXPECT_EQ(model.parameters[0], 13.0);
  EXPECT_EQ(summary.seconds, 2.0);
  EXPECT_EQ(summary.way, "by stages");
  ASSERT_EQ(summary.remarks.size(), 1u);
  EXPECT_EQ(summary.remarks[0],
            "The evidence chose more knots of the loads' spectra: 'monday' 13 "
            "instead of 7. They add 90 to the logarithm of the likelihood and "
            "cost 60 of evidence.");
}

// A promise is not enough; and one that was kept is asked again, up to four
// knots an octave.
TEST(LoadSpectra, PromisesOfTheEvidenceAreHeldAgainstFits) {
  IdentificationProblem problem = TwoAmbientRecords();
  FitSummary summary = FitWithPromise(problem, 100.0);
  IdentifiedModel model;
  FitsWithEvidence less({50.0}, 59.0);
  SettleLoadSpectra({}, &less, &problem, &summary, &model);
  EXPECT_THAT(less.knots, ElementsAre(13));
  EXPECT_EQ(problem.ambient[0].knots, 0);
  EXPECT_EQ(model.parameters.size(), 0);
  EXPECT_EQ(summary.seconds, 2.0);
  ASSERT_EQ(summary.remarks.size(), 1u);
  EXPECT_THAT(summary.remarks[0], HasSubstr("chose no more knots"));

  summary = FitWithPromise(problem, 100.0);
  FitsWithEvidence unusable({500.0}, 59.0);
  unusable.sound = false;
  SettleLoadSpectra({}, &unusable, &problem, &summary, &model);
  EXPECT_EQ(problem.ambient[0].knots, 0);
  EXPECT_THAT(CheckFit(GapTuning(), summary), IsEmpty());
  ASSERT_EQ(summary.remarks.size(), 1u);
  EXPECT_THAT(summary.remarks[0], HasSubstr("give no usable fit"));

  summary = FitWithPromise(problem, 100.0);
  FitsWithEvidence more({500.0, 1000.0}, 100.0);
  SettleLoadSpectra({}, &more, &problem, &summary, &model);
  EXPECT_THAT(more.knots, ElementsAre(13, 25));
  EXPECT_EQ(problem.ambient[0].knots, 25);
  EXPECT_EQ(summary.remarks.size(), 2u);
}

// A base whose motion is `decibels` stronger around 4.5 Hz, between the two
// modes, within an octave and a half; knots are an octave apart.
IdentificationProblem ChainOnAnUnevenBase(double decibels) {
  const TestChain chain = RayleighChain(2);
  AmbientRecord record = RecordOfChain(chain, 600.0, 3, 0.9, {2}, true);
  record.base = Matrix::Ones(2, 1);
  // What is done to the response might have been done to the motion: a peak as
  // equalisers have them.
  const double w = kTwoPi * 4.5 * record.sampling_step;
  const double root = std::pow(10.0, decibels / 40.0);
  const double wide = 0.5 * std::sin(w);
  for (Eigen::Index c = 0; c < 2; ++c) {
    double x1 = 0.0, x2 = 0.0, y1 = 0.0, y2 = 0.0;  // one and two samples ago
    for (double& sample : record.samples.row(c)) {
      const double x = sample;
      sample = ((1.0 + wide * root) * x - 2.0 * std::cos(w) * (x1 - y1) +
                (1.0 - wide * root) * x2 - (1.0 - wide / root) * y2) /
               (1.0 + wide / root);
      x2 = std::exchange(x1, x);
      y2 = std::exchange(y1, sample);
    }
  }
  return ProblemOfChain(chain, kChainSpring, 0.02, std::move(record));
}

// Chance might have made what is left of such a record; but one motion wants
// few numbers more.
TEST(LoadSpectra, EvidenceSeesWhatChanceMightHaveMade) {
  IdentificationProblem problem = ChainOnAnUnevenBase(1.5);
  const auto settle = [&problem] {
    FitSummary summary;
    IdentifiedModel model;
    FitOnce(problem, {}, nullptr, &summary, &model);
    EXPECT_EQ(WhyNotSound(GapTuning(), summary), "");
    EXPECT_GT(summary.ambient.at(0).probability, 0.1);
    EXPECT_EQ(summary.ambient.at(0).num_knots, 5);
    InnerFit fit;
    SettleLoadSpectra({}, &fit, &problem, &summary, &model);
    EXPECT_EQ(WhyNotSound(GapTuning(), summary), "");
    return summary;
  };
  FitSummary summary = settle();
  EXPECT_EQ(problem.ambient[0].knots, 9);
  EXPECT_EQ(summary.ambient.at(0).num_knots, 9);
  EXPECT_FALSE(summary.ambient.at(0).evidence.PromisesMore());
  ASSERT_EQ(summary.remarks.size(), 1u);
  EXPECT_THAT(summary.remarks[0], HasSubstr("chose more knots"));
  EXPECT_THAT(summary.remarks[0], HasSubstr("'wind' 9 instead of 5"));
  // Somebody who knows says otherwise.
  problem.ambient[0].knots = 5;
  summary = settle();
  EXPECT_EQ(problem.ambient[0].knots, 5);
  EXPECT_TRUE(summary.ambient.at(0).evidence.PromisesMore());
  EXPECT_TRUE(summary.remarks.empty());
  // An even motion.
  problem = ChainOnAnUnevenBase(0.0);
  summary = settle();
  EXPECT_EQ(problem.ambient[0].knots, 0);
  EXPECT_TRUE(summary.remarks.empty());
}

TEST(LoadSpectra, NothingToRefine) {
  IdentificationProblem problem = TwoAmbientRecords();
  FitSummary summary = FitOf(problem, 0.5);
  IdentifiedModel model;
  Fits fits({});
  SettleLoadSpectra({}, &fits, &problem, &summary, &model);
  EXPECT_TRUE(fits.knots.empty());
  EXPECT_TRUE(summary.remarks.empty());
  EXPECT_EQ(problem.ambient[0].knots, 0);
}

TEST(LoadSpectra, InterruptedWhileRefined) {
  IdentificationProblem problem = TwoAmbientRecords();
  FitSummary summary = FitOf(problem, 1e-18);
  IdentifiedModel model;
  Fits fits({0.5});
  fits.interrupts = true;
  SettleLoadSpectra({}, &fits, &problem, &summary, &model);
  EXPECT_EQ(summary.termination, Termination::kInterrupted);
  EXPECT_EQ(problem.ambient[0].knots, 0);
}

}  // namespace
}  // namespace pinode
