// Records in the files of data loggers: keys, units and clocks.

#include <cmath>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/case/sections/modes_data_file.h"
#include "pinode/case/sections/modes_section.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// Returns SmallRecord as a German logger writes it, beginning at `clock` of a
// day: `12:00:` and seconds, from `first` on.
std::string GermanRecord(int first = 0, int samples = 200) {
  std::string text =
      "Logger X;;;\nHalle;W\xE4gung;;\nZeit;ag [gal];a1 [g];d2 (mm)\n";
  for (int i = first; i < first + samples; ++i) {
    const double t = 0.01 * i;
    const int hundredths = i % 100;
    std::string row = "01.03.2024 12:00:";
    row += (i / 100 < 10 ? "0" : "") + std::to_string(i / 100) + ".";
    row += (hundredths < 10 ? "0" : "") + std::to_string(hundredths);
    for (const double value :
         {80.0 * std::sin(9.0 * t), 0.1 * std::sin(8.0 * t),
          4.0 * std::sin(8.0 * t) + 1.0}) {
      std::string cell = FormatNumber(value, 9);
      if (cell.find('.') != std::string::npos) cell[cell.find('.')] = ',';
      row += ";" + cell;
    }
    text += row + "\n";
  }
  return text;
}

std::string GermanCase() {
  std::string text = Replaced(SmallCase(), "time = \"t\"", "time = \"Zeit\"");
  // The file states the units.
  text = Replaced(text, "  unit = \"gal\"\n", "");
  text = Replaced(text, "  unit = \"g\"\n", "");
  return Replaced(text, "  unit = \"mm\"\n", "");
}

// Expects the motion of GermanRecord in SI units.
void ExpectTheMotion(const IdentificationRecord& record) {
  ASSERT_EQ(record.num_samples(), 200);
  EXPECT_NEAR(record.sampling_step(), 0.01, 1e-12);
  for (int i = 0; i < 200; i += 7) {
    const double t = 0.01 * i;
    EXPECT_NEAR(record.excitation->samples()(0, i), 0.8 * std::sin(9.0 * t),
                1e-8);
    EXPECT_NEAR(record.channels[0].values[i], 0.980665 * std::sin(8.0 * t),
                1e-8);
    EXPECT_NEAR(record.channels[1].values[i],
                0.001 * (4.0 * std::sin(8.0 * t) + 1.0), 1e-10);
  }
}

TEST(LoggerFilesTest, GermanRecordIsReadAsThePlainOne) {
  TemporaryFolder folder;
  folder.Write("quake.csv", GermanRecord());
  const Case c = ReadOrFail(folder.Write("case.toml", GermanCase()));
  const IdentificationRecord& record = c.problem.records[0];
  ExpectTheMotion(record);
  EXPECT_THAT(record.description.remarks,
              Contains(AllOf(HasSubstr("File quake.csv: "),
                             HasSubstr("decimal comma, names in line 3"),
                             HasSubstr("0 s is 2024-03-01 12:00:00"))));
}

// SmallRecord as LabVIEW writes it.
std::string LabviewRecord() {
  std::string text =
      "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t.\n"
      "X_Columns\tOne\nDate\t2024/03/01\nTime\t12:00:00.0\n"
      "***End_of_Header***\t\n\t\nChannels\t3\nSamples\t200\t200\t200\n"
      "Y_Unit_Label\tgal\tg\tmm\nX0\t0\t0\t0\n"
      "Delta_X\t0.01\t0.01\t0.01\n***End_of_Header***\t\n"
      "X_Value\tag\ta1\td2\tComment\n";
  for (int i = 0; i < 200; ++i) {
    const double t = 0.01 * i;
    text += FormatNumber(t, 6) + "\t" +
            FormatNumber(80.0 * std::sin(9.0 * t), 9) + "\t" +
            FormatNumber(0.1 * std::sin(8.0 * t), 9) + "\t" +
            FormatNumber(4.0 * std::sin(8.0 * t) + 1.0, 9) + "\n";
  }
  return text;
}

