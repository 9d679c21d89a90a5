#include "pinode/watch/watch_analysis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "pinode/watch/watch_files.h"

namespace pinode {
namespace {

constexpr double kRecordStep = 3.0 * 3600.0;

// Few simulated records do, as no rate is counted here.
WatchedStructure Structure(double false_alarms_per_year = 4.0) {
  WatchedStructure structure;
  structure.chart.most_simulated = 6000;
  structure.chart.false_alarms_per_year = false_alarms_per_year;
  structure.name = "bridge";
  structure.reference.num_records = 500;
  WatchedCovariate temperature;
  temperature.name = "temperature";
  structure.covariates = {temperature};
  return structure;
}

// Records every three hours of a structure whose three frequencies follow the
// temperature. From record `from` on, modes 1 and 3 change by `change`.
std::vector<StoredRecord> Records(int count, int from, double change,
                                  double colder = 0.0) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<StoredRecord> records;
  for (int r = 0; r < count; ++r) {
    StoredRecord record;
    record.content = std::to_string(r);
    record.name = record.content + ".csv";
    record.time = 1.7e9 + kRecordStep * r;
    record.duration = 600.0;
    record.channels = {{"a", ""}, {"b", ""}};
    const double t = 10.0 + 8.0 * std::sin(0.03 * r) + normal(random) -
                     (r >= from ? colder : 0.0);
    record.covariates = {{"temperature", t}};
    for (int m = 0; m < 3; ++m) {
      StoredMode mode;
      const double is_changed = r >= from && m != 1 ? change : 0.0;
      mode.frequency_hz =
          3.0 * (1 + m) *
          std::exp(-1e-3 * t + 2e-3 * normal(random) + is_changed);
      mode.frequency_sigma = 2e-3 * mode.frequency_hz;
      mode.shape = ComplexVector::Ones(2);
      mode.shape[1] = 1.0 - m;
      record.modes.push_back(mode);
    }
    records.push_back(record);
  }
  return records;
}

TEST(WatchAnalysis, IsQuietWithoutAChange) {
  const WatchAnalysis analysis =
      AnalyseRecords(Structure(1.0), Records(1000, 1000, 0.0));
  ASSERT_TRUE(analysis.has_chart) << analysis.reason;
  EXPECT_EQ(analysis.series.num_features(), 3);
  for (const StoredEvent& event : analysis.events) {
    EXPECT_NE(event.kind, "alarm") << event.text;
  }
}

TEST(WatchAnalysis, NamesTheModesThatMoved) {
  const WatchAnalysis analysis =
      AnalyseRecords(Structure(), Records(900, 700, -0.005));
  ASSERT_TRUE(analysis.has_chart);
  EXPECT_EQ(analysis.light, WatchLight::kAlarm);
  const auto alarm = std::find_if(
      analysis.events.begin(), analysis.events.end(),
      [](const StoredEvent& event) { return event.kind == "alarm"; });
  ASSERT_NE(alarm, analysis.events.end());
  const double days = (alarm->time - (1.7e9 + kRecordStep * 700)) / 86400.0;
  EXPECT_GE(days, 0.0);
  EXPECT_LT(days, 3.0);
  // Mode 2 is the last of the three.
  EXPECT_GT(alarm->text.find("mode 2"), alarm->text.find("mode 1"));
  EXPECT_GT(alarm->text.find("mode 2"), alarm->text.find("mode 3"));
  EXPECT_NE(alarm->text.find("deviations"), std::string::npos);
}

// The chart counts a residual as four deviations at most. The text must not.
TEST(WatchAnalysis, AnAlarmPrintsTheWholeChange) {
  const WatchAnalysis analysis =
      AnalyseRecords(Structure(), Records(800, 700, std::log(0.95)));
  ASSERT_TRUE(analysis.has_chart);
  const auto alarm = std::find_if(
      analysis.events.begin(), analysis.events.end(),
      [](const StoredEvent& event) { return event.kind == "alarm"; });
  ASSERT_NE(alarm, analysis.events.end());
  EXPECT_EQ(alarm->time, 1.7e9 + kRecordStep * 700);
  for (const int mode : {1, 3}) {
    // In the record itself, also if the average raises the alarm.
    const size_t begin = alarm->text.find("mode " + std::to_string(mode));
    ASSERT_NE(begin, std::string::npos) << alarm->text;
    size_t at = alarm->text.find("Hz) ", begin);
    ASSERT_NE(at, std::string::npos) << alarm->text;
    if (alarm->text.find("lasting") == 0) {
      at = alarm->text.find("; ", at);
    } else {
      at += 3;
    }
    // Noise of 0.2 % in each record.
    EXPECT_NEAR(std::stod(alarm->text.substr(at + 1)), 100.0 * std::log(0.95),
                1.0)
        << alarm->text;
  }
}

// The average of a change that has lasted is the change.
TEST(WatchAnalysis, TheUnlimitedAverageIsTheMeanChange) {
  WatchAnalysis analysis =
      AnalyseRecords(Structure(), Records(900, 700, std::log(0.95)));
  ASSERT_TRUE(analysis.has_chart);
  const std::vector<Innovation> innovations =
      FilterSeries(analysis.series, analysis.model);
  const Matrix covariance = CovarianceWithOutside(analysis.model);
  ScoreAverage average(3, covariance.rows(), 3.0 * kDay);
  for (const Innovation& innovation : innovations) {
    average.Add(kRecordStep, innovation);
  }
  Vector change, deviation;
  average.Change(covariance, &change, &deviation);
  EXPECT_NEAR(change[0], std::log(0.95), 5.0 * deviation[0]);
  EXPECT_NEAR(change[1], 0.0, 5.0 * deviation[1]);
  EXPECT_NEAR(change[2], std::log(0.95), 5.0 * deviation[2]);
  EXPECT_LT(deviation.maxCoeff(), 0.002);
}

// Close modes are named one by one.
TEST(WatchAnalysis, ANameGoesToTheNearestModeOnly) {
  std::vector<StoredRecord> records = Records(40, 40, 0.0);
  for (StoredRecord& record : records) {
    record.modes.resize(2);
    // 5 % apart, with orthogonal shapes.
    record.modes[1].frequency_hz *= 0.525;
    record.modes[1].shape[1] = -1.0;
  }
  WatchedStructure structure = Structure();
  structure.reference.num_records = 35;
  structure.mode_names = {{2.9, "bending"}, {3.2, "torsion"}, {9.0, "far"}};
  const WatchAnalysis analysis = AnalyseRecords(structure, records);
  ASSERT_EQ(analysis.series.num_features(), 2);
  EXPECT_NE(analysis.series.names[0].find("Hz, bending)"), std::string::npos);
  EXPECT_NE(analysis.series.names[1].find("Hz, torsion)"), std::string::npos);
  structure.mode_names = {{3.1, "torsion"}};
  EXPECT_EQ(AnalyseRecords(structure, records).series.names[0].find("torsion"),
            std::string::npos);
}

// A record in a cold that was never learned is no evidence. Its notice says so,
// also if the light was on notice before.
TEST(WatchAnalysis, OneRecordOutsideOfTheLearnedRangeIsNoAlarm) {
  std::vector<StoredRecord> records = Records(700, 700, 0.0);
  for (const bool is_outside : {true, false}) {
    records[600].covariates = {{"temperature", is_outside ? -20.0 : 10.0}};
    for (int m = 0; m < 3; ++m) {
      StoredMode& mode = records[600].modes[static_cast<size_t>(m)];
      mode.frequency_hz = 3.0 * (1 + m) * (m == 1 ? 0.93 : 1.07);
    }
    const WatchAnalysis analysis = AnalyseRecords(Structure(), records);
    ASSERT_TRUE(analysis.has_chart);
    const double time = records[600].time;
    const bool said = std::any_of(
        analysis.events.begin(), analysis.events.end(),
        [time](const StoredEvent& event) {
          return event.time == time && event.kind == "notice" &&
                 event.text.find("learned range") != std::string::npos;
        });
    EXPECT_EQ(said, is_outside);
    EXPECT_EQ(analysis.lights[600] == WatchLight::kAlarm, !is_outside);
  }
}

// A turned sensor changes no frequency, but without its sign the modes would
// not fit their histories.
TEST(WatchAnalysis, ATurnedSensorIsNamedAndCostsNoHistory) {
  std::vector<StoredRecord> records = Records(700, 700, 0.0);
  for (size_t r = 0; r < records.size(); ++r) {
    records[r].channels = {{"a", ""}, {"b", ""}, {"c", ""}};
    for (int m = 0; m < 3; ++m) {
      ComplexVector& shape = records[r].modes[static_cast<size_t>(m)].shape;
      shape.resize(3);
      const double noise =
          0.01 * std::sin(7.0 * static_cast<double>(r + 5) + m);
      shape << 1.0, (m == 1 ? -1.0 : 0.8) + noise,
          (m == 2 ? -0.9 : 1.0) - noise;
      if (r >= 600) shape[1] *= -1.0;
    }
  }
  const WatchAnalysis analysis = AnalyseRecords(Structure(1.0), records);
  ASSERT_TRUE(analysis.has_chart);
  ASSERT_EQ(analysis.sensor_changes.size(), 1u);
  EXPECT_EQ(analysis.sensor_changes[0].channel, "b");
  // The summary goes on naming it.
  EXPECT_NE(WatchSummary(Structure(1.0), analysis)
                .find("\nLeft out: b (is turned: its sign is opposite to that "
                      "of the reference in every mode).\n"),
            std::string::npos);
  EXPECT_EQ(WatchSummary(Structure(1.0),
                         AnalyseRecords(Structure(1.0), Records(20, 20, 0.0)))
                .find("Left out"),
            std::string::npos);
  // All modes are watched until the end.
  EXPECT_FALSE(analysis.series.values.row(690).hasNaN());
  EXPECT_TRUE(std::any_of(analysis.events.begin(), analysis.events.end(),
                          [](const StoredEvent& event) {
                            return event.kind == "notice" &&
                                   event.text.find("channel 'b' is turned") !=
                                       std::string::npos;
                          }));
  for (const StoredEvent& event : analysis.events) {
    EXPECT_NE(event.kind, "alarm") << event.text;
  }
}

TEST(WatchAnalysis, MetricsAreLinesOfPrometheus) {
  WatchedStructure structure = Structure();
  structure.name = "a \"bridge\" \\ one";
  std::string text =
      WatchMetrics(structure, AnalyseRecords(structure, Records(20, 20, 0.0)));
  const std::string labels = "{structure=\"a \\\"bridge\\\" \\\\ one\"} ";
  EXPECT_NE(text.find("\npinode_watch_light" + labels + "0\n"),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("pinode_watch_t2"), std::string::npos);
  const WatchAnalysis analysis =
      AnalyseRecords(structure, Records(900, 700, -0.005));
  text = WatchMetrics(structure, analysis);
  EXPECT_NE(text.find("\npinode_watch_light" + labels + "3\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("pinode_watch_records" + labels + "900\n"),
            std::string::npos);
  EXPECT_NE(text.find("pinode_watch_average_limit" + labels),
            std::string::npos);
}

TEST(WatchAnalysis, AnAlarmEnds) {
  std::vector<StoredRecord> records = Records(1100, 700, -0.01);
  const std::vector<StoredRecord> well = Records(1100, 1100, 0.0);
  std::copy(well.begin() + 750, well.end(), records.begin() + 750);
  const WatchAnalysis analysis = AnalyseRecords(Structure(), records);
  ASSERT_TRUE(analysis.has_chart);
  EXPECT_EQ(analysis.lights[740], WatchLight::kAlarm);
  EXPECT_NE(analysis.light, WatchLight::kAlarm);
  EXPECT_TRUE(std::any_of(
      analysis.events.begin(), analysis.events.end(),
      [](const StoredEvent& event) { return event.kind == "all-clear"; }));
}

TEST(WatchAnalysis, TheOrderOfArrivalDoesNotMatter) {
  std::vector<StoredRecord> records = Records(800, 600, -0.004);
  const WatchAnalysis one = AnalyseRecords(Structure(), records);
  std::shuffle(records.begin(), records.end(), std::mt19937(3));
  const WatchAnalysis other = AnalyseRecords(Structure(), records);
  ASSERT_EQ(one.chart.size(), other.chart.size());
  for (size_t r = 0; r < one.chart.size(); ++r) {
    EXPECT_EQ(one.chart[r].average, other.chart[r].average);
    EXPECT_EQ(one.lights[r], other.lights[r]);
  }
  ASSERT_EQ(one.events.size(), other.events.size());
  for (size_t i = 0; i < one.events.size(); ++i) {
    EXPECT_EQ(one.events[i].text, other.events[i].text);
  }
  EXPECT_EQ(one.thresholds.alarm.t2, other.thresholds.alarm.t2);
}

TEST(WatchAnalysis, SaysThatAWinterIsOutsideOfTheRange) {
  const WatchAnalysis analysis =
      AnalyseRecords(Structure(1.0), Records(700, 600, 0.0, 15.0));
  ASSERT_TRUE(analysis.has_chart);
  bool is_said = false;
  for (const StoredEvent& event : analysis.events) {
    EXPECT_NE(event.kind, "alarm") << event.text;
    is_said = is_said || event.text.find("outside of the learned range") !=
                             std::string::npos;
  }
  EXPECT_TRUE(is_said);
}

TEST(WatchAnalysis, NamesFaultySensorsFirst) {
  std::vector<StoredRecord> records = Records(900, 700, -0.01);
  for (size_t r = 700; r < 900; ++r) {
    records[r].channels.push_back({"c", "is dead."});
  }
  const WatchAnalysis analysis = AnalyseRecords(Structure(), records);
  const auto alarm = std::find_if(
      analysis.events.begin(), analysis.events.end(),
      [](const StoredEvent& event) { return event.kind == "alarm"; });
  ASSERT_NE(alarm, analysis.events.end());
  EXPECT_LT(alarm->text.find("channel 'c' is left out"),
            alarm->text.find("mode "));
}

// Without a thermometer nothing is normal, and no alarm ends.
TEST(WatchAnalysis, SaysThatACovariateIsMissing) {
  for (const double change : {0.0, -0.01}) {
    std::vector<StoredRecord> records = Records(800, 600, change);
    for (size_t r = 650; r < 800; ++r) records[r].covariates.clear();
    const WatchAnalysis analysis = AnalyseRecords(Structure(1.0), records);
    ASSERT_TRUE(analysis.has_chart);
    EXPECT_EQ(analysis.light,
              change < 0.0 ? WatchLight::kAlarm : WatchLight::kNotice);
    ASSERT_FALSE(analysis.events.empty());
    EXPECT_NE(analysis.events.back().text.find("temperature is missing"),
              std::string::npos)
        << analysis.events.back().text;
  }
}

// A frequency that leaves its history raises no score.
TEST(WatchAnalysis, SaysThatAModeIsGone) {
  std::vector<StoredRecord> records = Records(700, 700, 0.0);
  for (size_t r = 600; r < 700; ++r) records[r].modes.pop_back();
  const WatchAnalysis analysis = AnalyseRecords(Structure(1.0), records);
  ASSERT_TRUE(analysis.has_chart);
  EXPECT_EQ(analysis.light, WatchLight::kNotice);
  const auto notice = std::find_if(
      analysis.events.begin(), analysis.events.end(),
      [](const StoredEvent& event) {
        return event.text.find("not found for 7 days: mode 3") == 0;
      });
  ASSERT_NE(notice, analysis.events.end());
  // It was there last in record 599.
  EXPECT_NEAR(notice->time, 1.7e9 + kRecordStep * 599 + 7.0 * 86400.0,
              kRecordStep);
}

// A mode that stopped within the reference is told by the first record after.
TEST(WatchAnalysis, SaysThatAModeWasGoneInTheReference) {
  std::vector<StoredRecord> records = Records(520, 520, 0.0);
  for (size_t r = 400; r < 520; ++r) records[r].modes.pop_back();
  const WatchAnalysis analysis = AnalyseRecords(Structure(1.0), records);
  ASSERT_TRUE(analysis.has_chart);
  EXPECT_EQ(analysis.light, WatchLight::kNotice);
  ASSERT_FALSE(analysis.events.empty());
  EXPECT_EQ(analysis.events[0].time, records[500].time);
  EXPECT_NE(analysis.events[0].text.find("mode 3"), std::string::npos);
  const std::string page =
      RenderWatchPage(Structure(1.0), analysis, HtmlReportOptions());
  EXPECT_NE(page.find("Notice: not found for 7 days: mode 3"),
            std::string::npos);
}

// One record raises the alarm. The modes that moved have no scores after it.
TEST(WatchAnalysis, AnAlarmDoesNotEndWithItsMode) {
  std::vector<StoredRecord> records = Records(900, 700, -0.05);
  for (size_t r = 701; r < 900; ++r) {
    const std::vector<StoredMode> modes = records[r].modes;
    // Mode 2 did not move.
    records[r].modes = {modes[1]};
  }
  const WatchAnalysis analysis = AnalyseRecords(Structure(), records);
  ASSERT_TRUE(analysis.has_chart);
  EXPECT_EQ(analysis.lights[700], WatchLight::kAlarm);
  EXPECT_LT(analysis.chart.back().average, analysis.thresholds.alarm.average);
  EXPECT_EQ(analysis.light, WatchLight::kAlarm);
}

TEST(WatchAnalysis, SaysThatNoRecordCouldBeUsed) {
  std::vector<StoredRecord> records = Records(700, 700, 0.0);
  for (size_t r = 600; r < 700; ++r) {
    records[r].refusal = "no channel can be used.";
    records[r].modes.clear();
  }
  const WatchAnalysis analysis = AnalyseRecords(Structure(1.0), records);
  ASSERT_TRUE(analysis.has_chart);
  EXPECT_EQ(analysis.num_refused, 100);
  EXPECT_EQ(analysis.light, WatchLight::kNotice);
  ASSERT_FALSE(analysis.events.empty());
  const StoredEvent& last = analysis.events.back();
  EXPECT_EQ(last.text,
            "no record could be used for 7 days; the last refusal: no channel "
            "can be used");
  EXPECT_NEAR(last.time, records[599].time + 7.0 * 86400.0, kRecordStep);
  // Earlier failures are over.
  std::vector<StoredRecord> later = Records(700, 700, 0.0);
  std::copy(records.begin() + 600, records.begin() + 640, later.begin() + 600);
  for (const StoredEvent& event :
       AnalyseRecords(Structure(1.0), later).events) {
    EXPECT_EQ(event.text.find("no record could"), std::string::npos);
  }
}

TEST(WatchAnalysis, LearnsUntilTheReferenceIsComplete) {
  const WatchAnalysis analysis =
      AnalyseRecords(Structure(), Records(499, 499, 0.0));
  EXPECT_FALSE(analysis.has_chart);
  EXPECT_EQ(analysis.light, WatchLight::kLearning);
  EXPECT_NE(analysis.reason.find("not complete"), std::string::npos);
}

TEST(WatchAnalysis, CountsTheReferenceFromItsBegin) {
  WatchedStructure structure = Structure();
  const std::vector<StoredRecord> records = Records(549, 549, 0.0);
  structure.reference.from = records[50].time;
  const WatchAnalysis analysis = AnalyseRecords(structure, records);
  EXPECT_FALSE(analysis.is_reference[49]);
  EXPECT_TRUE(analysis.is_reference[50]);
  // Records 50 to 548 are one too few.
  EXPECT_FALSE(analysis.reference_is_complete);
}

TEST(WatchAnalysis, TakesTheLongestOfRecordsOfOneTime) {
  std::vector<StoredRecord> records = Records(600, 600, 0.0);
  StoredRecord part = records[550];
  part.content = "part";
  part.duration = 60.0;
  records.push_back(part);
  StoredRecord refused = records[10];
  refused.content = "refused";
  refused.refusal = "no modes";
  records.push_back(refused);
  const WatchAnalysis analysis = AnalyseRecords(Structure(), records);
  EXPECT_EQ(analysis.records.size(), 600u);
  EXPECT_EQ(analysis.num_repeated, 1);
  EXPECT_EQ(analysis.num_refused, 1);
  EXPECT_EQ(analysis.records[550].duration, 600.0);
}

}  // namespace
}  // namespace pinode
