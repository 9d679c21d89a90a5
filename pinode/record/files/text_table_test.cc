#include "pinode/record/files/text_table.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/measured_data_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// A format whose time is in this column.
TextFormat WithTime(const std::string& column) {
  TextFormat format;
  format.time_column = column;
  return format;
}

Table ParseText(const std::string& text, const TextFormat& format = {}) {
  Table table;
  std::string error;
  EXPECT_TRUE(ParseTextTable(text, "r.csv", {}, format, &table, &error))
      << error;
  return table;
}

std::string ErrorOf(const std::string& text, const TextFormat& format = {}) {
  Table table;
  std::string error;
  EXPECT_FALSE(ParseTextTable(text, "r.csv", {}, format, &table, &error))
      << table.reading;
  EXPECT_THAT(error, StartsWith("r.csv"));
  return error;
}

TEST(TextTableTest, PlainFilesAreReadWithoutAssumptions) {
  const Table table = ParseText("t,a\n0,1.5\n0.1,2\n", WithTime("t"));
  EXPECT_EQ(table.reading, "");
  EXPECT_EQ(table.time_unit, "s");
  EXPECT_THAT(table.columns, ElementsAre("t", "a"));
}

// A first time that is missing is not a clock of any kind.
TEST(TextTableTest, FirstTimeMissing) {
  const Table table = ParseText("t,a\nnan,1\n0.1,2\n0.2,3\n", WithTime("t"));
  EXPECT_EQ(table.time_origin.kind, TimeOrigin::Kind::kNone);
  EXPECT_THAT(table.reading, Not(HasSubstr("0 s is")));
  EXPECT_EQ(table.time_unit, "s");
  EXPECT_DOUBLE_EQ(table.values(2, 0), 0.2);
}

TEST(TextTableTest, LinesBetweenNamesAndRows) {
  const Table table = ParseText(
      "Zeit;a;b\ns;g;mg\nfloat;float;float\n0,5;1,5;2,5\n1,5;2,5;3,5\n",
      WithTime("Zeit"));
  EXPECT_THAT(table.columns, ElementsAre("Zeit", "a", "b"));
  EXPECT_THAT(table.units, ElementsAre("s", "g", "mg"));
  // LabVIEW.
  EXPECT_THAT(ParseText("***End_of_Header***\t\t\nX_Value\tVoltage\tComment\n"
                        "0.5\t1.5\n1.5\t2.5\n")
                  .columns,
              ElementsAre("X_Value", "Voltage"));
}

TEST(TextTableTest, NamesMayBeNumbers) {
  EXPECT_THAT(ParseText("t,1\n0,5\n1,6\n").columns, ElementsAre("t", "1"));
  EXPECT_THAT(ParseText("Logger;X;Y\n\nt;1;2\n0;5;6\n1;6;7\n").columns,
              ElementsAre("t", "1", "2"));
}

TEST(TextTableTest, NamesOnSeveralLinesAreCsv) {
  const Table table =
      ParseText("t,a,\"b,\nc\"\n0,1,2\n1,3,nan\n", WithTime("t"));
  EXPECT_THAT(table.columns, ElementsAre("t", "a", "b,\nc"));
  EXPECT_EQ(table.values(1, 1), 3.0);
}

TEST(TextTableTest, GermanLogger) {
  const Table table = ParseText(
      "Logger;X1;\nHalle;W\xE4gung;\nRate [Hz];200;\n\n"
      "Zeit;CH1 [mg];Dach\n"
      "01.03.2024 12:00:00,000;0,00;-1,5\n"
      "01.03.2024 12:00:00,005;-0,35;2\n",
      WithTime("Zeit"));
  EXPECT_THAT(table.columns, ElementsAre("Zeit", "CH1 [mg]", "Dach"));
  EXPECT_THAT(table.units, ElementsAre("", "mg", ""));
  EXPECT_NEAR(table.values(1, 0), 0.005, 1e-9);
  EXPECT_EQ(table.values(1, 1), -0.35);
  EXPECT_EQ(table.values(0, 2), -1.5);
  EXPECT_THAT(table.line_numbers, ElementsAre(6, 7));
  EXPECT_EQ(table.time_origin.kind, TimeOrigin::Kind::kDate);
  EXPECT_THAT(table.reading, HasSubstr("WINDOWS-1252 (a guess)"));
  EXPECT_THAT(table.reading, HasSubstr("decimal comma, names in line 5"));
  EXPECT_THAT(table.reading, HasSubstr("0 s is 2024-03-01 12:00:00"));
}