TEST(LoggerFilesTest, FileThatStatesItsUnitsAndClock) {
  TemporaryFolder folder;
  folder.Write("quake.lvm", LabviewRecord());
  const std::string text =
      Replaced(Replaced(GermanCase(), "time = \"Zeit\"", "time = \"t\""),
               "quake.csv", "quake.lvm");
  const Case c = ReadOrFail(folder.Write("case.toml", text));
  const IdentificationRecord& record = c.problem.records[0];
  ExpectTheMotion(record);
  EXPECT_THAT(record.description.remarks,
              Contains(HasSubstr(
                  "File quake.lvm: LVM, 100 Hz from 2024-03-01 12:00:00")));
}

TEST(LoggerFilesTest, ContradictingUnitsAreNamed) {
  TemporaryFolder folder;
  folder.Write("quake.csv", GermanRecord());
  const Case c = ReadOrFail(folder.Write(
      "case.toml", Replaced(GermanCase(), "column = \"a1\"\n",
                            "column = \"a1\"\n  unit = \"mg\"\n")));
  const IdentificationRecord& record = c.problem.records[0];
  // The case counts.
  EXPECT_NEAR(record.channels[0].values[10], 0.980665e-3 * std::sin(0.8), 1e-9);
  EXPECT_THAT(record.description.remarks,
              Contains(HasSubstr("channel a1: the file says g, the case says "
                                 "mg")));
}

TEST(LoggerFilesTest, ScaleOfAChannel) {
  TemporaryFolder folder;
  folder.Write("quake.csv", GermanRecord());
  const std::string text = Replaced(
      GermanCase(), "column = \"a1\"\n",
      "column = \"a1\"\n  unit = \"mg\"\n  scale = 1000\n  sigma = 2\n");
  const Case c = ReadOrFail(folder.Write("case.toml", text));
  const IdentificationRecord& record = c.problem.records[0];
  EXPECT_NEAR(record.channels[0].values[10], 0.980665 * std::sin(0.8), 1e-8);
  // Noise of the column, before the scale: 2 mg times 1000.
  EXPECT_NEAR(record.channels[0].sigma, 2.0 * 9.80665, 1e-9);
  EXPECT_NEAR(record.channels[0].description.factor, 9.80665, 1e-9);
  // The two factors agree with the file.
  EXPECT_THAT(record.description.remarks,
              Not(Contains(HasSubstr("the file says"))));
  // So do equal units, whose scale corrects the sensor.
  const Case corrected = ReadOrFail(folder.Write(
      "case.toml", Replaced(text, "unit = \"mg\"\n  scale = 1000\n",
                            "unit = \"g\"\n  scale = 1.02\n")));
  EXPECT_THAT(corrected.problem.records[0].description.remarks,
              Not(Contains(HasSubstr("the file says"))));
  // A factor between units does not correct a sensor.
  const Case twice = ReadOrFail(folder.Write(
      "case.toml", Replaced(text, "unit = \"mg\"\n  scale = 1000\n",
                            "unit = \"g\"\n  scale = 9.81\n")));
  EXPECT_THAT(twice.problem.records[0].description.remarks,
              Contains(HasSubstr("the file says g, the case says g with scale "
                                 "= 9.81. pinode uses the unit and the scale "
                                 "of the case. Set `unit = \"g\"` without "
                                 "`scale` if")));
  // Factors that were rounded agree.
  const Case rounded = ReadOrFail(folder.Write(
      "case.toml", Replaced(text, "unit = \"mg\"\n  scale = 1000\n",
                            "unit = \"mm/s^2\"\n  scale = 9806.651\n")));
  EXPECT_THAT(rounded.problem.records[0].description.remarks,
              Not(Contains(HasSubstr("the file says"))));
  Case bad;
  std::string error;
  EXPECT_FALSE(ReadCase(
      folder.Write("bad.toml", Replaced(text, "scale = 1000", "scale = 0")),
      &bad, &error));
  EXPECT_THAT(error, HasSubstr("'scale' is 0"));
}

