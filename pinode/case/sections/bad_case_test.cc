// Cases that are refused, with the line that is at fault.

#include <ostream>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/case/sections/case_file.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// One thing wrong with the small case at a time.
struct BadCase {
  const char* name;
  const char* from;  // in the case
  const char* to;
  const char* message;
  const char* data_from = "";  // in the record
  const char* data_to = "";
};

void PrintTo(const BadCase& bad, std::ostream* out) { *out << bad.name; }

class BadCaseTest : public ::testing::TestWithParam<BadCase> {};

TEST_P(BadCaseTest, IsRefusedWithItsPlace) {
  const BadCase& bad = GetParam();
  TemporaryFolder folder;
  const std::string data = SmallRecord();
  folder.Write("quake.csv", *bad.data_from == '\0'
                                ? data
                                : Replaced(data, bad.data_from, bad.data_to));
  folder.Write("bad.csv", "1, nan\nnan, 2\n");
  folder.Write("small.csv", "1\n");
  folder.Write("empty.csv", "");
  folder.Write("header.csv", "t,ag,a1,d2\n");
  folder.Write("one.csv", "t,ag,a1,d2\n0,1,2,3\n");
  const std::string path = folder.Write(
      "case.toml", *bad.from == '\0' ? SmallCase()
                                     : Replaced(SmallCase(), bad.from, bad.to));
  Case c;
  c.problem.description.title = "untouched";
  std::string error;
  EXPECT_FALSE(ReadCase(path, &c, &error));
  EXPECT_THAT(error, HasSubstr(bad.message));
  EXPECT_THAT(error, HasSubstr(folder.Path("")));
  EXPECT_THAT(error, Not(HasSubstr("\n")));
  EXPECT_EQ(c.problem.description.title, "untouched");
}

