#include "pinode/case/sections/record_data.h"

#include <cmath>
#include <sstream>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/statistics.h"
#include "pinode/record/filter.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

TEST(RecordDataTest, OffsetWindowAndFilter) {
  TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord(400));
  std::string text =
      Replaced(SmallCase(), "start = \"rest\"",
               "window = [1.0, 3.0]\n[record.filter]\ntype = \"lowpass\"\n"
               "corner_hz = 10.0\norder = 3");
  text =
      Replaced(text, "unit = \"mm\"",
               "unit = \"mm\"\n  remove_offset = true\n  sigma_percent = 4.0");
  const Case c = ReadOrFail(folder.Write("case.toml", text));
  ASSERT_EQ(c.problem.records.size(), 1u);
  const IdentificationRecord& record = c.problem.records[0];
  ASSERT_EQ(record.num_samples(), 201);

  // The same by hand: the mean is that of the whole file.
  Vector whole(400);
  for (int i = 0; i < 400; ++i) {
    whole[i] = 0.001 * (4.0 * std::sin(0.08 * i) + 1.0);
  }
  Vector expected = whole.segment(100, 201).array() - whole.mean();
  FilterOptions options;
  options.type = FilterType::kLowPass;
  options.corner_frequencies = {10.0};
  options.order = 3;
  ZeroPhaseFilter(options, 0.01).Apply(&expected);
  EXPECT_LT((record.channels[1].values - expected).norm(),
            1e-8 * expected.norm());
  EXPECT_NEAR(record.channels[1].sigma,
              0.04 * StandardDeviationOfPresent(expected), 1e-10);
  // The excitation is not filtered.
  EXPECT_NEAR(record.excitation->samples()(0, 0), 0.8 * std::sin(9.0), 1e-8);
  EXPECT_NE(record.filter, nullptr);
}

TEST(RecordDataTest, ShakerAndGroundOfDifferentRecords) {
  TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  folder.Write("shaker.csv", Replaced(SmallRecord(), "ag", "F"));
  std::string record = SmallCase().substr(SmallCase().find("[[record]]"));
  record = Replaced(record, "name = \"quake\"", "name = \"shaker\"");
  record = Replaced(record, "quake.csv", "shaker.csv");
  record = Replaced(record, "[[record.ground]]\n  direction = \"x\"",
                    "[[record.force]]\n  dof = \"u2\"");
  record =
      Replaced(record, "\"ag\"\n  unit = \"gal\"", "\"F\"\n  unit = \"N\"");
  const Case c = ReadOrFail(folder.Write("case.toml", SmallCase() + record));
  ASSERT_EQ(c.problem.records.size(), 2u);
  const Matrix& first = c.problem.records[0].excitation->samples();
  const Matrix& second = c.problem.records[1].excitation->samples();
  ASSERT_EQ(first.rows(), 2);
  EXPECT_TRUE(first.row(1).isZero(0.0));
  EXPECT_TRUE(second.row(0).isZero(0.0));
  EXPECT_NEAR(second(1, 20), 0.08 * std::sin(1.8), 1e-9);  // kN
  EXPECT_THAT(c.problem.records[1].description.remarks,
              Contains(HasSubstr("ground_x is not in this record")));
}

// A ground motion from an AT2 file of another rate, on the record's samples.
TEST(RecordDataTest, At2OfAnotherRate) {
  TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  std::string motion = "Motion\nNPTS= 801, DT= .0025 SEC\n";
  for (int i = 0; i < 801; ++i) {
    motion += FormatNumber(0.2 * std::sin(12.0 * 0.0025 * i), 12) + "\n";
  }
  folder.Write("ground.AT2", motion);
  const std::string text =
      Replaced(SmallCase(), "  column = \"ag\"\n  unit = \"gal\"\n",
               "  file = \"ground.AT2\"\n  unit = \"g\"\n  scale = 2.0\n");
  const Case c = ReadOrFail(folder.Write("case.toml", text));
  ASSERT_EQ(c.problem.records.size(), 1u);
  const Matrix& inputs = c.problem.records[0].excitation->samples();
  ASSERT_EQ(inputs.cols(), 200);
  for (const int i : {40, 100, 150}) {
    EXPECT_NEAR(inputs(0, i), 0.4 * 9.80665 * std::sin(0.12 * i), 2e-4);
  }
  EXPECT_THAT(c.problem.records[0].description.remarks,
              Contains(HasSubstr("resampled from a step of 0.0025")));
}

// A load whose logger has dropped samples: as it is without new samples, and
// interpolated with them.
TEST(RecordDataTest, DroppedSamplesOfALoad) {
  TemporaryFolder folder;
  std::istringstream lines(SmallRecord());
  std::string dropped, line;
  for (int i = 0; std::getline(lines, line); ++i) {
    const size_t first = line.find(',');
    const size_t second = line.find(',', first + 1);
    if (i > 4 && i < 190 && i % 20 == 0)
      line.erase(first + 1, second - first - 1);
    dropped += line + "\n";
  }
  folder.Write("quake.csv", dropped);
  Case c;
  std::string error;
  EXPECT_FALSE(ReadCase(folder.Write("case.toml", SmallCase()), &c, &error));
  EXPECT_THAT(error, HasSubstr("the excitation 'ground x' misses 1 sample"));
  const std::string resampled = Replaced(SmallCase(), "start = \"rest\"",
                                         "start = \"rest\"\nresample_hz = 100");
  c = ReadOrFail(folder.Write("case.toml", resampled));
  EXPECT_THAT(c.problem.records[0].description.remarks,
              Contains(HasSubstr("ground x: 9 missing samples, at most 1 in a "
                                 "row, are interpolated")));
  folder.Write("quake.csv", SmallRecord());
  const Case whole = ReadOrFail(folder.Write("case.toml", resampled));
  const Matrix expected = whole.problem.records[0].excitation->samples();
  EXPECT_LT((c.problem.records[0].excitation->samples() - expected).norm(),
            0.01 * expected.norm());
}

