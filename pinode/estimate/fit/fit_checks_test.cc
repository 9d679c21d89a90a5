#include "pinode/estimate/fit/fit_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

IdentificationSummary GoodSummary() {
  IdentificationSummary summary;
  summary.termination = Termination::kConverged;
  summary.message = "converged";
  RecordScore train;
  train.name = "t";
  train.finite = true;
  train.nrmse = 0.1;
  train.prior_nrmse = 0.5;
  RecordScore holdout = train;
  holdout.name = "h";
  holdout.role = IdentificationRecord::Role::kHoldout;
  holdout.nrmse = holdout.prior_nrmse;
  summary.records = {train, holdout};
  return summary;
}

std::string Judged(IdentificationSummary summary) {
  testing::JudgeFit(GapTuning(), &summary);
  EXPECT_FALSE(summary.usable());
  return summary.message;
}

TEST(Usable, WhatHasAllItNeeds) {
  IdentificationSummary summary = GoodSummary();
  testing::JudgeFit(GapTuning(), &summary);
  EXPECT_TRUE(summary.usable());
  EXPECT_EQ(summary.message, "converged");
  summary.final_damping = -0.012;
  summary.negative_damping_allowed = true;
  testing::JudgeFit(GapTuning(), &summary);
  EXPECT_TRUE(summary.usable());
}

// Residuals of few lines cannot tell a wrong model.
TEST(CheckDoubts, FewLinesOfFrequencyResponses) {
  FitSummary summary;
  FrfScore score;
  score.name = "f";
  score.num_lines = 99;
  score.pairs = {"u1/u1"};
  summary.frfs = {score};
  const std::vector<Finding> findings = CheckDoubts(summary);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].check, "frf_few_lines");
  EXPECT_EQ(findings[0].grade, Grade::kWithCare);
  EXPECT_THAT(findings[0].what, HasSubstr("99 lines"));
  summary.frfs[0].num_lines = 100;
  EXPECT_TRUE(CheckDoubts(summary).empty());
}

TEST(Usable, SaysWhatIsMissing) {
  IdentificationSummary summary = GoodSummary();
  summary.records[1].finite = false;
  EXPECT_THAT(Judged(summary), HasSubstr("record 'h' is not finite"));
  summary = GoodSummary();
  summary.records[0].nrmse = 0.5;  // no better is not enough here
  EXPECT_THAT(Judged(summary), HasSubstr("not predict record 't' better"));
  summary = GoodSummary();
  summary.records[1].nrmse = 0.51;
  EXPECT_THAT(Judged(summary), HasSubstr("not predict record 'h' better"));
  summary = GoodSummary();
  summary.records[1].nrmse = 1.05;
  summary.records[1].prior_nrmse = 2.0;
  EXPECT_THAT(Judged(summary), HasSubstr("than no motion at all"));
  summary = GoodSummary();
  summary.records[1].nrmse = 0.51;
  summary.records[1].prior_nrmse = 0.9;
  EXPECT_THAT(Judged(summary), HasSubstr("does not carry over"));
  summary = GoodSummary();
  summary.linear_error = 0.09;
  EXPECT_THAT(Judged(summary), HasSubstr("than its linear terms alone"));
  summary = GoodSummary();
  summary.stalled = true;
  summary.termination = Termination::kNoConvergence;
  EXPECT_THAT(Judged(summary), HasSubstr("stopped before a minimum"));
  summary = GoodSummary();
  summary.final_damping = -0.012;
  EXPECT_THAT(Judged(summary), HasSubstr("negative damping (-1.2 %)"));
  summary = GoodSummary();
  summary.largest_gap = 2e-6;
  EXPECT_THAT(Judged(summary), HasSubstr("gaps between segments stayed open"));
  summary = GoodSummary();
  summary.termination = Termination::kNoConvergence;
  EXPECT_THAT(Judged(summary), HasSubstr("not converged after"));
  summary = GoodSummary();
  summary.followed_channel = "a1";
  EXPECT_THAT(Judged(summary), HasSubstr("follows channel 'a1'"));
  summary = GoodSummary();
  summary.termination = Termination::kInterrupted;
  EXPECT_EQ(Judged(summary), "converged") << "the message is left alone";
  summary = GoodSummary();
  summary.records.clear();
  summary.modes.resize(1);
  summary.modes[0].frequency = 2.0;
  summary.modes[0].updated = {0, 2.0, 1.0};
  summary.initial_modal_cost = summary.final_modal_cost = 1.0;
  EXPECT_THAT(Judged(summary),
              HasSubstr("does not meet the measured modes better"));
  summary.modes[0].initial = summary.modes[0].updated;
  testing::JudgeFit(GapTuning(), &summary);
  EXPECT_TRUE(summary.usable()) << summary.message;
}

