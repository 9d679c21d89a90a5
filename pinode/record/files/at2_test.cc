#include "pinode/record/files/at2.h"

#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/record/table.h"
#include "tests/support/measured_data_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(At2Test, ReadsEverySpellingOfTheSizeLine) {
  for (const char* size_line :
       {"NPTS=   5, DT=   .0200 SEC,      ", "NPTS =   5, DT = .0200 SEC\r",
        "NPTS=5,DT=.02SEC", "npts= 5  dt= 0.02", "   5   0.0200   NPTS, DT",
        "DT= .0200 SEC, NPTS= 5"}) {
    const std::string text =
        std::string(
            "PEER NGA STRONG MOTION DATABASE RECORD\r\nSOMEWHERE, 000"
            "\r\nACCELERATION TIME SERIES IN UNITS OF G\n") +
        size_line +
        "\n  -.4486975E-03  .1E-02\n\n 3 -4.5\r\n   .5D0\n\n*** End ***\n";
    At2Motion motion;
    std::string error;
    ASSERT_TRUE(ParseAt2(text, "m.at2", &motion, &error))
        << size_line << ": " << error;
    EXPECT_EQ(motion.sampling_step, 0.02);
    Vector expected(5);
    expected << -0.4486975e-3, 1e-3, 3.0, -4.5, 0.5;
    EXPECT_EQ(motion.acceleration, expected);
    EXPECT_THAT(motion.title, HasSubstr("SOMEWHERE, 000 | ACCEL"));
  }
}

struct BadAt2 {
  const char* what;
  const char* text;
  const char* error;
};

class BadAt2Test : public ::testing::TestWithParam<BadAt2> {};

TEST_P(BadAt2Test, IsRefused) {
  At2Motion motion;
  motion.title = "untouched";
  std::string error;
  EXPECT_FALSE(ParseAt2(GetParam().text, "m.at2", &motion, &error));
  EXPECT_THAT(error, StartsWith("m.at2:"));
  EXPECT_THAT(error, HasSubstr(GetParam().error));
  EXPECT_EQ(motion.title, "untouched");
}

INSTANTIATE_TEST_SUITE_P(
    At2, BadAt2Test,
    ::testing::ValuesIn(std::vector<BadAt2>{
        BadAt2{"empty", "", "m.at2: no line such as"},
        BadAt2{"csv", "t,a\n0,1\n1,2\n", "m.at2: no line such as"},
        BadAt2{"too_few", "x\nNPTS= 4, DT= .01 SEC\n1 2\n3\n",
               "m.at2:4: the file ends after 3 points, expected NPTS= 4"},
        BadAt2{"too_many", "x\nNPTS= 2, DT= .01 SEC\n1 2\n3\n",
               "m.at2:4: more points than"},
        BadAt2{"text", "x\nNPTS= 3, DT= .01 SEC\n1 x 3\n",
               "m.at2:3: 'x' is not a number; 1 of 3"},
        BadAt2{"not_finite", "x\nNPTS= 3, DT= .01 SEC\n1 nan 3\n",
               "m.at2:3: 'nan' is not finite"},
        BadAt2{"one_point", "NPTS= 1, DT= .01 SEC\n1\n",
               "m.at2:1: 'NPTS= 1, DT= .01 SEC', expected at least two"},
        BadAt2{"no_step", "NPTS= 3, DT= 0 SEC\n1 2 3\n", "a positive step"},
        BadAt2{"no_numbers", "NPTS= many, DT= .01\n1 2\n", "m.at2:1: 'NPTS="},
        BadAt2{"velocity",
               "x\nVELOCITY TIME SERIES IN UNITS OF CM/S\n"
               "NPTS= 2, DT= .01 SEC\n1 2\n",
               "m.at2:2: values in units of CM/S, expected"}}),
    [](const ::testing::TestParamInfo<BadAt2>& bad) {
      return std::string(bad.param.what);
    });

TEST(At2Test, MissingFile) {
  At2Motion motion;
  std::string error;
  EXPECT_FALSE(ReadAt2("no/such.at2", &motion, &error));
  EXPECT_THAT(error, StartsWith("no/such.at2: cannot open"));
}

// The same motion as a table of t_s, acc_g.
void ExpectSameMotion(const std::string& at2, const std::string& csv,
                      double step) {
  At2Motion motion;
  Table table;
  std::string error;
  ASSERT_TRUE(ReadAt2(at2, &motion, &error)) << error;
  ASSERT_TRUE(ReadCsvTable(csv, {"t_s", "acc_g"}, &table, &error)) << error;
  EXPECT_EQ(motion.sampling_step, step);
  ASSERT_EQ(motion.acceleration.size(), table.num_rows());
  EXPECT_EQ(motion.acceleration, table.values.col(1));
}

TEST(At2Test, AgreesWithTheTableOfElCentro) {
  PINODE_FIND_MEASURED_DATA(at2,
                            "ground_motions/elCentro_peknold_opensees.at2");
  PINODE_FIND_MEASURED_DATA(csv, "ground_motions/elcentro_1940_ns_peknold.csv");
  ExpectSameMotion(at2, csv, 0.02);
}

TEST(At2Test, AgreesWithTheTableOfKobe) {
  PINODE_FIND_MEASURED_DATA(at2, "ground_motions/TAK000.AT2");
  PINODE_FIND_MEASURED_DATA(csv, "ground_motions/kobe_1995_takatori_000.csv");
  ExpectSameMotion(at2, csv, 0.01);
}

TEST(At2Test, AgreesWithTheTableOfPacoimaDam) {
  PINODE_FIND_MEASURED_DATA(at2, "ground_motions/RSN77_SFERN_PUL164.AT2");
  PINODE_FIND_MEASURED_DATA(csv, "ground_motions/pacoima_dam_1971_pul164.csv");
  ExpectSameMotion(at2, csv, 0.01);
}

}  // namespace
}  // namespace pinode