TEST(TextTableTest, RussianLogger) {
  // Windows-1251: "Время [с];Ускорение [м/с^2]".
  const std::string text =
      "\xC2\xF0\xE5\xEC\xFF [\xF1];"
      "\xD3\xF1\xEA\xEE\xF0\xE5\xED\xE8\xE5 [\xEC/\xF1^2]\n"
      "0,000;0,5\n0,005;-1,5\n0,010;2,5\n";
  TextFormat format;
  format.encoding = "WINDOWS-1251";
  const Table table = ParseText(text, format);
  EXPECT_THAT(table.columns, ElementsAre("Время [с]", "Ускорение [м/с^2]"));
  EXPECT_THAT(table.units, ElementsAre("s", "m/s^2"));
  EXPECT_EQ(table.values(1, 1), -1.5);
  EXPECT_THAT(table.reading, HasSubstr("text in WINDOWS-1251,"));
  TextOutline outline;
  std::string error;
  ASSERT_TRUE(ParseTextOutline(text, "f.csv", format, &outline, &error));
  EXPECT_EQ(outline.time_column, 0);
  // A name that is not found may be garbled by the guess.
  Table none;
  EXPECT_FALSE(ParseTextTable(text, "f.csv", {"\xC3\xBC"}, {}, &none, &error));
  EXPECT_THAT(error, HasSubstr("set `encoding` if names look wrong"));
}

// "Час" is the time in Ukrainian and the hour in Russian.
TEST(TextTableTest, HoursAreNoTimes) {
  TextOutline outline;
  std::string error;
  ASSERT_TRUE(ParseTextOutline("Час;X\n0;3\n0.01;4\n0.02;5\n", "f.csv", {},
                               &outline, &error));
  EXPECT_EQ(outline.time_column, 0);
  ASSERT_TRUE(
      ParseTextOutline("X;Час;Мин;Сек\n3;9;1;2.5\n5;9;1;2.6\n4;9;1;2.7\n",
                       "f.csv", {}, &outline, &error));
  EXPECT_EQ(outline.time_column, -1);
  EXPECT_FALSE(outline.is_channel[1]);
}

TEST(TextTableTest, ColumnsAreFoundWithoutTheirUnits) {
  Table table;
  std::string error;
  const std::string text = "t;acc [mg];acc;acc\n0;1;2;3\n1;4;5;6\n";
  ASSERT_TRUE(
      ParseTextTable(text, "r.csv", {"acc[2]", "t"}, {}, &table, &error))
      << error;
  EXPECT_EQ(table.values(1, 0), 6.0);
  ASSERT_TRUE(ParseTextTable("t;b [mg]\n0;1\n1;4\n", "r.csv", {"b"}, {}, &table,
                             &error))
      << error;
  EXPECT_EQ(table.values(1, 0), 4.0);
  EXPECT_THAT(table.units, ElementsAre("mg"));
  EXPECT_FALSE(ParseTextTable("t;a;a\n0;1;2\n1;4;5\n", "r.csv", {"a"}, {},
                              &table, &error));
  EXPECT_THAT(error, HasSubstr("expected 'a[1]' or 'a[2]'"));
}