// Of a fit to modes alone, which are to be added.
IdentificationSummary SummaryOfModes() {
  IdentificationSummary summary = GoodSummary();
  summary.records.clear();
  summary.initial_modal_cost = 2.0;
  summary.final_modal_cost = 1.0;
  return summary;
}

// As where a sensor is upside down: shapes drive frequencies away.
TEST(Usable, FrequenciesAreNotDrivenAway) {
  IdentificationSummary summary = SummaryOfModes();
  ModeScore mode;
  mode.name = "sway";
  mode.frequency = 1.0;
  mode.initial = {0, 1.006, 0.7};
  mode.updated = {0, 1.08, 0.9};
  summary.modes = {mode, mode};
  summary.modes[1].updated.frequency = 1.0;
  EXPECT_THAT(Judged(summary),
              HasSubstr("within 8 %, the initial model within 0.6 %"));
  summary.modes[0].updated.frequency = 1.019;
  testing::JudgeFit(GapTuning(), &summary);
  EXPECT_TRUE(summary.usable()) << "two per cent are met";
  summary.modes[0].initial.frequency = 0.95;
  summary.modes[0].updated.frequency = 1.08;
  testing::JudgeFit(GapTuning(), &summary);
  EXPECT_TRUE(summary.usable()) << "it was not met before";
  summary.modes[0].initial.frequency = 0.8;
  summary.modes[0].updated.frequency = 1.11;
  EXPECT_THAT(Judged(summary),
              HasSubstr("error of a measured frequency is still 11 %"));
}

// However well they are met.
TEST(Usable, FrequenciesAreNotInRadiansPerSecond) {
  IdentificationSummary summary = SummaryOfModes();
  ModeScore mode;
  mode.name = "sway";
  mode.frequency = 6.0;
  mode.updated = {0, 6.0, 1.0};
  summary.modes = {mode, mode, mode};
  const std::vector<double> before = {1.0, 0.9, 6.0};
  for (size_t j = 0; j < before.size(); ++j) {
    summary.modes[j].initial = {0, before[j], 1.0};
  }
  EXPECT_THAT(Judged(summary),
              HasSubstr("are 6 times those of the initial model"));
  summary.modes[0].initial.frequency = 2.1;
  testing::JudgeFit(GapTuning(), &summary);
  EXPECT_TRUE(summary.usable()) << "two of three are not far off";
  for (ModeScore& each : summary.modes) each.initial.frequency = 40.0;
  EXPECT_THAT(Judged(summary), HasSubstr("are 0.15 times"));
}

