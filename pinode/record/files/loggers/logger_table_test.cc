// The files are those of tests/generators/logger_files.py and tdms_files.py,
// which do not know the readers: y(c, k) = (c + 1) sin(0.5 k + c) at 100 Hz.

#include "pinode/record/files/loggers/logger_table.h"

#include <cmath>
#include <fstream>
#include <string>
#include <tuple>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/file.h"
#include "pinode/record/files/array_table.h"
#include "pinode/record/files/loggers/mini_seed.h"
#include "pinode/record/files/loggers/mini_seed_3.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kStart = 1709294400.25;  // 2024-03-01 12:00:00.25 UTC

double Y(int c, int k) { return (c + 1) * std::sin(0.5 * k + c); }

std::string LoggerSample(const std::string& name) {
  return std::string(PINODE_SOURCE_DIR) + "/tests/fuzz/corpus/" + name;
}

Table ReadSample(const std::string& name,
                 const std::vector<std::string>& wanted = {}) {
  Table table;
  std::string error;
  EXPECT_TRUE(ReadTable(LoggerSample(name), wanted, {}, &table, &error))
      << error;
  EXPECT_FALSE(IsTextFile(LoggerSample(name)));
  return table;
}

std::string LoggerErrorOf(const std::string& name,
                          const std::vector<std::string>& wanted = {}) {
  Table table;
  std::string error;
  EXPECT_FALSE(ReadTable(LoggerSample(name), wanted, {}, &table, &error));
  EXPECT_THAT(error, HasSubstr(name));
  return error;
}

// Expects that column c is y(series[c], k), and "t" the time of 100 Hz.
void ExpectSeries(const Table& table, const std::vector<int>& series,
                  double factor, double tolerance, int rows = 40) {
  ASSERT_EQ(table.columns.size(), series.size() + 1);
  ASSERT_EQ(table.num_rows(), rows);
  EXPECT_EQ(table.columns[0], "t");
  EXPECT_EQ(table.time_unit, "s");
  for (int k = 0; k < rows; ++k) {
    EXPECT_NEAR(table.values(k, 0) - table.values(0, 0), 0.01 * k, 1e-12);
    for (size_t c = 0; c < series.size(); ++c) {
      EXPECT_NEAR(table.values(k, static_cast<Eigen::Index>(c) + 1),
                  factor * Y(series[c], k), tolerance)
          << table.columns[c + 1] << " " << k;
    }
  }
}

void ExpectStart(const Table& table, double seconds) {
  EXPECT_EQ(table.time_origin.kind, TimeOrigin::Kind::kDate);
  EXPECT_NEAR(table.time_origin.seconds + table.values(0, 0), seconds, 1e-6);
}

TEST(LoggerTableTest, KnetScalesCountsToGal) {
  const Table table = ReadSample("knet/knet.EW");
  EXPECT_THAT(table.columns, ElementsAre("t", "EW"));
  EXPECT_THAT(table.units, ElementsAre("s", "gal"));
  // 1000 counts of offset; y to half a count.
  const double count = 3920.0 / 6182761.0;
  for (int k = 0; k < 40; ++k) {
    EXPECT_NEAR(table.values(k, 1) - 1000.0 * count, Y(0, k), 0.51 * count);
  }
  // 21:00:15 in Japan, less the recorder's delay.
  ExpectStart(table, 1709294400.0);
  EXPECT_EQ(table.reading,
            "K-NET, 100 Hz from 2024-03-01 12:00:00; station ISK003.");
}

TEST(LoggerTableTest, KikNetNamesTheDirection) {
  const Table table = ReadSample("knet/kiknet.UD2");
  EXPECT_THAT(table.columns, ElementsAre("t", "UD2"));
  const double count = 2940.0 / 8388608.0;
  for (int k = 0; k < 40; ++k) {
    EXPECT_NEAR(table.values(k, 1) - 1000.0 * count, Y(1, k), 0.51 * count);
  }
}

