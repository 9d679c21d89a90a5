#include "pinode/case/draft/log_file.h"

#include <cmath>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/arrays/matlab_writer.h"
#include "pinode/base/strings.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Files of tests/generators/logger_files.py and array_files.py.
std::string LogSample(const std::string& name) {
  return std::string(PINODE_SOURCE_DIR) + "/tests/fuzz/corpus/" + name;
}

TEST(LogFileTest, FileOfALoggerStatesRateAndUnits) {
  LogOptions options;
  options.ignored = {"late", "undated", "T"};
  LogFile log;
  DraftQuestion question;
  std::string error;
  ASSERT_TRUE(ReadLogFile(LogSample("tdms/rates.tdms"), options, &log,
                          &question, &error))
      << error << question.text;
  EXPECT_EQ(log.time_column, "t");
  EXPECT_FALSE(log.is_time_unit_assumed);
  EXPECT_THAT(log.ColumnNames(), ElementsAre("a", "b"));
  EXPECT_EQ(log.columns[0].unit, "m/s^2");
  EXPECT_NEAR(log.step, 0.01, 1e-15);
  EXPECT_EQ(log.num_samples(), 398);
  EXPECT_THAT(log.reading, HasSubstr("'g/b' resampled from 200 to 100 Hz"));
}

TEST(LogFileTest, ClocksThatDoNotFitAreNamed) {
  LogFile log;
  DraftQuestion question;
  std::string error;
  EXPECT_FALSE(
      ReadLogFile(LogSample("tdms/rates.tdms"), {}, &log, &question, &error));
  EXPECT_THAT(error, HasSubstr("Leave one of them out"));
}

TEST(LogFileTest, LvmWithADelimiterIsText) {
  const TemporaryFolder folder;
  std::string text = "LabVIEW Measurement\t\nX_Value\tacc_1 [g]\n";
  for (int i = 0; i < 100; ++i) {
    text +=
        FormatNumber(0.01 * i) + "\t" + FormatNumber(std::sin(0.7 * i)) + "\n";
  }
  const std::string path = folder.Write("log.lvm", text);
  LogOptions options;
  options.time = "X_Value";
  options.time_unit = "s";
  LogFile log;
  DraftQuestion question;
  std::string error;
  EXPECT_FALSE(ReadLogFile(path, options, &log, &question, &error));
  options.format.header_lines = 2;
  options.format.delimiter = '\t';
  ASSERT_TRUE(ReadLogFile(path, options, &log, &question, &error)) << error;
  ASSERT_EQ(log.columns.size(), 1u);
  EXPECT_EQ(log.columns[0].unit, "g");
}

TEST(LogFileTest, ArraysAreReadToo) {
  LogFile log;
  DraftQuestion question;
  std::string error;
  EXPECT_FALSE(
      ReadLogFile(LogSample("arrays/record.npz"), {}, &log, &question, &error));
  EXPECT_THAT(error, HasSubstr("7 samples, expected 64 or more"));
}

// The time of a structure is no channel, also beside a sampling rate.
TEST(LogFileTest, TimeOfAStructure) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("log.mat");
  std::string error;
  MatlabWriter writer(path);
  const Vector times = Vector::LinSpaced(100, 0.0, 0.99);
  writer.AddStructure(
      "data", {{"time", times, {}}, {"acc", times.array().cos().matrix(), {}}});
  ASSERT_TRUE(writer.Close(&error)) << error;
  for (const double rate : {0.0, 50.0}) {
    LogFile log;
    DraftQuestion question;
    LogOptions options;
    options.sampling_rate_hz = rate;
    ASSERT_TRUE(ReadLogFile(path, options, &log, &question, &error)) << error;
    EXPECT_EQ(log.time_column, rate > 0.0 ? "" : "data.time");
    EXPECT_NEAR(log.step, rate > 0.0 ? 0.02 : 0.01, 1e-12);
    ASSERT_EQ(log.columns.size(), 1u);
    EXPECT_EQ(log.columns[0].name, "data.acc");
    EXPECT_EQ(log.unused_times.size(), rate > 0.0 ? 1u : 0u);
  }
  // A time that is none of the file's.
  LogFile log;
  DraftQuestion question;
  LogOptions options;
  options.time = "tt";
  EXPECT_FALSE(ReadLogFile(path, options, &log, &question, &error));
  EXPECT_THAT(error, HasSubstr("no array is called 'tt'"));
}

// Writes two structures, the second one's times in steps of `step`.
std::string WriteTwoClocks(const TemporaryFolder& folder, double step) {
  const std::string path = folder.Path("clocks.mat");
  const Vector times = Vector::LinSpaced(100, 0.0, 0.99);
  MatlabWriter writer(path);
  writer.AddMatrix("t", times);
  writer.AddMatrix("x", times.array().cos().matrix());
  writer.AddStructure("b", {{"t", Vector(times * (step / 0.01)), {}},
                            {"x", times.array().sin().matrix(), {}}});
  std::string error;
  EXPECT_TRUE(writer.Close(&error)) << error;
  return path;
}