TEST(Usable, MeasuredModesAreStillThoseOfTheModel) {
  IdentificationSummary summary = SummaryOfModes();
  ModeScore mode;
  mode.name = "sway";
  mode.frequency = 2.0;
  mode.initial = {0, 3.0, 0.9};
  summary.modes = {mode};
  summary.num_model_modes = 2;
  testing::JudgeFit(GapTuning(), &summary);
  EXPECT_FALSE(summary.usable());
  EXPECT_THAT(summary.message,
              HasSubstr("only 0 of 1 measured modes are like a mode"));
  summary.modes.resize(5, mode);
  EXPECT_THAT(Judged(summary),
              HasSubstr("only 0 of 5 measured modes are like a mode"));
  summary.modes[3].updated = {1, 2.0, 1.0};
  EXPECT_THAT(Judged(summary),
              HasSubstr("only 1 of 5 measured modes are like a mode"));
  summary.modes[4].updated = {0, 2.0, 1.0};
  testing::JudgeFit(GapTuning(), &summary);
  EXPECT_TRUE(summary.usable()) << "both that the model has";
  summary.num_model_modes = 3;
  EXPECT_THAT(Judged(summary),
              HasSubstr("only 2 of 5 measured modes are like a mode"));
  summary.modes = {mode, mode};
  summary.modes[1].updated = {1, 2.0, 1.0};
  EXPECT_THAT(Judged(summary),
              HasSubstr("only 1 of 2 measured modes are like a mode"));
  summary.modes[0].updated = {0, 2.0, 1.0};
  ModeMatch& match = summary.modes[0].updated;
  match = {0, 2.18, 0.6};
  testing::JudgeFit(GapTuning(), &summary);
  EXPECT_TRUE(summary.usable()) << summary.message;
  match.mac = kNaN;
  testing::JudgeFit(GapTuning(), &summary);
  EXPECT_TRUE(summary.usable()) << "no shape was measured";
  match = {0, 2.8, 0.99};
  EXPECT_THAT(Judged(summary),
              HasSubstr("'sway' (the nearest: 40 % in frequency, MAC 0.99)"));
  match = {0, 2.1, 0.4};
  EXPECT_THAT(Judged(summary), HasSubstr("5 % in frequency, MAC 0.4)"));
  match = {0, kNaN, 1.0};
  EXPECT_THAT(Judged(summary), HasSubstr("without a frequency, MAC 1)"));
}

// With a wrong load a model before is easily improved upon.
TEST(Usable, MostOfTheMotionIsFollowed) {
  IdentificationSummary summary = GoodSummary();
  ChannelScore channel;
  channel.nrmse = summary.records[0].nrmse = 0.5;
  channel.noise_share = 0.2;  // 0.45 is no noise
  summary.records[0].prior_nrmse = 1.5;
  summary.records[0].channels = {channel};
  EXPECT_THAT(Judged(summary),
              HasSubstr("50 % of the motion of record 't' is unexplained"));
  summary.records[0].channels[0].noise_share = 0.5;  // 0.35
  testing::JudgeFit(GapTuning(), &summary);
  EXPECT_TRUE(summary.usable());
  // All of it is noise where samples are out of order.
  summary.records[0].nrmse = 0.99;
  summary.records[0].channels[0].noise_share = 1.0;
  EXPECT_THAT(Judged(summary), HasSubstr("than no motion at all"));
}

// What a network leaves over must be noise, or little.
TEST(Usable, NetworksHaveLearnedWhatThereIs) {
  IdentificationSummary summary = GoodSummary();
  summary.records[0].nrmse = 0.15;
  ChannelScore channel;
  channel.nrmse = 0.15;
  channel.noise_share = 0.02;
  summary.records[0].channels = {channel};
  testing::JudgeFit(GapTuning(), &summary);
  EXPECT_TRUE(summary.usable()) << "a law may be what somebody wants";
  summary.learns_force = true;
  EXPECT_THAT(Judged(summary), HasSubstr("the network leaves 15 %"));
  summary.records[0].channels[0].noise_share = 0.9;
  testing::JudgeFit(GapTuning(), &summary);
  EXPECT_TRUE(summary.usable());
}

// Half of the motion wrong is not wrong where the training records are as bad.
TEST(Usable, HoldoutsMayBeAsBadAsTrainingRecords) {
  IdentificationSummary summary = GoodSummary();
  summary.records[0].nrmse = 0.2;
  summary.records[1].nrmse = 0.55;
  summary.records[1].prior_nrmse = 0.9;
  testing::JudgeFit(GapTuning(), &summary);
  EXPECT_TRUE(summary.usable());
  // But for nearly all of it, unless it is noise.
  summary.records[0].nrmse = 0.35;
  ChannelScore channel;
  channel.nrmse = summary.records[1].nrmse = 0.85;
  channel.noise_share = 0.1;
  summary.records[1].channels = {channel};
  EXPECT_THAT(Judged(summary), HasSubstr("does not carry over"));
  summary.records[1].channels[0].noise_share = 0.9;
  testing::JudgeFit(GapTuning(), &summary);
  EXPECT_TRUE(summary.usable());
}