TEST(LoggerTableTest, CsmipVolumeTwo) {
  const Table table = ReadSample("strong_motion/csmip.v2");
  EXPECT_THAT(table.columns, ElementsAre("t", "ch1_acc", "ch2_acc"));
  EXPECT_THAT(table.units, ElementsAre("s", "cm/s^2", "cm/s^2"));
  // Numbers of the second channel touch each other.
  ExpectSeries(table, {0, 1}, 100.0, 0.6e-5);
  ExpectStart(table, kStart);
  EXPECT_THAT(table.reading, HasSubstr("CSMIP, 100 Hz from 2024-03-01"));
  const Table derived =
      ReadSample("strong_motion/csmip.v2", {"t", "ch2_vel", "ch2_disp"});
  EXPECT_THAT(derived.units, ElementsAre("s", "cm/s", "cm"));
  for (int k = 0; k < 40; ++k) {
    EXPECT_NEAR(derived.values(k, 1), 10.0 * Y(1, k), 0.6e-5);
    EXPECT_NEAR(derived.values(k, 2), Y(1, k), 0.6e-5);
  }
}

TEST(LoggerTableTest, CsmipVolumeOne) {
  const Table table = ReadSample("strong_motion/csmip.v1");
  EXPECT_THAT(table.columns, ElementsAre("t", "ch1_acc", "ch2_acc"));
  EXPECT_THAT(table.units, ElementsAre("s", "g", "g"));
  ExpectSeries(table, {0, 1}, 1.0, 0.6e-6);
  ExpectStart(table, kStart);
  EXPECT_THAT(LoggerErrorOf("strong_motion/film.raw"),
              HasSubstr("Ask the data centre for Volume 2"));
}

TEST(LoggerTableTest, CosmosOfAnotherCentre) {
  const Table table = ReadSample("strong_motion/cosmos.v1");
  EXPECT_THAT(table.columns, ElementsAre("t", "ch2_acc", "ch3_acc"));
  EXPECT_THAT(table.units, ElementsAre("s", "cm/s^2", "cm/s^2"));
  ExpectSeries(table, {1, 2}, 100.0, 0.6e-5);
}

TEST(LoggerTableTest, CosmosTakesTheIntervalOfTheVolume) {
  const Table table = ReadSample("strong_motion/cosmos.v2c");
  EXPECT_THAT(table.columns, ElementsAre("t", "ch1_acc", "ch3_acc"));
  EXPECT_THAT(table.units, ElementsAre("s", "cm/s^2", "cm/s^2"));
  ExpectSeries(table, {0, 2}, 100.0, 0.6e-5);
  ExpectStart(table, kStart);
  EXPECT_THAT(table.reading, HasSubstr("COSMOS, 100 Hz"));
}

TEST(LoggerTableTest, TdmsSegmentsWithoutMetadata) {
  const Table table = ReadSample("tdms/basic.tdms");
  EXPECT_THAT(table.columns, ElementsAre("t", "a1", "it's a2"));
  EXPECT_THAT(table.units, ElementsAre("s", "m/s^2", "mg"));
  ExpectSeries(table, {0, 1}, 1.0, 1e-6);
  EXPECT_EQ(table.values(7, 1), Y(0, 7));
  ExpectStart(table, kStart);
  const Table by_path =
      ReadSample("tdms/basic.tdms", {"acc/it's a2", "acc/a1"});
  EXPECT_EQ(by_path.values.col(1), table.values.col(1));
}

TEST(LoggerTableTest, TdmsInterleavedAndBigEndian) {
  const Table table = ReadSample("tdms/interleaved.tdms", {"t", "b", "count"});
  ASSERT_EQ(table.num_rows(), 40);
  EXPECT_THAT(table.units, ElementsAre("s", "g", ""));
  for (int k = 0; k < 40; ++k) {
    EXPECT_EQ(table.values(k, 1), Y(2, k));
    EXPECT_EQ(table.values(k, 2), k);
  }
  ExpectStart(table, kStart);
}

TEST(LoggerTableTest, TdmsChannelsComeAndGo) {
  for (const auto& [name, series, rows] :
       {std::tuple{"a", 0, 10}, std::tuple{"b", 1, 40},
        std::tuple{"c", 2, 20}}) {
    const Table table = ReadSample("tdms/lists.tdms", {"t", name});
    ExpectSeries(table, {series}, 1.0, 1e-14, rows);
  }
  // All of them: the common part, and it is said.
  const Table table = ReadSample("tdms/lists.tdms");
  EXPECT_EQ(table.num_rows(), 10);
  EXPECT_THAT(table.reading, HasSubstr("the common part is used"));
}