TEST(LogFileTest, TwoClocksOfArrays) {
  const TemporaryFolder folder;
  std::string path = WriteTwoClocks(folder, 0.005);
  std::string error;
  for (const double rate : {0.0, 100.0}) {
    LogFile log;
    DraftQuestion question;
    LogOptions options;
    options.sampling_rate_hz = rate;
    EXPECT_FALSE(ReadLogFile(path, options, &log, &question, &error));
    EXPECT_THAT(error, HasSubstr("the times of 't' and 'b.t' differ"));
    EXPECT_THAT(error, HasSubstr("--ignore=b.t"));
  }
  LogFile log;
  DraftQuestion question;
  LogOptions options;
  options.ignored = {"t", "x"};
  ASSERT_TRUE(ReadLogFile(path, options, &log, &question, &error)) << error;
  EXPECT_EQ(log.time_column, "b.t");
  EXPECT_NEAR(log.step, 0.005, 1e-12);
  EXPECT_THAT(log.ColumnNames(), ElementsAre("b.x"));
  // One clock twice.
  path = WriteTwoClocks(folder, 0.01);
  ASSERT_TRUE(ReadLogFile(path, {}, &log, &question, &error)) << error;
  EXPECT_EQ(log.time_column, "t");
  EXPECT_THAT(log.ColumnNames(), ElementsAre("x", "b.x"));
  EXPECT_THAT(log.unused_times, ElementsAre("b.t"));
}

// A transverse sensor beside others is no time, with a rate or without.
TEST(LogFileTest, SensorsCalledT) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("sensors.mat");
  const Vector times = Vector::LinSpaced(100, 0.0, 0.99);
  MatlabWriter writer(path);
  writer.AddMatrix("time", times);
  writer.AddStructure("acc", {{"L", times.array().cos().matrix(), {}},
                              {"T", times.array().sin().matrix(), {}},
                              {"t", (3.0 * times).array().sin().matrix(), {}}});
  std::string error;
  ASSERT_TRUE(writer.Close(&error)) << error;
  for (const double rate : {0.0, 100.0}) {
    LogFile log;
    DraftQuestion question;
    LogOptions options;
    options.sampling_rate_hz = rate;
    ASSERT_TRUE(ReadLogFile(path, options, &log, &question, &error)) << error;
    EXPECT_THAT(log.ColumnNames(), ElementsAre("acc.L", "acc.T", "acc.t"));
    EXPECT_EQ(log.time_column, rate > 0.0 ? "" : "time");
    EXPECT_EQ(Join(log.unused_times, ","), rate > 0.0 ? "time" : "");
  }
}

TEST(LogFileTest, AsksForTheTimeOfArrays) {
  LogFile log;
  DraftQuestion question;
  std::string error;
  EXPECT_FALSE(
      ReadLogFile(LogSample("arrays/y.npy"), {}, &log, &question, &error));
  EXPECT_EQ(error, "");
  EXPECT_EQ(question.flag, "time");
}

// The reader takes steps of up to 0.3 for seconds, so they need no question.
TEST(LogFileTest, AsksForTheUnitOfLargeStepsAlone) {
  const TemporaryFolder folder;
  for (const double step : {0.25, 0.5}) {
    std::string text = "t;acc_1 [g]\n";
    for (int i = 0; i < 100; ++i) {
      text +=
          FormatNumber(step * i) + ";" + FormatNumber(std::sin(0.7 * i)) + "\n";
    }
    LogFile log;
    DraftQuestion question;
    std::string error;
    EXPECT_EQ(
        ReadLogFile(folder.Write("log.csv", text), {}, &log, &question, &error),
        step == 0.25)
        << error;
    EXPECT_EQ(question.flag, step == 0.25 ? "" : "time_unit");
  }
}

// Two loggers side by side: a floor's record must not get the other's times.
TEST(LogFileTest, TwoClocksAreNotOne) {
  const TemporaryFolder folder;
  std::string text = "t1;base [g];t2;acc_1 [g]\n";
  for (int i = 0; i < 100; ++i) {
    const double t = 0.01 * i;
    text += FormatNumber(t) + ";" + FormatNumber(std::sin(9.0 * t)) + ";" +
            FormatNumber(5.37 + t) + ";" + FormatNumber(std::cos(9.0 * t)) +
            "\n";
  }
  const std::string path = folder.Write("two.csv", text);
  LogFile log;
  DraftQuestion question;
  std::string error;
  EXPECT_FALSE(ReadLogFile(path, {}, &log, &question, &error));
  EXPECT_THAT(error, HasSubstr("the times of 't1' and 't2' differ"));
  EXPECT_THAT(error, HasSubstr("--ignore=t2"));
  LogOptions options;
  options.ignored = {"t2", "acc_1"};
  ASSERT_TRUE(ReadLogFile(path, options, &log, &question, &error)) << error;
  EXPECT_THAT(log.ColumnNames(), ElementsAre("base"));
  // The other clock, named or not.
  options.ignored = {"t1", "base"};
  for (const char* time : {"", "t2"}) {
    options.time = time;
    ASSERT_TRUE(ReadLogFile(path, options, &log, &question, &error)) << error;
    EXPECT_EQ(log.time_column, "t2");
    EXPECT_THAT(log.ColumnNames(), ElementsAre("acc_1"));
  }
}

}  // namespace
}  // namespace pinode
