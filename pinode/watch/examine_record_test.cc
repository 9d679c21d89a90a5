#include "pinode/watch/examine_record.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

Vector Noise(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Vector values(count);
  for (double& value : values) value = normal(random);
  return values;
}

TEST(FaultOfSamples, NamesEachFault) {
  const Vector healthy = Noise(2000, 1);
  EXPECT_EQ(FaultOfSamples(healthy), "");
  EXPECT_NE(FaultOfSamples(Vector::Constant(2000, 0.3)).find("is dead"),
            std::string::npos);
  EXPECT_NE(FaultOfSamples(Vector::Constant(2000, kNaN)).find("no samples"),
            std::string::npos);
  Vector hanging = healthy;
  hanging.tail(1500).setConstant(0.1);
  EXPECT_NE(FaultOfSamples(hanging).find("repeats itself"), std::string::npos);
  EXPECT_NE(FaultOfSamples((3.0 * healthy).cwiseMin(1.0).cwiseMax(-1.0))
                .find("is clipped"),
            std::string::npos);
  Vector spiked = healthy;
  spiked[700] = 100.0;
  spiked[900] = -90.0;
  EXPECT_EQ(FaultOfSamples(spiked), "has 2 spikes.");
}

class ExamineRecordTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name =
        (std::filesystem::temp_directory_path() / "watchXXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    structure_.records.columns = {"a1", "a2", "a3"};
    WatchedCovariate temperature;
    temperature.name = "temperature";
    temperature.column = "T";
    structure_.covariates = {temperature};
    structure_.modes.max_order = 12;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // Two oscillators of 2 and 5 Hz at 25 Hz in three channels; a3 is dead.
  std::string Write(const std::string& name, bool with_clock) {
    const int count = 4000;
    const double step = 0.04;
    Matrix motions = Matrix::Zero(2, count);
    for (int m = 0; m < 2; ++m) {
      const double omega = 2.0 * M_PI * (m == 0 ? 2.0 : 5.0);
      const double decay = std::exp(-0.01 * omega * step);
      const double a1 = 2.0 * decay * std::cos(omega * step);
      const Vector force = Noise(count, 7 + static_cast<unsigned>(m));
      for (int k = 2; k < count; ++k) {
        motions(m, k) = a1 * motions(m, k - 1) -
                        decay * decay * motions(m, k - 2) + force[k];
      }
    }
    std::string text = std::string(with_clock ? "time" : "t") + ",a1,a2,a3,T\n";
    for (int k = 0; k < count; ++k) {
      char line[160];
      const double t = step * k;
      if (with_clock) {
        const int seconds = static_cast<int>(t + 1e-9);
        std::snprintf(line, sizeof(line), "2024-03-01 12:%02d:%06.3f",
                      seconds / 60, t - 60.0 * (seconds / 60));
      } else {
        std::snprintf(line, sizeof(line), "%.3f", t);
      }
      text += line;
      std::snprintf(line, sizeof(line), ",%.6g,%.6g,0.5,%.6g\n",
                    motions(0, k) + 0.7 * motions(1, k),
                    motions(0, k) - 1.2 * motions(1, k), k < 2000 ? 4.0 : 6.0);
      text += line;
    }
    std::ofstream(folder_ + "/" + name) << text;
    return folder_ + "/" + name;
  }

  StoredRecord Examine(const std::string& path) {
    std::string content, error;
    EXPECT_TRUE(ReadBinaryFile(path, &content, &error)) << error;
    return ExamineRecord(structure_, path, content);
  }

  std::string folder_;
  WatchedStructure structure_;
};

TEST_F(ExamineRecordTest, FindsTimeModesFaultsAndCovariates) {
  const StoredRecord record = Examine(Write("x.csv", true));
  EXPECT_EQ(record.refusal, "");
  EXPECT_EQ(record.name, "x.csv");
  EXPECT_EQ(record.time, 19783.0 * 86400.0 + 43200.0);
  EXPECT_NEAR(record.duration, 160.0, 0.1);
  ASSERT_EQ(record.channels.size(), 3u);
  EXPECT_EQ(record.channels[0].fault, "");
  EXPECT_NE(record.channels[2].fault.find("is dead"), std::string::npos);
  ASSERT_EQ(record.modes.size(), 2u);
  EXPECT_NEAR(record.modes[0].frequency_hz, 2.0, 0.05);
  EXPECT_NEAR(record.modes[1].frequency_hz, 5.0, 0.05);
  EXPECT_EQ(record.modes[0].shape.size(), 2);
  EXPECT_GT(record.modes[0].frequency_sigma, 0.0);
  EXPECT_NEAR(record.Covariate("temperature"), 5.0, 1e-9);
}