TEST(LoggerTableTest, TdmsScales) {
  const Table table = ReadSample("tdms/scaled.tdms", {"a"});
  for (int k = 0; k < 40; ++k) {
    const double volts = 0.5 * std::round(1000.0 * Y(0, k)) + 3.0;
    EXPECT_NEAR(table.values(k, 0), 1.0 + 0.02 * volts + 1e-6 * volts * volts,
                1e-12);
  }
  EXPECT_THAT(LoggerErrorOf("tdms/scaled.tdms", {"b"}),
              HasSubstr("its scale 'RTD' is not linear, polynomial"));
}

TEST(LoggerTableTest, TdmsColumnsWithoutAClock) {
  const Table table = ReadSample("tdms/columns.tdms");
  EXPECT_THAT(table.columns, ElementsAre("Time", "a"));
  for (int k = 0; k < 40; ++k) {
    EXPECT_NEAR(table.values(k, 0), 0.01 * k, 1e-9);
    EXPECT_EQ(table.values(k, 1), Y(0, k));
  }
  EXPECT_THAT(LoggerErrorOf("tdms/columns.tdms", {"t", "a"}),
              HasSubstr("Give `sampling_rate_hz`"));
  EXPECT_THAT(LoggerErrorOf("tdms/columns.tdms", {"note"}),
              HasSubstr("it holds text"));
}

TEST(LoggerTableTest, TdmsThatWasNotFinished) {
  const Table b = ReadSample("tdms/unfinished.tdms", {"t", "b"});
  ExpectSeries(b, {1}, 1.0, 1e-14, 34);
  EXPECT_THAT(b.reading, HasSubstr("the last segment is not finished"));
}

TEST(LoggerTableTest, DaqmxCountsBecomeValues) {
  for (const char* name : {"tdms/daqmx.tdms", "tdms/daqmx_big.tdms"}) {
    const Table fast = ReadSample(name, {"t", "a", "b"});
    ASSERT_EQ(fast.num_rows(), 40);
    const Table slow = ReadSample(name, {"t", "c", "counts"});
    ASSERT_EQ(slow.num_rows(), 20);
    ExpectStart(fast, kStart);
    for (int k = 0; k < 40; ++k) {
      EXPECT_NEAR(fast.values(k, 0) - fast.values(0, 0), 0.01 * k, 1e-12);
      EXPECT_EQ(fast.values(k, 1), std::round(1024.0 * Y(0, k)) / 1024.0);
      EXPECT_EQ(fast.values(k, 2), std::round(1048576.0 * Y(1, k)) / 1048576.0);
    }
    for (int k = 0; k < 20; ++k) {
      EXPECT_NEAR(slow.values(k, 0) - slow.values(0, 0), 0.02 * k, 1e-12);
      // Half a count of the range.
      EXPECT_NEAR(slow.values(k, 1), Y(2, 2 * k), 4.001 / 65535.0) << k;
      EXPECT_EQ(slow.values(k, 2), 2 * k - 20);
    }
    EXPECT_EQ(fast.reading.find("counts"), std::string::npos);
    EXPECT_THAT(slow.reading,
                HasSubstr("'g/counts' holds counts without a scale"));
  }
}

TEST(LoggerTableTest, DaqmxSeriesOfOneChannel) {
  const std::string name = "tdms/daqmx_scalers.tdms";
  const Table table = ReadSample(name, {"t", "y", "less"});
  for (int k = 0; k < 40; ++k) {
    const double counts = std::round(4096.0 * Y(0, k));
    const double coarse = std::floor(counts / 256.0) / 16.0;
    EXPECT_EQ(table.values(k, 1), counts / 4096.0);
    EXPECT_EQ(table.values(k, 2), counts / 4096.0 - 2.0 * coarse);
  }
  EXPECT_THAT(LoggerErrorOf(name, {"bare"}),
              HasSubstr("several series of counts and no scale"));
}