TEST(TextTableTest, KeysOverrideWhatIsFound) {
  TextFormat format;
  format.decimal = ',';
  EXPECT_EQ(ParseText("1,234\n2,345\n3,456\n", format).values(0, 0), 1.234);
  format = TextFormat();
  format.delimiter = ',';
  EXPECT_EQ(ParseText("1,234\n2,345\n3,456\n", format).values(0, 1), 234.0);
  format = TextFormat();
  format.header_lines = 2;
  const Table table = ParseText("7;8;9\nx;1\n1;2\n3;4\n", format);
  EXPECT_EQ(table.values(0, 0), 1.0);
  EXPECT_EQ(table.num_rows(), 2);
  format = TextFormat();
  format.encoding = "SHIFT_JIS";
  EXPECT_EQ(ParseText("\x8E\x9E\x8A\xD4,a\n0,1\n1,2\n", format).columns[0],
            "\xE6\x99\x82\xE9\x96\x93");
  format.encoding = "no such";
  EXPECT_THAT(ErrorOf("t,a\n0,1\n", format), HasSubstr("is not known"));
  format = WithTime("t");
  format.time_format = "%d/%m/%Y %H:%M:%S";
  EXPECT_NEAR(
      ParseText("t,a\n01/02/2024 23:59:59.5,1\n02/02/2024 00:00:00.5,2\n",
                format)
          .values(1, 0),
      1.0, 1e-9);
}

TEST(TextTableTest, TextWithSeveralMeaningsIsRefused) {
  // One column with decimal commas, or two columns.
  EXPECT_THAT(ErrorOf("1,234\n2,345\n3,456\n"), HasSubstr("`decimal`"));
  // Two numbers with decimal commas, or four.
  EXPECT_THAT(ErrorOf("0,005,1,25\n0,010,1,50\n0,015,1,75\n"),
              HasSubstr("`delimiter` and `decimal`"));
  EXPECT_THAT(ErrorOf("1,5,2,5\n2,5,-3,5\n3,5,4,5\n"),
              HasSubstr("`delimiter` and `decimal`"));
  EXPECT_EQ(ParseText("1,5,2,5\n2,-5,-3,5\n3,5,4,5\n").values.cols(), 4);
  // Thousands, or decimals.
  // A start time and a rate above the samples, once for each column.
  EXPECT_THAT(ErrorOf("1599215000.0,1599215000.0\n32.0,32.0\n-7,62\n-8,61\n"),
              HasSubstr("rate of 32 Hz. Set `header_lines = 2`"));
  EXPECT_EQ(
      ParseText("1599215000.0,5\n1599215001.0,6\n1599215002.0,7\n").num_rows(),
      3);
  EXPECT_THAT(ErrorOf("a;b\n1,234;5\n2,345;6\n"), HasSubstr("thousands"));
  EXPECT_EQ(ParseText("a;b\n1,234;5\n0,345;6\n").values(0, 0), 1.234);
  // 1 February or 2 January, and the times differ.
  EXPECT_THAT(ErrorOf("t;a\n01/02/2024 12:00:00;1\n03/02/2024 12:00:00;2\n"
                      "05/02/2024 12:00:00;3\n",
                      WithTime("t")),
              HasSubstr("`time_format`"));
  // The same day: the order makes no difference.
  const Table table = ParseText(
      "t;a\n01/02/2024 12:00:00;1\n01/02/2024 12:00:01;2\n", WithTime("t"));
  EXPECT_EQ(table.values(1, 0), 1.0);
  EXPECT_EQ(table.time_origin.kind, TimeOrigin::Kind::kDoubtfulDate);
  // Hours and minutes, or minutes and seconds.
  EXPECT_THAT(ErrorOf("t;a\n12:30;1\n12:31;2\n", WithTime("t")),
              HasSubstr("`"));
  // Days of a spreadsheet, or seconds.
  EXPECT_THAT(ErrorOf("t;a\n45352.5;1\n45352.50001;2\n", WithTime("t")),
              HasSubstr("`time_unit`"));
  // A clock that is coarser than the rows.
  EXPECT_THAT(ErrorOf("t;a\n12:30:00;1\n12:30:00;2\n12:30:00;3\n12:30:01;4\n",
                      WithTime("t")),
              HasSubstr("`sampling_rate_hz`"));
  // Names, or a row.
  EXPECT_THAT(ErrorOf("0,1,2\n0.5,1.5,2.5\n1.5,3.5,4.5\n"),
              HasSubstr("`header_lines = 0` or `1`"));
  // Missing values, or nothing.
  EXPECT_THAT(ErrorOf("a\n1.5\n\n2.5\n"), HasSubstr("missing value"));
}

