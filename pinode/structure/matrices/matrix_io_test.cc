#include "pinode/structure/matrices/matrix_io.h"

#include <cmath>
#include <filesystem>
#include <limits>
#include <locale>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

Matrix Expected2x3() {
  Matrix matrix(2, 3);
  matrix << 1.0, -2.5, 3e4, 4.0, 0.0, 0.06;
  return matrix;
}

struct GoodFile {
  const char* name;
  const char* file;
  std::string content;
  Matrix expected;
};

void PrintTo(const GoodFile& good, std::ostream* stream) {
  *stream << good.name;
}

class GoodFileTest : public ::testing::TestWithParam<GoodFile> {};

TEST_P(GoodFileTest, IsRead) {
  TemporaryFolder folder;
  const std::string path = folder.Write(GetParam().file, GetParam().content);
  Matrix matrix;
  std::string error;
  ASSERT_TRUE(ReadMatrix(path, &matrix, &error)) << error;
  EXPECT_EQ(matrix, GetParam().expected);
}

Matrix Symmetric2x2() {
  Matrix matrix(2, 2);
  matrix << 2.0, -1.0, -1.0, 0.0;
  return matrix;
}

INSTANTIATE_TEST_SUITE_P(
    Csv, GoodFileTest,
    ::testing::ValuesIn(std::vector<GoodFile>{
        GoodFile{"Commas", "a.csv", "1,-2.5,3e4\n4,0,0.06\n", Expected2x3()},
        GoodFile{"Semicolons", "a.csv", "1;-2.5;3e4\n4;0;0.06", Expected2x3()},
        GoodFile{"Blanks", "a.CSV", "  1 -2.5\t3e4\n4   0 0.06 \n",
                 Expected2x3()},
        GoodFile{"CommasAndBlanks", "a.csv", "1, -2.5,  3e4 \n 4,0,0.06\n",
                 Expected2x3()},
        GoodFile{"CommentsAndBlankLines", "a.csv",
                 "# K, kN/m\n\n1,-2.5,3e4\n  # u2\n4,0,0.06\n\n\n",
                 Expected2x3()},
        GoodFile{"WindowsLineEndsAndMark", "a.csv",
                 "\xEF\xBB\xBF"
                 "1,-2.5,3e4\r\n4,0,0.06\r\n",
                 Expected2x3()},
        GoodFile{"SignsAndFortran", "a.csv", "+1,-.25D+01,3.E+4\n4.,-0,6d-2",
                 Expected2x3()},
        GoodFile{"OneNumber", "a.csv", "7", Matrix::Constant(1, 1, 7.0)}}),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    MatrixMarket, GoodFileTest,
    ::testing::ValuesIn(std::vector<GoodFile>{
        GoodFile{"CoordinateGeneral", "a.mtx",
                 "%%MatrixMarket matrix coordinate real general\n% K\n\n"
                 "2 3 5\n1 1 1\n2 1 4\n1 2 -2.5\n% late comment\n1 3 3e4\n"
                 "2 3 0.06\n\n",
                 Expected2x3()},
        GoodFile{"ArrayGeneral", "a.MTX",
                 "%%matrixmarket MATRIX Array Real General\n2 3\n1\n4\n-2.5\n"
                 "0\n3e4\n0.06",
                 Expected2x3()},
        GoodFile{"CoordinateSymmetricLower", "a.mtx",
                 "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n"
                 "1 1 2\n2 1 -1\n",
                 Symmetric2x2()},
        GoodFile{"CoordinateSymmetricUpper", "a.mtx",
                 "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n"
                 "1 1 2\n1 2 -1\n",
                 Symmetric2x2()},
        GoodFile{"ArraySymmetricInteger", "a.mtx",
                 "%%MatrixMarket matrix array integer symmetric\r\n2 2\r\n"
                 "2\r\n-1\r\n0\r\n",
                 Symmetric2x2()},
        GoodFile{"NoEntries", "a.mtx",
                 "%%MatrixMarket matrix coordinate real general\n2 2 0\n",
                 Matrix::Zero(2, 2)}}),
    [](const auto& test) { return test.param.name; });

struct BadFile {
  const char* name;
  const char* file;
  std::string content;
  // Line in the message; 0: no line.
  int line;
  std::vector<const char*> message_parts;
};

void PrintTo(const BadFile& bad, std::ostream* stream) { *stream << bad.name; }