// Two groups, of which one record says this.
IdentificationSummary AmbientSummary(double left, double half_width) {
  IdentificationSummary summary;
  summary.termination = Termination::kConverged;
  summary.message = "converged";
  AmbientScore score;
  score.name = "wind";
  score.groups = {"k1", "k2"};
  score.information_left = Vector::Constant(2, left);
  score.most_information_left = 0.9;
  summary.ambient = {score};
  for (const std::string& name : score.groups) {
    ParameterEstimate group;
    group.name = name;
    group.value = 0.3;
    group.sigma = 0.5 * half_width;
    group.lower95 = group.value - half_width;
    group.upper95 = group.value + half_width;
    group.free = true;
    summary.parameters.push_back(group);
  }
  summary.covariance = Matrix::Identity(2, 2);
  return summary;
}

// A combination of groups that looks well told is not enough.
TEST(Usable, GroupsHaveToBeTold) {
  const auto usable = [](IdentificationSummary summary) {
    testing::JudgeFit(GapTuning(), &summary);
    return summary.usable();
  };
  EXPECT_TRUE(usable(AmbientSummary(0.5, 0.9)));
  EXPECT_THAT(Judged(AmbientSummary(0.001, 0.9)),
              HasSubstr("none of 'k1', 'k2' is determined by the data"));
  // What is left beside all modes is not enough for honest intervals.
  EXPECT_FALSE(usable(AmbientSummary(0.05, 0.9)));
  // Half of them are enough; not where they are not known.
  IdentificationSummary one = AmbientSummary(0.001, 0.9);
  one.ambient[0].information_left[1] = 0.2;
  EXPECT_TRUE(usable(one));
  one.parameters[1].upper95 = one.parameters[1].value + 1.1;
  EXPECT_FALSE(usable(one));
  // What no loads hide and no record tells is not their fault.
  IdentificationSummary open = AmbientSummary(0.5, 0.9);
  open.parameters[1].upper95 = open.parameters[1].value + 1e9;
  EXPECT_TRUE(usable(open));
  // A second record tells what the first hides.
  IdentificationSummary two = AmbientSummary(0.001, 0.9);
  two.ambient.push_back(AmbientSummary(0.5, 0.9).ambient[0]);
  EXPECT_TRUE(usable(two));
  // Hidden, and an interval that is too narrow to be true.
  EXPECT_FALSE(usable(AmbientSummary(0.001, 0.03)));
  // Damping alone is not the structure.
  IdentificationSummary damping = AmbientSummary(0.05, 0.1);
  damping.ambient[0].groups.push_back("c_mass");
  damping.ambient[0].information_left = Vector::Constant(3, 0.05);
  damping.ambient[0].information_left[2] = 0.9;
  damping.parameters.push_back(damping.parameters[0]);
  damping.parameters[2].name = "c_mass";
  EXPECT_THAT(Judged(damping),
              HasSubstr("not determined by the data: 'k1', 'k2'"));
  // Large numbers in their own unit are known to a part of themselves.
  IdentificationSummary large = AmbientSummary(0.5, 1e4);
  for (ParameterEstimate& group : large.parameters) {
    group.value = 1e6;
    group.upper95 = group.value + 1e4;
  }
  EXPECT_TRUE(usable(large));
  // Records and modes have verdicts of their own.
  IdentificationSummary beside = AmbientSummary(0.001, 1.0);
  beside.records = GoodSummary().records;
  EXPECT_TRUE(usable(beside));
}

}  // namespace
}  // namespace pinode