TEST_F(ExamineRecordTest, TakesTheTimeFromTheName) {
  const std::string path = Write("g_20240301_1200.csv", false);
  EXPECT_NE(Examine(path).refusal.find("set `time_in_name`"),
            std::string::npos);
  structure_.records.time_in_name = "g_%Y%m%d_%H%M";
  const StoredRecord record = Examine(path);
  EXPECT_EQ(record.refusal, "");
  EXPECT_EQ(record.time, 19783.0 * 86400.0 + 43200.0);
  structure_.records.time_in_name = "h_%Y";
  EXPECT_NE(Examine(path).refusal.find("rename the file"), std::string::npos);
}

TEST_F(ExamineRecordTest, OrderOfTheDateByTheFormat) {
  const std::string path = Write("x.csv", true);
  std::string content, error;
  ASSERT_TRUE(ReadBinaryFile(path, &content, &error)) << error;
  ReplaceAll("2024-03-01", "01.03.24", &content);
  std::ofstream(path) << content;
  EXPECT_NE(Examine(path).refusal.find("set `time_format` in [records]"),
            std::string::npos);
  structure_.records.time_format = "%d.%m.%y %H:%M:%S";
  const StoredRecord record = Examine(path);
  EXPECT_EQ(record.refusal, "");
  EXPECT_EQ(record.time, 19783.0 * 86400.0 + 43200.0);
}

TEST_F(ExamineRecordTest, SaysWhichChannelIsAbsent) {
  structure_.records.columns = {"a1", "a2", "a9"};
  const StoredRecord record = Examine(Write("x.csv", true));
  EXPECT_EQ(record.refusal, "");
  ASSERT_EQ(record.channels.size(), 3u);
  EXPECT_EQ(record.channels[2].fault, "is not in the file.");
  structure_.records.columns = {"a3"};
  EXPECT_NE(Examine(Write("x.csv", true)).refusal.find("no channel"),
            std::string::npos);
}

TEST_F(ExamineRecordTest, RefusesWhatIsNoRecord) {
  std::ofstream(folder_ + "/x.csv") << "hello\n";
  const StoredRecord record = Examine(folder_ + "/x.csv");
  EXPECT_FALSE(record.refusal.empty());
  // The folder does not matter.
  EXPECT_EQ(record.refusal.find(folder_), std::string::npos) << record.refusal;
  EXPECT_EQ(record.content, ContentIdentity("hello\n"));
}

TEST_F(ExamineRecordTest, InterpolatesCovariatesOfAFile) {
  const std::string path = folder_ + "/weather.csv";
  std::ofstream(path) << "time,wind\n2024-03-01 12:00:00,1\n"
                         "2024-03-01 13:00:00,3\n2024-03-02 13:00:00,9\n";
  WatchedCovariate wind;
  wind.name = "wind";
  wind.column = "wind";
  wind.file = path;
  wind.time_column = "time";
  structure_.covariates = {wind};
  std::vector<StoredRecord> records(3);
  const double noon = 19783.0 * 86400.0 + 43200.0;
  records[0].time = noon + 600.0;  // its middle is at 12:15
  records[0].duration = 600.0;
  records[1].time = noon + 7200.0;  // in the gap of a day
  records[2].time = noon - 7200.0;  // before the file
  std::string error;
  ASSERT_TRUE(FillCovariates(structure_, &records, &error)) << error;
  EXPECT_NEAR(records[0].Covariate("wind"), 1.5, 1e-9);
  EXPECT_TRUE(std::isnan(records[1].Covariate("wind")));
  EXPECT_TRUE(std::isnan(records[2].Covariate("wind")));
  structure_.covariates[0].column = "wnd";
  EXPECT_FALSE(FillCovariates(structure_, &records, &error));
  EXPECT_NE(error.find("weather.csv"), std::string::npos) << error;
}

}  // namespace
}  // namespace pinode