class BadFileTest : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadFileTest, IsRefusedWithFileAndLine) {
  const BadFile& bad = GetParam();
  TemporaryFolder folder;
  const std::string path = folder.Write(bad.file, bad.content);
  const Matrix before = Matrix::Constant(1, 1, 42.0);
  Matrix matrix = before;
  std::string error;
  EXPECT_FALSE(ReadMatrix(path, &matrix, &error));
  EXPECT_EQ(matrix, before) << "a partial result";
  EXPECT_THAT(
      error,
      StartsWith(bad.line == 0 ? path + ": "
                               : path + ":" + std::to_string(bad.line) + ": "));
  EXPECT_THAT(error, HasSubstr("expected"));
  EXPECT_EQ(error.find('\n'), std::string::npos);
  for (const char* part : bad.message_parts) {
    EXPECT_THAT(error, HasSubstr(part));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Csv, BadFileTest,
    ::testing::ValuesIn(std::vector<BadFile>{
        BadFile{"Extension", "a.xlsx", "1", 0, {".csv", ".mtx"}},
        BadFile{"Empty", "a.csv", "", 1, {"no entries"}},
        BadFile{"OnlyComments", "a.csv", "# nothing\n\n", 2, {"no entries"}},
        BadFile{"Ragged",
                "a.csv",
                "# K\n1,2\n\n3,4,5\n",
                4,
                {"3 entries", "expected 2", "line 2"}},
        BadFile{"Text", "a.csv", "1,2\n3,four\n", 2, {"(2, 2)", "'four'"}},
        BadFile{"Header", "a.csv", "u1,u2\n1,2\n3,4\n", 1, {"(1, 1)", "'u1'"}},
        BadFile{"EmptyEntry", "a.csv", "1,,3\n", 1, {"(1, 2)", "''"}},
        BadFile{"TrailingComma", "a.csv", "1,2,\n3,4,\n", 1, {"(1, 3)"}},
        BadFile{"NaN", "a.csv", "1,2\n3,NaN\n", 2, {"(2, 2)", "finite"}},
        BadFile{"Infinity", "a.csv", "1,2\n-inf,4\n", 2, {"(2, 1)", "finite"}},
        BadFile{"TooLargeANumber", "a.csv", "1e999", 1, {"(1, 1)", "1e999"}},
        BadFile{"DecimalCommas", "a.csv", "1,5;2,5\n", 1, {"decimal point"}},
        BadFile{"TwoNumbersInOneField", "a.csv", "1 2,3\n", 1, {"'1 2'"}},
        BadFile{"ControlCharacters",
                "a.csv",
                std::string("1,\x01\x02") + "x",
                1,
                {"'??x'"}}}),
    [](const auto& test) { return test.param.name; });

constexpr char kCoordinate[] =
    "%%MatrixMarket matrix coordinate real general\n";
constexpr char kSymmetric[] =
    "%%MatrixMarket matrix coordinate real symmetric\n";
constexpr char kArray[] = "%%MatrixMarket matrix array real general\n";

std::string After(const char* banner, const char* rest) {
  return std::string(banner) + rest;
}

INSTANTIATE_TEST_SUITE_P(
    MatrixMarket, BadFileTest,
    ::testing::ValuesIn(std::vector<BadFile>{
        BadFile{"Empty", "a.mtx", "", 1, {"banner"}},
        BadFile{"NoBanner", "a.mtx", "2 2 1\n1 1 1\n", 1, {"%%MatrixMarket"}},
        BadFile{"Vector",
                "a.mtx",
                "%%MatrixMarket vector coordinate real general\n",
                1,
                {"banner"}},
        BadFile{"Format",
                "a.mtx",
                "%%MatrixMarket matrix elemental real general\n",
                1,
                {"'elemental'", "coordinate or array"}},
        BadFile{"Pattern",
                "a.mtx",
                "%%MatrixMarket matrix coordinate pattern general\n",
                1,
                {"pattern", "real or integer"}},
        BadFile{"Complex",
                "a.mtx",
                "%%MatrixMarket matrix coordinate complex general\n",
                1,
                {"complex", "real or integer"}},
        BadFile{"Field",
                "a.mtx",
                "%%MatrixMarket matrix coordinate rational general\n",
                1,
                {"'rational'"}},
        BadFile{"Skew",
                "a.mtx",
                "%%MatrixMarket matrix coordinate real skew-symmetric\n",
                1,
                {"skew-symmetric", "general or symmetric"}},
        BadFile{"Hermitian",
                "a.mtx",
                "%%MatrixMarket matrix coordinate real Hermitian\n",
                1,
                {"hermitian"}},
        BadFile{"Symmetry",
                "a.mtx",
                "%%MatrixMarket matrix coordinate real diagonal\n",
                1,
                {"'diagonal'"}},
        BadFile{
            "NoSizes", "a.mtx", After(kCoordinate, "% K\n"), 2, {"size line"}},
        BadFile{"TwoSizes",
                "a.mtx",
                After(kCoordinate, "2 2\n"),
                2,
                {"'2 2'", "rows columns entries"}},
        BadFile{"TextSizes",
                "a.mtx",
                After(kArray, "2 n\n"),
                2,
                {"'2 n'", "rows columns"}},
        BadFile{"FractionalSizes",
                "a.mtx",
                After(kArray, "2.0 2.0\n"),
                2,
                {"integers"}},
        BadFile{"ZeroSize",
                "a.mtx",
                After(kCoordinate, "0 0 0\n"),
                2,
                {"at least one row"}},
        BadFile{"NegativeCount",
                "a.mtx",
                After(kCoordinate, "2 2 -1\n"),
                2,
                {"'2 2 -1'"}},
        BadFile{"HugeSize",
                "a.mtx",
                After(kCoordinate, "2000000 2000000 1\n"),
                2,
                {"2000000 x 2000000", "at most 10000"}},
        BadFile{"SizeBeyondIntegers",
                "a.mtx",
                After(kCoordinate, "99999999999 1 1\n"),
                2,
                {"integers"}},
        BadFile{"HugeCount",
                "a.mtx",
                After(kCoordinate, "2 2 5\n"),
                2,
                {"5 entries", "at most 4"}},
        BadFile{"HugeSymmetricCount",
                "a.mtx",
                After(kSymmetric, "2 2 4\n"),
                2,
                {"4 entries", "at most 3"}},
        BadFile{"SymmetricRectangle",
                "a.mtx",
                After(kSymmetric, "2 3 1\n"),
                2,
                {"2 x 3", "as many rows as columns"}},
        BadFile{"Truncated",
                "a.mtx",
                After(kCoordinate, "2 2 2\n1 1 1\n"),
                3,
                {"after 1 entries", "expected 2", "line 2"}},
        BadFile{"Oversized",
                "a.mtx",
                After(kCoordinate, "2 2 1\n1 1 1\n2 2 1\n"),
                4,
                {"more entries", "1"}},
        BadFile{"ArrayTruncated",
                "a.mtx",
                After(kArray, "2 2\n1\n2\n3\n"),
                5,
                {"after 3 entries", "expected 4"}},
        BadFile{"ArrayOversized",
                "a.mtx",
                After(kArray, "1 2\n1\n2\n3\n"),
                5,
                {"more entries"}},
        BadFile{"TwoWords",
                "a.mtx",
                After(kCoordinate, "2 2 1\n1 1\n"),
                3,
                {"'1 1'", "row column value"}},
        BadFile{"FourWords",
                "a.mtx",
                After(kCoordinate, "2 2 1\n1 1 1 0\n"),
                3,
                {"row column value"}},
        BadFile{"TextIndex",
                "a.mtx",
                After(kCoordinate, "2 2 1\n1 x 1\n"),
                3,
                {"row column value"}},
        BadFile{"IndexZero",
                "a.mtx",
                After(kCoordinate, "2 2 1\n0 1 1\n"),
                3,
                {"(0, 1)", "from 1 to 2"}},
        BadFile{"IndexTooLarge",
                "a.mtx",
                After(kCoordinate, "2 2 1\n1 3 1\n"),
                3,
                {"(1, 3)", "outside"}},
        BadFile{"Duplicate",
                "a.mtx",
                After(kCoordinate, "2 2 2\n2 1 1\n2 1 5\n"),
                4,
                {"(2, 1)", "given before"}},
        BadFile{"MirroredDuplicate",
                "a.mtx",
                After(kSymmetric, "2 2 2\n2 1 1\n1 2 1\n"),
                4,
                {"(1, 2)", "mirror image"}},
        BadFile{"NaN",
                "a.mtx",
                After(kCoordinate, "2 2 1\n2 1 nan\n"),
                3,
                {"(2, 1)", "finite"}},
        BadFile{"ArrayInfinity",
                "a.mtx",
                After(kArray, "2 1\n1\ninf\n"),
                4,
                {"(2, 1)", "finite"}},
        BadFile{"TextValue",
                "a.mtx",
                After(kCoordinate, "2 2 1\n2 1 k\n"),
                3,
                {"(2, 1)", "'k'", "number"}},
        BadFile{"FractionAmongIntegers",
                "a.mtx",
                "%%MatrixMarket matrix array integer general\n1 1\n1.5\n",
                3,
                {"(1, 1)", "integer"}}}),
    [](const auto& test) { return test.param.name; });

TEST(ReadMatrix, RefusesWhatIsNotAFile) {
  TemporaryFolder folder;
  Matrix matrix;
  std::string error;
  EXPECT_FALSE(ReadMatrix(folder.Path("missing.csv"), &matrix, &error));
  EXPECT_THAT(error, HasSubstr("missing.csv"));
  std::filesystem::create_directory(folder.Path("folder.mtx"));
  EXPECT_FALSE(ReadMatrix(folder.Path("folder.mtx"), &matrix, &error));
  EXPECT_THAT(error, HasSubstr("folder.mtx"));
}

TEST(ReadMatrix, RefusesInvalidUtf8) {
  TemporaryFolder folder;
  Matrix matrix;
  std::string error;
  const std::string path = folder.Write("a.csv", "1,2\n3,\xFF\n");
  EXPECT_FALSE(ReadMatrix(path, &matrix, &error));
  EXPECT_THAT(error, StartsWith(path + ":2: "));
}

TEST(ReadMatrix, RefusesTooManyColumns) {
  TemporaryFolder folder;
  std::string line = "0";
  for (int i = 0; i < kMaxMatrixDimension; ++i) line += ",0";
  Matrix matrix;
  std::string error;
  EXPECT_FALSE(ReadMatrix(folder.Write("a.csv", line), &matrix, &error));
  EXPECT_THAT(error, HasSubstr("more than 10000 rows or columns"));
}

// Numbers as in "1.234.567,5".
class ContinentalNumbers : public std::numpunct<char> {
 protected:
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(MatrixIo, IgnoresTheLocale) {
  TemporaryFolder folder;
  const std::string path = folder.Write("a.csv", "1.5,1234567.25\n");
  const std::locale saved = std::locale::global(
      std::locale(std::locale::classic(), new ContinentalNumbers));
  Matrix matrix;
  std::string error;
  const bool read = ReadMatrix(path, &matrix, &error);
  const bool written =
      read && WriteMatrixMarket(folder.Path("a.mtx"), matrix, &error);
  std::locale::global(saved);
  ASSERT_TRUE(read && written) << error;
  EXPECT_EQ(matrix, (Matrix(1, 2) << 1.5, 1234567.25).finished());
  EXPECT_THAT(FileContent(folder.Path("a.mtx")),
              HasSubstr("1 1 1.5\n1 2 1234567.25\n"));
}

TEST(WriteMatrixMarket, GivesBackTheSameBits) {
  TemporaryFolder folder;
  const std::string path = folder.Path("K.mtx");
  std::vector<Matrix> matrices = {
      Matrix::Random(5, 5),
      Matrix::Random(2, 7),
      Matrix::Zero(3, 3),
      Matrix::Constant(1, 1, 0.1),
      Matrix::Constant(2, 2, std::numeric_limits<double>::max()),
      Matrix::Constant(2, 2, -std::numeric_limits<double>::min())};
  const Matrix random = Matrix::Random(6, 6) * 1e9;
  matrices.push_back(random + random.transpose());
  for (const Matrix& matrix : matrices) {
    std::string error;
    ASSERT_TRUE(WriteMatrixMarket(path, matrix, &error)) << error;
    Matrix read;
    ASSERT_TRUE(ReadMatrix(path, &read, &error)) << error;
    EXPECT_EQ(read, matrix);
  }
  EXPECT_EQ(folder.NumFiles(), 1) << "a temporary file was left behind";
}

TEST(WriteMatrixMarket, WritesTheSymmetricFormIfExactlySymmetric) {
  TemporaryFolder folder;
  const std::string path = folder.Path("K.mtx");
  std::string error;
  ASSERT_TRUE(WriteMatrixMarket(path, Symmetric2x2(), &error)) << error;
  EXPECT_EQ(FileContent(path),
            "%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n"
            "1 1 2\n2 1 -1\n");
  Matrix nearly = Symmetric2x2();
  nearly(0, 1) = std::nextafter(-1.0, 0.0);
  ASSERT_TRUE(WriteMatrixMarket(path, nearly, &error)) << error;
  EXPECT_THAT(FileContent(path), HasSubstr("real general\n2 2 3\n"));
}

TEST(WriteMatrixMarket, RefusesWhatItCannotWrite) {
  TemporaryFolder folder;
  std::string error;
  Matrix matrix = Symmetric2x2();
  EXPECT_FALSE(WriteMatrixMarket(folder.Path("none/K.mtx"), matrix, &error));
  EXPECT_THAT(error, HasSubstr("none/K.mtx"));

  matrix(1, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(WriteMatrixMarket(folder.Path("K.mtx"), matrix, &error));
  EXPECT_THAT(error, HasSubstr("(2, 1) is nan"));
  EXPECT_EQ(folder.NumFiles(), 0);
}

}  // namespace
}  // namespace pinode
