#include "pinode/study/load_spectra.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/dynamics/testing.h"
#include "pinode/estimate/testing.h"
#include "pinode/study/checkpoint.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

IdentificationProblem TwoAmbientRecords() {
  IdentificationProblem problem;
  problem.dynamics = testing::MakeGroupedChain(3, 100.0, 0.5);
  problem.ambient.resize(2);
  problem.ambient[0].name = "monday";
  problem.ambient[1].name = "tuesday";
  problem.ambient[1].knots = 5;
  return problem;
}

IdentificationSummary FitOf(const IdentificationProblem& problem,
                            double probability) {
  IdentificationSummary summary;
  summary.termination = Termination::kConverged;
  summary.seconds = 1.0;
  summary.final_cost = 10.0 - probability;
  for (const AmbientRecord& record : problem.ambient) {
    AmbientScore score;
    score.name = record.name;
    score.num_knots = record.knots > 0 ? record.knots : 7;
    score.probability = record.name == "monday" ? probability : 0.5;
    score.degrees_of_freedom = 100;
    score.chi_square = 1e5 / score.num_knots;
    summary.ambient.push_back(score);
  }
  return summary;
}

// Fits that end as they are told to, and remember what they were asked.
class Fits {
 public:
  explicit Fits(std::vector<double> probabilities)
      : probabilities_(std::move(probabilities)) {}
  FitFunction Function() {
    return [this](const std::string&, const IdentificationProblem& problem,
                  const IdentificationOptions&, const IdentifiedModel* begin,
                  IdentificationSummary* summary, IdentifiedModel* model) {
      knots.push_back(problem.ambient[0].knots);
      identities.push_back(ProblemIdentity(problem));
      EXPECT_NE(begin, nullptr);
      *summary = FitOf(problem, probabilities_[knots.size() - 1]);
      if (interrupts) summary->termination = Termination::kInterrupted;
      model->parameters =
          Vector::Constant(1, static_cast<double>(knots.back()));
    };
  }
  std::vector<int> knots;
  std::vector<std::string> identities;
  bool interrupts = false;

 private:
  std::vector<double> probabilities_;
};

TEST(LoadSpectra, KnotsThatSomebodyGaveStay) {
  const IdentificationProblem given = TwoAmbientRecords();
  IdentificationSummary summary = FitOf(given, 1e-9);
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
  IdentificationSummary summary = FitOf(problem, 1e-18);
  IdentifiedModel model;
  Fits fits({1e-17, 0.3, 0.9});
  SettleLoadSpectra(fits.Function(), {}, &problem, &summary, &model);
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
              HasSubstr("stands is 'monday' with 13 knots (probability 0.3)"));
}

TEST(LoadSpectra, TheBestStandsWhereNoneIsGood) {
  IdentificationProblem problem = TwoAmbientRecords();
  IdentificationSummary summary = FitOf(problem, 1e-18);
  IdentifiedModel model;
  Fits fits({1e-19, 1e-7, 1e-9});
  SettleLoadSpectra(fits.Function(), {}, &problem, &summary, &model);
  EXPECT_THAT(fits.knots, ElementsAre(0, 13, 25));
  EXPECT_EQ(problem.ambient[0].knots, 13);
  EXPECT_EQ(model.parameters[0], 13.0);
  EXPECT_EQ(summary.ambient[0].probability, 1e-7);
}

// What is too small to be told from zero is smaller yet with coarser spectra.
TEST(LoadSpectra, NearerStandsWhereNoProbabilityIsLeft) {
  IdentificationProblem problem = TwoAmbientRecords();
  IdentificationSummary summary = FitOf(problem, 0.0);
  summary.way = "by stages";
  summary.linear_error = 0.25;
  summary.choice.complete = true;
  summary.choice.candidates = summary.choice.left_out = {"spring"};
  IdentifiedModel model;
  Fits fits({0.0, 0.0, 0.0});
  SettleLoadSpectra(fits.Function(), {}, &problem, &summary, &model);
  EXPECT_EQ(problem.ambient[0].knots, 25);
  EXPECT_EQ(model.parameters[0], 25.0);
  EXPECT_EQ(summary.way, "by stages");
  EXPECT_EQ(summary.linear_error, 0.25);
  ASSERT_EQ(summary.remarks.size(), 2u);
  EXPECT_EQ(summary.remarks[0], summary.choice.Sentence());
  EXPECT_THAT(summary.remarks[1], HasSubstr("13 knots (probability 0); then"));
}

// With the same knots: what the first fit took for loads was of its start.
TEST(LoadSpectra, FoundAnewAtTheModel) {
  IdentificationProblem problem = TwoAmbientRecords();
  IdentificationSummary summary = FitOf(problem, 1e-3);
  summary.way = "by stages";
  IdentifiedModel model;
  Fits fits({0.4});
  SettleLoadSpectra(fits.Function(), {}, &problem, &summary, &model);
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
  SettleLoadSpectra(worse.Function(), {}, &problem, &summary, &model);
  EXPECT_THAT(worse.knots, ElementsAre(0));
  EXPECT_EQ(summary.ambient[0].probability, 1e-3);
}

TEST(LoadSpectra, NothingToRefine) {
  IdentificationProblem problem = TwoAmbientRecords();
  IdentificationSummary summary = FitOf(problem, 0.5);
  IdentifiedModel model;
  Fits fits({});
  SettleLoadSpectra(fits.Function(), {}, &problem, &summary, &model);
  EXPECT_TRUE(fits.knots.empty());
  EXPECT_TRUE(summary.remarks.empty());
  EXPECT_EQ(problem.ambient[0].knots, 0);
}

TEST(LoadSpectra, InterruptedWhileRefined) {
  IdentificationProblem problem = TwoAmbientRecords();
  IdentificationSummary summary = FitOf(problem, 1e-18);
  summary.usable = true;
  IdentifiedModel model;
  Fits fits({0.5});
  fits.interrupts = true;
  SettleLoadSpectra(fits.Function(), {}, &problem, &summary, &model);
  EXPECT_EQ(summary.termination, Termination::kInterrupted);
  EXPECT_FALSE(summary.usable);
  EXPECT_EQ(problem.ambient[0].knots, 0);
}

}  // namespace
}  // namespace pinode
