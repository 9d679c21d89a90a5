#include "pinode/report/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "pinode/base/constants.h"
#include "tests/support/report_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST(VerdictSentence, PutsTheHoldoutScoreFirst) {
  const auto example = testing::MakeReportExample();
  example->summary.records[1].nrmse = 0.0312;
  example->summary.records[1].prior_nrmse = 0.45;
  EXPECT_EQ(VerdictSentence(example->input),
            "Good. The updated model predicts the hold-out record "
            "'south_quake' well, with an error of 3.12 % (initial model: "
            "45.0 %).");
  for (ChannelScore& channel : example->summary.records[1].channels) {
    channel.nrmse = 0.0312;
    channel.noise_share = 0.25;
  }
  EXPECT_THAT(
      VerdictSentence(example->input),
      HasSubstr("45.0 %; noise explains 25 % of the remaining error)."));
  example->summary.records[1].nrmse = 0.6;
  EXPECT_THAT(VerdictSentence(example->input),
              HasSubstr("'south_quake' poorly, with"));
}

// A twentieth of the motion, where it is most of what is left over.
TEST(VerdictSentence, SaysWhatIsMissedBesideLittleNoise) {
  const auto example = testing::MakeReportExample();
  RecordScore& train = example->summary.records[0];
  ASSERT_EQ(train.role, IdentificationRecord::Role::kTrain);
  train.nrmse = 0.056;
  for (ChannelScore& channel : train.channels) {
    channel.nrmse = 0.056;
    channel.noise_share = 0.13;
  }
  EXPECT_THAT(VerdictSentence(example->input),
              HasSubstr("Of the measured motion 5.22 % is unexplained and too "
                        "large to be noise."));
  for (ChannelScore& channel : train.channels) channel.noise_share = 0.6;
  EXPECT_THAT(VerdictSentence(example->input), Not(HasSubstr("unexplained")));
}

TEST(VerdictSentence, SaysThatNothingWasHeldOut) {
  const auto example = testing::MakeReportExample();
  example->summary.records.pop_back();
  EXPECT_THAT(VerdictSentence(example->input),
              StartsWith("Good, but untested"));
}

TEST(VerdictSentence, SaysHowMeasuredModesAreMet) {
  const auto example = testing::MakeReportExample();
  example->summary.records.clear();
  ModeScore mode;
  mode.frequency = 2.0;
  mode.initial = {0, 2.2, 0.91};
  mode.updated = {0, 1.99, 0.9987};
  example->summary.modes.push_back(mode);
  mode.updated = {1, 2.0, 0.75};
  example->summary.modes.push_back(mode);
  EXPECT_THAT(VerdictSentence(example->input),
              HasSubstr("The model meets the measured frequencies within "
                        "0.500 % (initial model: 10.0 %) and the shapes with a "
                        "MAC of at least 0.7500."));
  for (ModeScore& score : example->summary.modes) {
    score.updated.mac = std::nan("");
  }
  EXPECT_THAT(VerdictSentence(example->input),
              HasSubstr("(initial model: 10.0 %)."));
}

TEST(VerdictSentence, NamesEveryFinding) {
  const auto example = testing::MakeReportExample();
  example->summary.verdict = Verdict(std::vector<Finding>{
      {"not_converged", "not converged after 200 iterations", 200.0, kNaN,
       "raise options.max_iterations"},
      {"negative_damping", "a mode has negative damping (-1 %)"}});
  EXPECT_EQ(VerdictSentence(example->input),
            "Not usable: not converged after 200 iterations. Raise "
            "options.max_iterations. A mode has negative damping (-1 %).");
}

TEST(VerdictSentence, OfWhatWasNeverJudged) {
  const auto example = testing::MakeReportExample();
  example->summary = IdentificationSummary();
  EXPECT_EQ(VerdictSentence(example->input),
            "Not usable: the identification has not been started.");
}

TEST(Report, NamesPlacesAndUnitsOfChannels) {
  const auto example = testing::MakeReportExample();
  EXPECT_EQ(ChannelPlace(example->input, 0, 1), "u2");
  EXPECT_EQ(ChannelUnit(example->input, 0, 1), "m/s^2");
  Observation& observation =
      example->problem.records[0].channels[1].observation;
  observation.weights << -1.0, 2.5, 0.0;
  observation.quantity = Quantity::kDisplacement;
  EXPECT_EQ(ChannelPlace(example->input, 0, 1), "-u1 + 2.5 u2");
  EXPECT_EQ(ChannelUnit(example->input, 0, 1), "m");
  example->problem.records[0].channels[1].description.unit = "1";
  EXPECT_EQ(ChannelUnit(example->input, 0, 1), "1");
}

TEST(Report, NoiseShareIgnoresOffsetsAndMissingSamples) {
  const auto example = testing::MakeReportExample();
  Vector& values = example->problem.records[0].channels[0].values;
  for (int i = 0; i < values.size(); ++i)
    values(i) = 7.0 + (i % 2 ? 2.0 : -2.0);
  values.head(100).setConstant(std::nan(""));
  example->summary.records[0].channels[0].sigma = 0.1;
  EXPECT_NEAR(NoiseShare(example->input, 0, 0), 0.05, 1e-12);
  values.setConstant(1.0);
  EXPECT_TRUE(std::isnan(NoiseShare(example->input, 0, 0)));
}

}  // namespace
}  // namespace pinode