TEST(TextTableTest, FaultsNameTheLine) {
  const std::string head = "x\nt;a\n0,0;1,5\n0,1;2,5\n";
  EXPECT_THAT(ErrorOf(head + "0,2;OVER\n"),
              HasSubstr(":5: column 'a': 'OVER' is not a number"));
  // In the first rows as well.
  std::string rows = "t,a,b\n0,1,2\n1,OVER,3\n";
  for (int i = 2; i < 40; ++i) rows += std::to_string(i) + ",1,2\n";
  EXPECT_THAT(ErrorOf(rows), HasSubstr(":3: column 'a': 'OVER' is not"));
  EXPECT_THAT(ErrorOf("x\n" + rows),
              HasSubstr(":4: column 'a': 'OVER' is not"));
  EXPECT_THAT(ErrorOf(head + "0,2\n"), HasSubstr(":5: 1 cell, expected 2"));
  EXPECT_THAT(ErrorOf(head + "0,2;\"1\n"), HasSubstr(":5: stray quote"));
  EXPECT_THAT(ErrorOf(head + "0,2;inf\n"), HasSubstr("not finite; write nan"));
  EXPECT_THAT(ErrorOf("t,a\n0,inf\n1,2\n"), HasSubstr("not finite; write nan"));
  for (const char* start : {"t,a\n0,", "x\nt;a\n0;"}) {
    EXPECT_THAT(ErrorOf(std::string(start) + "-9.9E+37\n"),
                HasSubstr("means an overflow; write nan"));
  }
  // Footers, and delimiters at the ends of rows alone.
  EXPECT_THAT(ErrorOf(head + "End\n"), HasSubstr("delete the line"));
  EXPECT_THAT(ErrorOf("t,a\n0,1.5\n1,2\nEnd\n"), HasSubstr("delete the line"));
  EXPECT_THAT(ErrorOf("t;a\n0;1.5;\n1;2.5;\n"),
              HasSubstr("End the header line with one"));
  EXPECT_THAT(ErrorOf("a;b\n0;5\n0;6\n1.5;7\n1,5;8\n"), HasSubstr(":5: "));
  EXPECT_THAT(ErrorOf(std::string("t,a\n0,\0"
                                  "1\n",
                                  9)),
              HasSubstr("is a binary file"));
  EXPECT_THAT(ErrorOf(""), HasSubstr("is empty"));
  EXPECT_THAT(ErrorOf("no numbers\nat all\n"), HasSubstr("`delimiter`"));
  EXPECT_THAT(ErrorOf("t;a\n0,0;1,5;3,0\n0,1;2,5;4,0\n"),
              HasSubstr("`header_lines = 1`"));
}

TEST(TextTableTest, DecimalCommasMayComeLate) {
  std::string text = "a\tb\n";
  for (int i = 0; i < 50; ++i) text += std::to_string(i) + "\t0\n";
  EXPECT_EQ(ParseText(text + "50\t0,25\n").values(50, 1), 0.25);
  EXPECT_EQ(ParseText(text + "50\t0.25\n").values(50, 1), 0.25);
}

TEST(TextTableTest, CountersGoOn) {
  std::string text = "ms,a\n";
  for (int i = 0; i < 600; ++i) {
    text += std::to_string(5 * i % 1024) + "," + std::to_string(i % 7) + "\n";
  }
  const Table table = ParseText(text, WithTime("ms"));
  EXPECT_EQ(table.time_unit, "ms");
  for (int i = 0; i < 600; ++i) EXPECT_EQ(table.values(i, 0), 5.0 * i);
  EXPECT_THAT(table.reading, HasSubstr("starts anew at 1024 ms"));
  // Two parts of a record are no counter.
  const Table parts =
      ParseText("t [s],a\n0,1\n5,2\n10,3\n3,4\n8,5\n13,6\n", WithTime("t [s]"));
  EXPECT_EQ(parts.values(3, 0), 3.0);
}