const BadCase kBadCases[] = {
    {"UnknownKey", "scale = 200.0", "scael = 200.0",
     "case.toml:14: [[group]] 1: unknown key 'scael'; did you mean 'scale'?"},
    {"UnknownSection", "[[group]]", "[[groups]]",
     "case.toml:10: unknown key 'groups'; did you mean 'group'?"},
    {"NotToml", "[units]", "[units", "case.toml:2: "},
    {"NotUtf8", "Two storeys", "Two \xff", "case.toml:1: "},
    {"WrongType", "scale = 200.0", "scale = \"200\"",
     "case.toml:14: group 'k1': 'scale' is the text '200', expected a finite"},
    {"TooLargeNumber", "[units]",
     "[options]\nmax_iterations = 5000000000\n[units]",
     "expected a whole number of at most 1000000000"},
    {"TooManyThreads", "[units]", "[options]\nthreads = 100000\n[units]",
     "'threads' is the number 100000, expected a whole number of at most 1024"},
    {"NumberBeyondUse", "scale = 200.0", "scale = 1e300",
     "'scale' is the number 1e+300, expected a number of at most 1e+100"},
    {"UnknownUnit", "force = \"kN\"", "force = \"KN\"", "case.toml:3: [units]"},
    {"EmptyUnit", "force = \"kN\"", "force = \"\"", "case.toml:3: [units]"},
    {"UnknownDof", "between = [\"ground\", \"u1\"]",
     "between = [\"ground\", \"u11\"]",
     "case.toml:13: group 'k1': 'u11' is not a DOF of the model; did you mean"},
    {"UnknownDofOfChannel", "dof = \"u2\"", "dof = \"w2\"", "case.toml:34: "},
    {"WrongMatrixSize", "{diagonal = [2.0, 1.0]}", "{diagonal = [2.0]}",
     "case.toml:7: [model]: the mass matrix is 1 x 1, expected 2 x 2"},
    {"WrongMatrixSizeInFile", "{diagonal = [2.0, 1.0]}", "\"small.csv\"",
     "small.csv: the mass matrix is 1 x 1, expected 2 x 2"},
    {"RaggedRows", "[-100.0, 100.0]", "[-100.0]",
     "case.toml:8: [model]: row 2 of 'stiffness'"},
    {"UnsymmetricMass", "{diagonal = [2.0, 1.0]}", "[[2.0, 0.5], [0.0, 1.0]]",
     "case.toml:7: [model]: the mass matrix is not symmetric"},
    {"IndefiniteMass", "{diagonal = [2.0, 1.0]}", "{diagonal = [2.0, -1.0]}",
     "case.toml:7: [model]: the mass matrix is not positive definite"},
    {"UnsymmetricStiffness", "[-100.0, 100.0]", "[-90.0, 100.0]",
     "case.toml:8: [model]: the stiffness matrix is not symmetric"},
    {"NanInMatrix", "{diagonal = [2.0, 1.0]}", "\"bad.csv\"", "bad.csv"},
    {"NanInText", "{diagonal = [2.0, 1.0]}", "{diagonal = [2.0, nan]}",
     "case.toml:7: "},
    {"MissingMatrixFile", "{diagonal = [2.0, 1.0]}", "\"no.csv\"",
     "case.toml:7: [model]: 'mass' names the file 'no.csv', which does not"},
    {"MissingDamping", "damping = {ratios = [0.02]}\n", "",
     "case.toml:5: [model]: 'damping' is missing"},
    {"MissingFile", "file = \"quake.csv\"", "file = \"none.csv\"",
     "case.toml:18: record 'quake': the file"},
    {"EmptyRecord", "file = \"quake.csv\"", "file = \"empty.csv\"",
     "empty.csv"},
    {"HeaderOnly", "file = \"quake.csv\"", "file = \"header.csv\"",
     "header.csv"},
    {"OneSample", "file = \"quake.csv\"", "file = \"one.csv\"", "one.csv"},
    {"DecreasingTime", "", "", "quake.csv:6: ", "\n0.04,", "\n0.02,"},
    {"TextInAChannel", "", "", "quake.csv:6: ", "\n0.04,", "\n0.04,x"},
    {"MissingExcitation", "", "", "case.toml:16: record 'quake'",
     "t,ag,a1,d2\n0,0,", "t,ag,a1,d2\n0,,"},
    {"UnknownColumn", "column = \"d2\"", "column = \"d3\"", "quake.csv:1: "},
    {"UnitMismatch", "unit = \"mm\"", "unit = \"mm/s\"",
     "case.toml:35: record 'quake', channel 'd2': unit 'mm/s' is "
     "that of a velocity, expected that of a length"},
    {"UnitMismatchOfGround", "unit = \"gal\"", "unit = \"kN\"",
     "case.toml:25: "},
    {"NoInterpolation", "interpolation = \"linear\"\n", "",
     "'interpolation' is missing, expected one of held, linear, cubic"},
    {"UnknownChoice", "\"linear\"", "\"spline\"",
     "case.toml:20: record 'quake': 'interpolation' is 'spline', expected one"},
    {"NoFreeParameter", "lower = -0.9", "free = false",
     "case.toml: no parameter is free"},
    {"CrossedBounds", "lower = -0.9", "lower = 0.9\nupper = 0.5",
     "case.toml:15: group 'k1': the bounds of 'k1' are crossed"},
    {"OutsideBounds", "lower = -0.9", "lower = 0.9",
     "the initial value of 'k1', 0, lies outside its bounds"},
    {"CoarseSampling", "start = \"rest\"",
     "start = \"rest\"\nsubsteps = 1\nresample_hz = 4.0",
     "case.toml:22: record 'quake': its sampling is too coarse for the model's "
     "highest mode"},
    {"ResampledToAbsurdity", "start = \"rest\"",
     "start = \"rest\"\nresample_hz = 1e9",
     "case.toml:22: record 'quake': 'resample_hz' is more than 100 times"},
    {"WindowOutside", "start = \"rest\"",
     "start = \"rest\"\nwindow = [0.0, 99.0]",
     "case.toml:22: record 'quake': window [0, 99] reaches beyond"},
    {"FilterAboveNyquist", "start = \"rest\"",
     "start = \"rest\"\nfilter = {type = \"lowpass\", corner_hz = 80.0}",
     "case.toml:22: "},
    {"TwoOfAName", "column = \"d2\"", "column = \"d2\"\n  name = \"a1\"",
     "this name is used twice in this record, expected different names"},
    {"NameWithASlash", "name = \"quake\"", "name = \"../quake\"",
     "case.toml:17: record '../quake': '../quake' cannot be a name here"},
    {"NoTime", "time = \"t\"\n", "", "'time' is missing"},
    {"UnknownQuantity", "quantity = \"displacement\"", "quantity = \"strian\"",
     "case.toml:33: "},
    {"OnlyHoldOut", "name = \"quake\"", "name = \"quake\"\nrole = \"holdout\"",
     "no training record has a fitted channel"},
};

std::string BadCaseName(const ::testing::TestParamInfo<BadCase>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(All, BadCaseTest, ::testing::ValuesIn(kBadCases),
                         BadCaseName);

TEST(CaseFileTest, MissingCaseFile) {
  Case c;
  std::string error;
  EXPECT_FALSE(ReadCase("/nonexistent/case.toml", &c, &error));
  EXPECT_THAT(error, HasSubstr("/nonexistent/case.toml"));
}

}  // namespace
}  // namespace pinode