TEST(LoggerFilesTest, FilesAreAlignedByTheirClocks) {
  TemporaryFolder folder;
  folder.Write("quake.csv", GermanRecord());
  // Begins half a second later.
  folder.Write("late.csv", GermanRecord(50, 200));
  std::string text = Replaced(GermanCase(), "column = \"d2\"",
                              "column = \"d2\"\n  file = \"late.csv\"");
  const Case c = ReadOrFail(folder.Write("case.toml", text));
  const Vector& late = c.problem.records[0].channels[1].values;
  EXPECT_TRUE(std::isnan(late[49]));
  for (int i = 50; i < 200; i += 7) {
    EXPECT_NEAR(late[i], 0.001 * (4.0 * std::sin(0.08 * i) + 1.0), 1e-10);
  }
  // Without a clock there is nothing to align by.
  folder.Write("late.csv", Replaced(SmallRecord(), "t,", "Zeit,"));
  Case bad;
  std::string error;
  text = Replaced(text, "file = \"late.csv\"",
                  "file = \"late.csv\"\n  unit = \"mm\"");
  EXPECT_FALSE(ReadCase(folder.Write("case.toml", text), &bad, &error));
  EXPECT_THAT(error, HasSubstr("not clock times of the same kind"));
}

TEST(LoggerFilesTest, KeysOfTheRecord) {
  TemporaryFolder folder;
  // Names that are not in the last line above the rows.
  folder.Write("quake.csv",
               "Zeit;ag;a1;d2\nfloat;float;x\n" +
                   GermanRecord().substr(GermanRecord().find("01.03.2024")));
  std::string text = SmallCase();
  for (const auto& [name, number] :
       {std::pair("ag", "2"), {"a1", "3"}, {"d2", "4"}}) {
    text = Replaced(
        text, std::string("column = \"") + name,
        std::string("name = \"") + name + "\"\n  column = \"column_" + number);
  }
  text = Replaced(text, "  name = \"ag\"\n", "");
  Case c;
  std::string error;
  const std::string without =
      Replaced(text, "time = \"t\"", "time = \"column_1\"");
  EXPECT_FALSE(ReadCase(folder.Write("case.toml", without), &c, &error));
  EXPECT_THAT(error, HasSubstr("`header_lines = 2`"));
  const std::string keys =
      Replaced(without, "time = \"column_1\"",
               "time = \"column_1\"\nheader_lines = 2\ndelimiter = \";\"\n"
               "decimal = \",\"\nencoding = \"ISO-8859-1\"\n"
               "time_format = \"%d.%m.%Y %H:%M:%S\"");
  ASSERT_TRUE(ReadCase(folder.Write("case.toml", keys), &c, &error)) << error;
  EXPECT_NEAR(c.problem.records[0].excitation->samples()(0, 10),
              0.8 * std::sin(0.9), 1e-8);
  for (const auto& [key, value] :
       {std::pair("delimiter = \";\"", "delimiter = \"x\""),
        {"delimiter = \";\"", "delimiter = \",\""},
        {"decimal = \",\"", "decimal = \";\""},
        {"header_lines = 2", "header_lines = -2"}}) {
    EXPECT_FALSE(ReadCase(folder.Write("case.toml", Replaced(keys, key, value)),
                          &c, &error));
    EXPECT_THAT(error, HasSubstr("expected"));
  }
}

TEST(LoggerFilesTest, TheUnitOfTheTimeIsThatOfTheFile) {
  TemporaryFolder folder;
  std::string record = "Time [ms],ag,a1,d2\n";
  for (int i = 0; i < 100; ++i) {
    record += std::to_string(10 * i) + ",0." + std::to_string(i) + ",0.2,0." +
              std::to_string(100 - i) + "\n";
  }
  folder.Write("quake.csv", record);
  const std::string text =
      Replaced(Replaced(SmallCase(), "\"t\"", "\"Time [ms]\""),
               "column = \"a1\"", "fit = false\n  column = \"a1\"");
  const Case c = ReadOrFail(folder.Write("case.toml", text));
  EXPECT_NEAR(c.problem.records[0].sampling_step(), 0.01, 1e-12);
  EXPECT_EQ(c.problem.records[0].description.time_unit, "ms");
  EXPECT_NEAR(c.problem.records[0].description.time_factor, 1e-3, 1e-15);
}