TEST(RecordDataTest, ExcitationThatEndsBeforeTheRecord) {
  TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  folder.Write("short.csv", SmallRecord(100));
  std::string text = Replaced(SmallCase(), "  column = \"ag\"\n",
                              "  column = \"ag\"\n  file = \"short.csv\"\n");
  Case c;
  std::string error;
  EXPECT_FALSE(ReadCase(folder.Write("case.toml", text), &c, &error));
  EXPECT_THAT(error, HasSubstr("record 'quake'"));
  EXPECT_THAT(error, HasSubstr("ground x"));
  text = Replaced(text, "start = \"rest\"", "window = [0.0, 0.9]");
  EXPECT_TRUE(ReadCase(folder.Write("case.toml", text), &c, &error)) << error;
}

TEST(RecordDataTest, GapsInAResponseAreKept) {
  TemporaryFolder folder;
  std::string data = SmallRecord();
  data = Replaced(data, "t,ag,a1,d2\n0,0,", "t,ag,a1,d2\n0,0,nan#");
  const size_t hash = data.find('#');
  data.erase(hash, data.find(',', hash) - hash);
  folder.Write("quake.csv", data);
  const Case c = ReadOrFail(folder.Write("case.toml", SmallCase()));
  ASSERT_EQ(c.problem.records.size(), 1u);
  const Vector& values = c.problem.records[0].channels[0].values;
  EXPECT_TRUE(std::isnan(values[0]));
  EXPECT_EQ(CountPresent(values), 199);
  EXPECT_THAT(c.problem.records[0].description.remarks,
              Contains(HasSubstr("1 of 200 samples are missing")));
}

// Its noise would be taken for none at all, and its weight for infinite.
TEST(RecordDataTest, ADeadSensorIsRefused) {
  TemporaryFolder folder;
  std::string record = "t,ag,a1,d2\n";
  for (int i = 0; i < 200; ++i) {
    record += FormatNumber(0.01 * i, 6) + "," +
              FormatNumber(80.0 * std::sin(0.09 * i), 9) + ",0.25," +
              FormatNumber(std::sin(0.08 * i), 9) + "\n";
  }
  folder.Write("quake.csv", record);
  const auto read = [&](const std::string& more) {
    Case c;
    std::string error;
    const std::string path = folder.Write(
        "case.toml",
        Replaced(SmallCase(), "unit = \"g\"", "unit = \"g\"" + more));
    return ReadCase(path, &c, &error) ? std::string() : error;
  };
  EXPECT_THAT(read(""), AllOf(HasSubstr("a1"), HasSubstr("dead sensor")));
  EXPECT_EQ(read("\n  fit = false"), "");
  EXPECT_EQ(read("\n  sigma = 0.01"), "");
}

// As they came: before the mean, the window and the filter.
TEST(RecordDataTest, BadSamplesAreNamed) {
  TemporaryFolder folder;
  std::string csv = SmallRecord(400);
  for (const char* time : {"\n2,", "\n2.01,"}) {
    const size_t line = csv.find(time);
    ASSERT_NE(line, std::string::npos);
    const size_t end = csv.find('\n', line + 1);
    const size_t last = csv.rfind(',', end);
    csv.replace(last + 1, end - last - 1, "-9999");
  }
  folder.Write("quake.csv", csv);
  const std::string text = Replaced(SmallCase(), "unit = \"mm\"",
                                    "unit = \"mm\"\n  remove_offset = true");
  const auto remark =
      Contains(AllOf(HasSubstr("Record 'quake', channel "),
                     HasSubstr("2 samples are -9999 mm, the first at 2 s")));
  EXPECT_THAT(
      ReadOrFail(folder.Write("case.toml", text)).problem.description.remarks,
      remark);
  const std::string window =
      Replaced(text, "start = \"rest\"", "window = [2.5, 3.5]");
  EXPECT_THAT(
      ReadOrFail(folder.Write("case.toml", window)).problem.description.remarks,
      ::testing::Not(remark));
}

TEST(RecordDataTest, AGapInTheGroundHasOneAdvice) {
  TemporaryFolder folder;
  std::string csv = SmallRecord();
  const size_t line = csv.find("\n1,");
  ASSERT_NE(line, std::string::npos);
  csv.replace(line + 3, csv.find(',', line + 3) - line - 3, "NaN");
  folder.Write("quake.csv", csv);
  Case c;
  std::string error;
  EXPECT_FALSE(ReadCase(folder.Write("case.toml", SmallCase()), &c, &error));
  EXPECT_THAT(error, HasSubstr("misses 1 sample from 1 to 1; expected every "
                               "sample, or a window"));
  EXPECT_EQ(error.find("expected"), error.rfind("expected"));
}

}  // namespace
}  // namespace pinode