TEST(LoggerTableTest, DaqmxDigitalLines) {
  const Table table = ReadSample("tdms/daqmx_digital.tdms");
  EXPECT_THAT(table.columns, ElementsAre("t", "line1", "line3", "line10"));
  // The last two rows are not whole.
  ASSERT_EQ(table.num_rows(), 38);
  for (int k = 0; k < 38; ++k) {
    EXPECT_EQ(table.values(k, 1), k & 1);
    EXPECT_EQ(table.values(k, 2), k >> 1 & 1);
    EXPECT_EQ(table.values(k, 3), k >> 2 & 1);
  }
  EXPECT_THAT(table.reading, HasSubstr("the last segment is not finished"));
}

TEST(LoggerTableTest, SeveralRatesComeToTheLowest) {
  const Table table = ReadSample("tdms/rates.tdms", {"t", "a", "b"});
  // b begins two samples of a later, and ends 0.01 s later.
  ASSERT_EQ(table.num_rows(), 398);
  ExpectStart(table, kStart + 0.02);
  for (int k = 0; k < 398; ++k) {
    const double phase = 2.0 * 3.14159265358979323846 * 3.0 * (0.02 + 0.01 * k);
    EXPECT_NEAR(table.values(k, 1), std::sin(phase), 1e-6);
    // The ends are extended by reflection, as Resample() says.
    if (k < 40 || k > 358) continue;
    EXPECT_NEAR(table.values(k, 2), 2.0 * std::sin(phase), 2e-4) << k;
  }
  EXPECT_THAT(table.reading, HasSubstr("'g/b' resampled from 200 to 100 Hz"));
}

TEST(LoggerTableTest, SlowChannelsAreReadings) {
  const Table table = ReadSample("tdms/rates.tdms", {"t", "b", "T"});
  ASSERT_EQ(table.num_rows(), 800);
  EXPECT_EQ(table.units[2], "");
  for (int k = 0; k < 800; ++k) {
    if (k % 40 == 0) {
      EXPECT_EQ(table.values(k, 2), 20.0 + k / 40);
    } else {
      EXPECT_TRUE(std::isnan(table.values(k, 2)));
    }
  }
  EXPECT_THAT(table.reading, HasSubstr("'g/T' has a reading every 0.2 s"));
}

TEST(LoggerTableTest, ClocksThatDoNotFitAreRefused) {
  const std::string file = "tdms/rates.tdms";
  EXPECT_THAT(LoggerErrorOf(file, {"t", "a", "late"}),
              HasSubstr("lie between those of the others"));
  EXPECT_THAT(LoggerErrorOf(file, {"t", "a", "undated"}),
              HasSubstr("has no start time"));
  EXPECT_THAT(LoggerErrorOf(file, {"t", "a", "stepless"}),
              HasSubstr("has no sampling step"));
  EXPECT_THAT(LoggerErrorOf(file, {"t", "x"}),
              HasSubstr("no channel is called 'x'; known are: t, g/a, g/b"));
}

// Counts of the generator, with steps from small to more than 16 bits.
double Counts(int c, int k) {
  constexpr double kFactors[] = {1.0, 1000.0, 100000.0};
  return std::round(kFactors[k / 14 % 3] * Y(c, k));
}

class MiniSeedTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!CanReadMiniSeed()) {
      GTEST_SKIP() << "this build has no libmseed 2 (libmseed-dev)";
    }
  }
};

TEST_F(MiniSeedTest, SteimOneAndTwo) {
  const Table table = ReadSample("mini_seed/steim.mseed");
  EXPECT_THAT(table.columns, ElementsAre("t", "HNZ", "HNE"));
  ASSERT_EQ(table.num_rows(), 40);
  for (int k = 0; k < 40; ++k) {
    EXPECT_EQ(table.values(k, 1), Counts(0, k));
    EXPECT_EQ(table.values(k, 2), Counts(1, k));
  }
  ExpectStart(table, kStart);
}