TEST(TextTableTest, NoErrorIsLeftOfADecimalCommaThatComesLate) {
  Table table;
  std::string error;
  ASSERT_TRUE(ParseTextTable("t [s];a\n1;99749\n2;0,25\n", "log.csv", {},
                             WithTime("t [s]"), &table, &error));
  EXPECT_EQ(error, "");
  EXPECT_EQ(table.values(1, 1), 0.25);
}

TEST(TextTableTest, UnitsOfTheTime) {
  for (const char* name : {"Time [ms]", "time_ms", "t (msec)", "t in ms"}) {
    const Table table =
        ParseText(std::string(name) + ",a\n0,1\n5,2\n", WithTime(name));
    EXPECT_EQ(table.time_unit, "ms") << name;
  }
  TextFormat format = WithTime("Time [ms]");
  format.time_unit = "s";
  const Table table = ParseText("Time [ms],a\n0,1\n5,2\n", format);
  EXPECT_EQ(table.time_unit, "s");
  EXPECT_THAT(table.reading, HasSubstr("although the file says ms"));
  EXPECT_THAT(ErrorOf("t [mm],a\n0,1\n5,2\n", WithTime("t [mm]")),
              HasSubstr("`time_unit`"));
}

// A temperature beside accelerations: its unit is not in the table.
TEST(TextTableTest, RowOfUnitsWithOthers) {
  for (const char* unit : {"\u00B0C", "C", "K", "%RH"}) {
    const std::string text = std::string("Zeit;base;floor 1;Temp\ns;mg;mg;") +
                             unit + "\n0,5;1,5;2;20\n1,5;4;5,5;20\n2;1;2;21\n";
    const Table table = ParseText(text, WithTime("Zeit"));
    EXPECT_EQ(table.FindColumn("floor 1"), 2) << unit;
    EXPECT_THAT(table.units, ElementsAre("s", "mg", "mg", "")) << unit;
  }
  // Names, with nothing above them.
  const Table table = ParseText("g;C;K\n1;2;3\n2;3;4\n");
  EXPECT_EQ(table.FindColumn("C"), 1);
}

// A file that gen.py of the measured data has written.
struct Logger {
  std::string file;
  std::string time;
  std::vector<std::string> channels;
  double scale = 1.0;  // of both channels
  std::string unit;    // of both channels
};

std::vector<std::vector<double>> NumbersOf(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::vector<std::vector<double>> rows;
  while (std::getline(file, line)) {
    std::vector<double> row;
    std::stringstream cells(line);
    std::string cell;
    while (std::getline(cells, cell, ',')) row.push_back(std::stod(cell));
    rows.push_back(row);
  }
  return rows;
}