// A key that changes nothing would be believed.
TEST(LoggerFilesTest, KeysThatWouldNotBeUsedAreRefused) {
  TemporaryFolder folder;
  ModesDataFile file;
  file.path = folder.Write("german.csv", GermanRecord());
  file.columns = {"a1"};
  file.sampling_rate_hz = 100.0;
  file.format.time_unit = "ms";
  ModesCase c;
  std::string error;
  EXPECT_FALSE(ReadModesDataFile(file, &c, &error));
  EXPECT_THAT(error, HasSubstr("time_unit and sampling_rate_hz are both"));
  file.format.time_unit.clear();
  file.sampling_rate_hz = 0.0;
  file.path = folder.Write("quake.lvm", LabviewRecord());
  file.format.encoding = "UTF-8";
  EXPECT_TRUE(ReadModesDataFile(file, &c, &error)) << error;
  file.format.decimal = ',';
  EXPECT_FALSE(ReadModesDataFile(file, &c, &error));
  EXPECT_THAT(error, HasSubstr("decimal = ,"));
  EXPECT_THAT(error, HasSubstr("leave it out"));
}

TEST(LoggerFilesTest, LvmThatIsLaidOutIsText) {
  TemporaryFolder folder;
  ModesDataFile file;
  file.path = folder.Write("quake.lvm", LabviewRecord());
  file.columns = {"a1"};
  file.time_column = "X_Value";
  file.format.header_lines = 15;
  file.format.delimiter = '\t';
  ModesCase c;
  std::string error;
  ASSERT_TRUE(ReadModesDataFile(file, &c, &error)) << error;
  ASSERT_EQ(c.records.size(), 1u);
  EXPECT_NEAR(c.records[0].sampling_step, 0.01, 1e-12);
}

TEST(LoggerFilesTest, ModesOfAFileAlone) {
  TemporaryFolder folder;
  ModesDataFile file;
  file.path = folder.Write("german.csv", GermanRecord());
  file.columns = {"all"};
  file.quantities = {"acceleration", "acceleration", "displacement"};
  ModesCase c;
  std::string error;
  ASSERT_TRUE(ReadModesDataFile(file, &c, &error)) << error;
  ASSERT_EQ(c.records.size(), 1u);
  EXPECT_NEAR(c.records[0].sampling_step, 0.01, 1e-12);
  ASSERT_EQ(c.records[0].num_channels(), 3);
  EXPECT_EQ(c.records[0].channels[2].name, "d2 (mm)");
  EXPECT_NEAR(c.records[0].samples(1, 10), 0.980665 * std::sin(0.8), 1e-8);
  // A temperature is no acceleration, and a text no channel.
  ModesDataFile other;
  other.path = folder.Write(
      "other.csv",
      "t,a [g],T (C),state\n0,1,20,ok\n0.1,2,21,OVER\n0.2,1,20,ok\n");
  other.columns = {"all"};
  EXPECT_FALSE(ReadModesDataFile(other, &c, &error));
  EXPECT_THAT(error, HasSubstr("the unit of column 'T (C)' is not known"));
  other.path = folder.Write(
      "other.csv", "t,a [g],b,state\n0,1,20,ok\n0.1,2,21,OVER\n0.2,1,20,ok\n");
  ASSERT_TRUE(ReadModesDataFile(other, &c, &error)) << error;
  EXPECT_THAT(
      c.remarks,
      Contains(HasSubstr("Left out, because they contain text: state")));
  EXPECT_THAT(c.remarks, Contains(HasSubstr("b: read as g")));
  // A displacement is no acceleration.
  file.quantities = {"acceleration"};
  EXPECT_FALSE(ReadModesDataFile(file, &c, &error));
  EXPECT_THAT(error, AllOf(HasSubstr("'d2 (mm)' is in mm"),
                           HasSubstr("set its quantity")));
}

TEST(LoggerFilesTest, DampingRatiosAreNoPerCent) {
  TemporaryFolder folder;
  folder.Write("quake.csv", SmallRecord());
  Case c;
  std::string error;
  EXPECT_FALSE(ReadCase(
      folder.Write("case.toml",
                   Replaced(SmallCase(), "ratios = [0.02]", "ratios = [2]")),
      &c, &error));
  EXPECT_THAT(error, AllOf(HasSubstr("case.toml:9"), HasSubstr("200 %"),
                           HasSubstr("2 % is 0.02")));
}

}  // namespace
}  // namespace pinode