TEST_F(MiniSeedTest, NumbersAndNames) {
  const Table table = ReadSample("mini_seed/numbers.mseed",
                                 {"HNN", "XX.STA.00.HNE", "XX.STA.00.HNZ"});
  for (int k = 0; k < 40; ++k) {
    EXPECT_EQ(table.values(k, 0), static_cast<float>(Y(1, k)));
    EXPECT_EQ(table.values(k, 1), Y(2, k));
    EXPECT_EQ(table.values(k, 2), Counts(0, k));
  }
}

TEST_F(MiniSeedTest, GapsAreMissingSamples) {
  const Table table = ReadSample("mini_seed/gap.mseed");
  ASSERT_EQ(table.num_rows(), 40);
  for (int k = 0; k < 40; ++k) {
    if (k >= 10 && k < 15) {
      EXPECT_TRUE(std::isnan(table.values(k, 1)));
    } else {
      EXPECT_EQ(table.values(k, 1), static_cast<float>(Y(0, k)));
    }
  }
  EXPECT_THAT(table.reading, HasSubstr("has gaps of 0.05 s in all"));
  EXPECT_THAT(LoggerErrorOf("mini_seed/overlap.mseed"), HasSubstr("overlap"));
}

TEST(MiniSeed3Test, SteimOneAndTwo) {
  const Table table = ReadSample("mini_seed/three.mseed");
  EXPECT_THAT(table.columns, ElementsAre("t", "HNZ", "HNE"));
  ASSERT_EQ(table.num_rows(), 40);
  for (int k = 0; k < 40; ++k) {
    EXPECT_EQ(table.values(k, 1), Counts(0, k));
    EXPECT_EQ(table.values(k, 2), Counts(1, k));
  }
  ExpectStart(table, kStart);
}

TEST(MiniSeed3Test, NumbersNamesAndGaps) {
  const std::string name = "mini_seed/three_numbers.mseed";
  const Table table = ReadSample(
      name, {"XX.STA..HN1", "HN2", "mast/top", "XX.STA.00.HNZ", "t"});
  ASSERT_EQ(table.num_rows(), 40);
  for (int k = 0; k < 40; ++k) {
    EXPECT_EQ(table.values(k, 0), std::round(1000.0 * Y(0, k)));
    EXPECT_EQ(table.values(k, 1), Counts(1, k));
    EXPECT_EQ(table.values(k, 2), static_cast<float>(Y(1, k)));
    if (k >= 10 && k < 15) {
      EXPECT_TRUE(std::isnan(table.values(k, 3)));
    } else {
      EXPECT_EQ(table.values(k, 3), Y(2, k));
    }
    EXPECT_NEAR(table.values(k, 4) - table.values(0, 4), 0.01 * k, 1e-12);
  }
  EXPECT_THAT(table.reading, HasSubstr("has gaps of 0.05 s in all"));
  EXPECT_THAT(LoggerErrorOf(name, {"LOG"}), HasSubstr("no sampling rate"));
}

TEST(MiniSeed3Test, BrokenRecords) {
  std::string bytes;
  std::string error;
  ASSERT_TRUE(
      ReadBinaryFile(LoggerSample("mini_seed/three.mseed"), &bytes, &error));
  const auto error_of = [](const std::string& changed) {
    LoggedFile file;
    std::string message;
    EXPECT_FALSE(ParseLoggedFile(
        changed, "x.mseed", LoggerFormat::kMiniSeed, "",
        [](const LoggerChannel&) { return true; }, &file, &message));
    return message;
  };
  // Every byte counts: a changed one is found by the checksum.
  for (size_t at = 4; at < bytes.size(); at += 37) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    EXPECT_THAT(error_of(changed), HasSubstr("x.mseed: record at byte "));
  }
  EXPECT_THAT(error_of(bytes.substr(0, bytes.size() - 5)),
              HasSubstr("the file ends inside it"));
  EXPECT_THAT(error_of(bytes + "000001D "),
              HasSubstr("expected records of miniSEED 3 only"));
}