TEST(TextTableTest, LoggersOfTheMeasuredData) {
  PINODE_FIND_MEASURED_DATA(folder, "faults/loggers");
  // The same numbers in all files; this one has nothing else.
  const auto truth = NumbersOf(folder + "/nohead.csv");
  ASSERT_EQ(truth.size(), 4000u);
  const std::vector<Logger> loggers = {
      {"catman.csv", "Zeit", {"Kanal 1", "Kanal 2"}, 1.0, ""},
      {"digilent.csv",
       "Time (s)",
       {"Channel 1 (V)", "Channel 2 (V)"},
       1.0,
       "V"},
      {"graphtec.csv", "Time", {"mV1", "mV2"}, 100.0, ""},
      {"iso.csv", "timestamp", {"a1", "a2"}, 1.0, ""},
      {"mts.txt", "Time", {"Acc1", "Acc2"}, 1.0, "m/s^2"},
      {"nohead.csv", "column_1", {"column_2", "column_3"}, 1.0, ""},
      {"space.txt", "Time", {"a1", "a2"}, 1.0, ""},
      {"th.csv", "timestamp", {"a1", "a2"}, 1.0, ""},
      {"trail.csv", "t", {"a[1]", "a[2]"}, 1.0, ""},
      {"units_row.csv", "Time", {"Acc 1", "Acc 2"}, 1.0, "m/s^2"},
      {"wrap.csv", "ms", {"a1", "a2"}, 1.0, ""}};
  for (const Logger& logger : loggers) {
    const std::string path = folder + "/" + logger.file;
    TextOutline outline;
    std::string error;
    ASSERT_TRUE(ReadTextOutline(path, {}, &outline, &error)) << error;
    ASSERT_GE(outline.time_column, 0) << logger.file;
    EXPECT_EQ(outline.columns[static_cast<size_t>(outline.time_column)].name,
              logger.time);
    std::vector<std::string> channels;
    for (size_t i = 0; i < outline.columns.size(); ++i) {
      if (outline.is_channel[i]) channels.push_back(outline.columns[i].name);
    }
    EXPECT_EQ(channels, logger.channels) << logger.file;
    Table table;
    ASSERT_TRUE(ReadTextTable(path, {logger.time, channels[0], channels[1]},
                              WithTime(logger.time), &table, &error))
        << error;
    ASSERT_EQ(table.num_rows(), 4000) << logger.file;
    EXPECT_THAT(table.units[1], logger.unit) << logger.file;
    const double second = table.time_unit == "ms" ? 1e-3 : 1.0;
    double worst = 0.0;
    double worst_time = 0.0;
    for (Eigen::Index i = 0; i < 4000; ++i) {
      const std::vector<double>& row = truth[static_cast<size_t>(i)];
      worst_time =
          std::max(worst_time, std::abs(second * table.values(i, 0) - row[0]));
      for (int c = 1; c <= 2; ++c) {
        worst = std::max(worst, std::abs(table.values(i, c) / logger.scale -
                                         row[static_cast<size_t>(c)]));
      }
    }
    // Digits that the files have: 5 decimals of 100 times the value; 7 digits.
    EXPECT_LT(worst, 1.1e-7) << logger.file;
    EXPECT_LT(worst_time, 1e-9) << logger.file;
  }
}

// A name and a row of units that contradict each other: neither is believed.
TEST(TextTableTest, ContradictingUnitsAreNone) {
  const Table table =
      ParseText("t [s];a [mg];b [g]\n[s];[V];[g]\n0,0;1,5;2,5\n0,1;2,5;3,5\n",
                WithTime("t [s]"));
  EXPECT_THAT(table.units, ElementsAre("s", "", "g"));
  EXPECT_THAT(table.reading, HasSubstr("no unit for 'a [mg]'"));
}

// The delimiter for spreadsheets in the first line is no name.
TEST(TextTableTest, FirstLineForSpreadsheets) {
  for (const char delimiter : {';', ',', '\t'}) {
    std::string text = "sep=;\nt;a\n0;1.5\n0.1;2.5\n0.2;3.5\n";
    std::replace(text.begin(), text.end(), ';', delimiter);
    const Table table = ParseText(text, WithTime("t"));
    EXPECT_THAT(table.columns, ElementsAre("t", "a"));
    ASSERT_EQ(table.num_rows(), 3);
    EXPECT_EQ(table.values(2, 1), 3.5);
  }
}

// Rows with numbers that cannot be read are no names for the rows below them.
TEST(TextTableTest, RowsOfUnreadableNumbersAreNoNames) {
  for (const char* cell :
       {"8'13,621", "--0,621", "8\u202F13,621", "8\u200913,621"}) {
    std::string text = "Sensor\n";
    for (int i = 0; i < 20; ++i) text += std::string(cell) + "\n";
    EXPECT_THAT(ErrorOf(text), HasSubstr("no rows of numbers were found"));
    EXPECT_THAT(ErrorOf("t;a\n0,1;" + std::string(cell) + "\n0,2;" + cell +
                        "\n0,3;" + cell + "\n"),
                HasSubstr("no rows of numbers were found"));
  }
  EXPECT_THAT(ErrorOf("a;b\n1'20.5;2'30.5\n1'30.5;2'40.5\n900.5;800.5\n"
                      "901.5;802.5\n902.5;803.5\n"),
              HasSubstr("'1'20.5' is not a number"));
}