TEST(MiniSeed3Test, SteimThatIsBroken) {
  std::vector<double> values;
  EXPECT_THAT(UnpackSteim(std::string(63, '\0'), 2, 1, &values),
              HasSubstr("too short for its 1 samples"));
  EXPECT_THAT(UnpackSteim(std::string(64, '\0'), 2, 1, &values),
              HasSubstr("too short for its 1 samples"));
  // First word behind the two constants: nibble 3, and 3 in its own bits.
  std::string frame(64, '\0');
  frame[0] = 0x03;
  frame[12] = static_cast<char>(0xC0);
  EXPECT_THAT(UnpackSteim(frame, 2, 1, &values), HasSubstr("broken"));
  // As Steim 1 the same word is one difference; the last sample is stated as 1.
  frame[11] = 1;
  EXPECT_THAT(UnpackSteim(frame, 1, 1, &values), HasSubstr("last sample"));
}

TEST(LoggerTableTest, Sac) {
  for (const char* name : {"little.sac", "big.sac", "double.sac"}) {
    const Table table = ReadSample(std::string("sac/") + name);
    EXPECT_THAT(table.columns, ElementsAre("t", "HNZ"));
    ExpectSeries(table, {0}, 1.0, 1e-7);
    ExpectStart(table, kStart);
  }
  EXPECT_THAT(LoggerErrorOf("sac/short.sac"), HasSubstr("ends after 40 of 41"));
  EXPECT_THAT(LoggerErrorOf("sac/uneven.sac"),
              HasSubstr("not an evenly spaced"));
}

TEST(LoggerTableTest, LvmInEveryForm) {
  for (const char* name :
       {"one.lvm", "multi.lvm", "no.lvm", "decimal_comma.lvm", "comma.lvm"}) {
    const Table table = ReadSample(std::string("lvm/") + name);
    EXPECT_THAT(table.columns, ElementsAre("t", "a1", "a2")) << name;
    EXPECT_THAT(table.units, ElementsAre("s", "m/s^2", "mg"));
    ExpectSeries(table, {0, 1}, 1.0, 0.6e-6);
    ExpectStart(table, kStart);
  }
  const Table table = ReadSample("lvm/one.lvm", {"X_Value", "a2"});
  EXPECT_NEAR(table.values(39, 0) - table.values(0, 0), 0.39, 1e-12);
}

TEST(LoggerTableTest, LvmOfACardThatSamplesInTurns) {
  const Table table = ReadSample("lvm/skew.lvm");
  EXPECT_THAT(table.columns, ElementsAre("t", "a1", "a2"));
  ExpectSeries(table, {0, 1}, 1.0, 0.6e-6);
  ExpectStart(table, kStart);
  EXPECT_THAT(table.reading,
              HasSubstr("start times of the channels differ by up to 1.4e-05 s,"
                        " that of the first one is used"));
}

TEST(LoggerTableTest, LvmSegments) {
  const Table table = ReadSample("lvm/segments.lvm");
  ASSERT_EQ(table.num_rows(), 40);
  for (int k = 0; k < 40; ++k) {
    if (k >= 20 && k < 25) {
      EXPECT_TRUE(std::isnan(table.values(k, 2)));
    } else {
      EXPECT_NEAR(table.values(k, 2), Y(1, k), 0.6e-6);
    }
  }
  EXPECT_THAT(LoggerErrorOf("lvm/jump.lvm"), HasSubstr("Split the file there"));
}

TEST(LoggerTableTest, LvmWithoutAStepSaysHowToReadIt) {
  std::string text;
  std::string error;
  ASSERT_TRUE(ReadBinaryFile(LoggerSample("lvm/one.lvm"), &text, &error));
  const size_t step = text.find("Delta_X");
  ASSERT_NE(step, std::string::npos);
  text[step] = 'd';
  LoggedFile file;
  EXPECT_FALSE(ParseLoggedFile(
      text, "x.lvm", LoggerFormat::kLvm, "",
      [](const LoggerChannel&) { return true; }, &file, &error));
  EXPECT_THAT(error, HasSubstr("Set `header_lines`"));
}

TEST(LoggerTableTest, LvmThatTheCaseLaysOutIsText) {
  TextFormat format;
  format.header_lines = 23;
  Table table;
  std::string error;
  EXPECT_FALSE(
      ReadTable(LoggerSample("lvm/one.lvm"), {"t"}, format, &table, &error));
  EXPECT_THAT(error, HasSubstr("no column"));
}

TEST(LoggerTableTest, HeaderLinesOrADelimiterMakeLvmText) {
  const std::string path = LoggerSample("lvm/one.lvm");
  TextFormat format;
  format.encoding = "UTF-8";
  EXPECT_FALSE(IsTextFile(path, format));
  format.delimiter = '\t';
  EXPECT_TRUE(IsTextFile(path, format));
  EXPECT_FALSE(IsTextFile(LoggerSample("tdms/basic.tdms"), format));
}

TEST(LoggerTableTest, LvmIsReadInTheEncodingThatIsGiven) {
  std::string text;
  std::string error;
  ASSERT_TRUE(ReadBinaryFile(LoggerSample("lvm/one.lvm"), &text, &error));
  // The second channel is in metres of KOI8-R, or newtons of Windows-1251.
  text.replace(text.find("\tmg\t"), 4, "\t\xCD\t");
  TemporaryFolder folder;
  const std::string path = folder.Write("a.lvm", text);
  Table table;
  TextFormat format;
  for (const char* encoding : {"KOI8-R", "WINDOWS-1251"}) {
    format.encoding = encoding;
    ASSERT_TRUE(ReadTable(path, {"a2"}, format, &table, &error)) << error;
    EXPECT_THAT(table.units,
                ElementsAre(encoding == std::string("KOI8-R") ? "m" : "N"));
    EXPECT_THAT(table.reading, HasSubstr("text in " + std::string(encoding)));
    EXPECT_EQ(UnitOfLoggerChannel(path, LoggerFormat::kLvm, encoding, "a2"),
              table.units[0]);
  }
  format.encoding = "no such";
  EXPECT_FALSE(ReadTable(path, {"a2"}, format, &table, &error));
  EXPECT_THAT(error, HasSubstr("'no such' is not known"));
}

// Every file that is cut short is refused, or says that it is not finished.
TEST(LoggerTableTest, FilesThatAreCutShort) {
  TemporaryFolder folder;
  for (const char* name :
       {"knet/knet.EW", "strong_motion/csmip.v2", "strong_motion/csmip.v1",
        "strong_motion/cosmos.v2c", "tdms/basic.tdms", "tdms/daqmx.tdms",
        "mini_seed/steim.mseed", "sac/big.sac", "lvm/one.lvm"}) {
    if (name[0] == 'm' && !CanReadMiniSeed()) continue;
    std::string bytes;
    std::string error;
    ASSERT_TRUE(ReadBinaryFile(LoggerSample(name), &bytes, &error)) << error;
    const std::string path =
        folder.Path(std::string(name).substr(std::string(name).find('/') + 1));
    // Not within the last lines of a text, where only words follow.
    const size_t cut = bytes.size() - 100;
    std::ofstream(path, std::ios::binary) << bytes.substr(0, cut);
    Table table;
    EXPECT_FALSE(ReadTable(path, {}, {}, &table, &error)) << name;
    EXPECT_EQ(error.rfind(path + ":", 0), 0U) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

TEST(LoggerTableTest, UnitsOfChannels) {
  const std::string tdms = LoggerSample("tdms/basic.tdms");
  EXPECT_EQ(UnitOfLoggerChannel(tdms, LoggerFormat::kTdms, "", "a1"), "m/s^2");
  EXPECT_EQ(UnitOfLoggerChannel(tdms, LoggerFormat::kTdms, "", "acc/it's a2"),
            "mg");
  EXPECT_EQ(UnitOfLoggerChannel(tdms, LoggerFormat::kTdms, "", "x"), "");
}

TEST(LoggerTableTest, Dates) {
  EXPECT_EQ(SecondsOfDate(1970, 1, 1), 0);
  EXPECT_EQ(SecondsOfDate(2024, 2, 29), 1709164800);
  EXPECT_EQ(SecondsOfDate(2024, 1, 60), 1709164800);
  EXPECT_EQ(SecondsOfDate(1900, 3, 1), -2203891200);
  EXPECT_EQ(SecondsOfDate(2000, 3, 1), 951868800);
}

}  // namespace
}  // namespace pinode