// A step of 10 in a column "Time" may be 10 ms as well.
TEST(TextTableTest, LargeStepsNeedAUnit) {
  const std::string rows = ",a\n0,1\n10,2\n20,3\n30,1\n";
  for (const char* name : {"Time", "t", "Zeit"}) {
    EXPECT_THAT(
        ErrorOf(name + rows, WithTime(name)),
        HasSubstr("Set `time_unit` to \"s\" or \"ms\", or name the "
                  "column '" +
                  std::string(name) + " [ms]', or give `sampling_rate_hz`"));
  }
  // Half a second, or a millisecond of a logger of 2000 Hz.
  EXPECT_THAT(ErrorOf("t,a\n0,1\n0.5,2\n1,3\n", WithTime("t")),
              HasSubstr("Set `time_unit`"));
  EXPECT_EQ(ParseText("t,a\n0,1\n0.25,2\n0.5,3\n", WithTime("t")).time_unit,
            "s");
  TextFormat format = WithTime("t");
  format.time_unit = "s";
  EXPECT_EQ(ParseText("t" + rows, format).values(3, 0), 30.0);
  EXPECT_EQ(ParseText("t [s]" + rows, WithTime("t [s]")).time_unit, "s");
}

// Counts of microseconds may be as large, but not with such steps.
TEST(TextTableTest, SecondsSince1970NeedNoUnit) {
  const Table table = ParseText(
      "t,a\n1709290800,1\n1709290801,2\n1709290802,3\n", WithTime("t"));
  EXPECT_EQ(table.time_unit, "s");
  EXPECT_EQ(table.values(2, 0) - table.values(0, 0), 2.0);
  EXPECT_THAT(table.reading, HasSubstr("'t' read as seconds since 1970"));
  EXPECT_THAT(
      ErrorOf("t,a\n1709290000,1\n1709295000,2\n1709300000,3\n", WithTime("t")),
      HasSubstr("states no unit, and its step of 5000"));
}

TEST(TextTableTest, MissingValuesOfOldPrograms) {
  const Table table =
      ParseText("t;a\n0;1.5\n0.1;1.#QNAN\n0.2;-1.#IND\n0.3;n.a.\n0.4;2\n");
  ASSERT_EQ(table.num_rows(), 5);
  for (const int i : {1, 2, 3}) EXPECT_TRUE(std::isnan(table.values(i, 1)));
  EXPECT_EQ(table.values(4, 1), 2.0);
}

TEST(TextTableTest, GermanLoggerOfTheMeasuredData) {
  PINODE_FIND_MEASURED_DATA(folder, "faults");
  Table table;
  std::string error;
  ASSERT_TRUE(ReadTextTable(folder + "/loggers/german_logger.csv", {},
                            WithTime("Zeit"), &table, &error))
      << error;
  // The record that was made from it by other means, in the same numbers.
  Table record;
  const std::vector<std::string> channels(table.columns.begin() + 1,
                                          table.columns.end());
  ASSERT_TRUE(ReadCsvTable(folder + "/verdict/five_storeys/R_0301.csv",
                           channels, &record, &error))
      << error;
  ASSERT_EQ(table.num_rows(), 8000);
  EXPECT_EQ(table.values.rightCols(6), record.values);
  EXPECT_THAT(table.units, ElementsAre("", "mg", "mg", "mg", "mg", "", ""));
  for (Eigen::Index i = 0; i < 8000; ++i) {
    ASSERT_NEAR(table.values(i, 0), 0.005 * static_cast<double>(i), 1e-9);
  }
}

}  // namespace
}  // namespace pinode
