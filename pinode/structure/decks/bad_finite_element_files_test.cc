// Refused files of finite-element programs: cut short, or with errors.

#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/finite_element_files_testing.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

namespace fs = std::filesystem;

class BadFiniteElementFilesTest : public FiniteElementFilesTest {};

// A faulty text, its format and the expected error.
struct BadText {
  const char* name;
  // Replaces the stiffness.
  const char* file;
  const char* content;
  int line;
  const char* message;
};

void PrintTo(const BadText& bad, std::ostream* stream) { *stream << bad.name; }

class BadTextTest : public FiniteElementFilesTest,
                    public ::testing::WithParamInterface<BadText> {};

TEST_P(BadTextTest, IsRefusedWithFileAndLine) {
  const BadText& bad = GetParam();
  TemporaryFolder folder;
  const std::string path = folder.Write(bad.file, bad.content);
  const bool abaqus = fs::path(path).extension() == ".mtx";
  const std::string error = ErrorOf(Files(
      {Sample(abaqus ? "abaqus/beam_MASS2.mtx" : "calculix/beam.mas"), ""},
      {path, ""}));
  EXPECT_THAT(error, StartsWith(path + ":" + std::to_string(bad.line) + ": "));
  EXPECT_THAT(error, HasSubstr("expected"));
  EXPECT_THAT(error, HasSubstr(bad.message));
}

INSTANTIATE_TEST_SUITE_P(
    CalculiX, BadTextTest,
    ::testing::ValuesIn(std::vector<BadText>{
        BadText{"Empty", "a.sti", "", 1, "no entries"},
        BadText{"TwoWords", "a.sti", "1 1 1\n2 2\n", 2, "'2 2'"},
        BadText{"Text", "a.sti", "1 1 1\n2 2 x\n", 2, "'x'"},
        BadText{"Infinite", "a.sti", "1 1 inf\n", 1, "finite"},
        BadText{"IndexZero", "a.sti", "1 0 1\n", 1, "(1, 0)"},
        BadText{"HugeIndex", "a.sti", "1 1 1\n2000000000 1 1\n", 2, "2000000"},
        BadText{"BeyondIntegers", "a.sti", "99999999999 1 1\n", 1, "row"},
        BadText{"Duplicate", "a.sti", "1 1 1\n2 2 1\n1 1 1\n", 3,
                "(1, 1) or its mirror image was given before"},
        BadText{"DuplicateOfFull", "a.sti",
                "1 1 1\n1 2 1\n2 1 1\n2 2 3\n1 2 1\n", 5, "(1, 2) was given"},
        BadText{"HalfATriangle", "a.sti",
                "1 1 1\n1 2 1\n2 1 1\n1 3 1\n2 2 1\n3 3 1\n", 4,
                "(1, 3) has no mirror image"}}),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Abaqus, BadTextTest,
    ::testing::ValuesIn(std::vector<BadText>{
        BadText{"Empty", "a.mtx", "** nothing\n", 1, "no entries"},
        BadText{"FourFields", "a.mtx", "1,1,1,5.0\n", 1, "node, direction"},
        BadText{"Text", "a.mtx", "1,1,1,1,1.0\n1,1,2,1,x\n", 2, "'x'"},
        BadText{"Direction", "a.mtx", "1,-1,1,1,1.0\n", 1, "direction"},
        BadText{"Duplicate", "a.mtx", "1,1,1,1,1.0\n1,1,1,1,1.0\n", 2,
                "given before"},
        BadText{"HalfATriangle", "a.mtx",
                "1,1,1,1,9.\n2,1,1,1,1.\n1,1,2,1,1.\n2,1,2,1,9.\n"
                "3,1,1,1,1.\n3,1,3,1,9.\n",
                5, "no mirror image"}}),
    [](const auto& test) { return test.param.name; });

// Every prefix of a file is refused, or gives the whole model if its missing
// end does not matter. It never causes a crash or another model.
TEST_F(BadFiniteElementFilesTest, TruncatedFilesAreRefused) {
  TemporaryFolder folder;
  struct Truncated {
    const char* name;
    bool damped;
    // Bytes at the end that may be missing: the end of the last matrix of an
    // OP4 file, or a variable behind the requested ones.
    size_t spare;
  };
  for (const Truncated& sample :
       std::vector<Truncated>{{"op4/ascii_dense.op4", true, 60},
                              {"op4/ascii_sparse.op4", true, 60},
                              {"op4/little_32_bigmat.op4", true, 0},
                              {"op4/big_64_dense.op4", true, 0},
                              {"op4/little_64_sparse.op4", true, 0},
                              {"op4/little_64_marker.op4", true, 0},
                              {"op4/big_32_marker.op4", true, 0},
                              {"mat/sparse.mat", true, 0},
                              {"mat/compressed.mat", true, 61},
                              {"npz/full.npz", true, 0},
                              {"npz/types.npz", false, 0}}) {
    SCOPED_TRACE(sample.name);
    const std::string content = FileContent(Sample(sample.name));
    const std::string path =
        folder.Path("cut" + fs::path(sample.name).extension().string());
    ASSERT_GT(content.size(), sample.spare);
    int refused = 0;
    int tried = 0;
    for (size_t size = 0; size < content.size(); size += 7) {
      std::ofstream(path, std::ios::binary) << content.substr(0, size);
      FiniteElementModel model;
      std::string error;
      ++tried;
      if (!ReadFiniteElementModel(OneFile(path, sample.damped), &model,
                                  &error)) {
        EXPECT_THAT(error, StartsWith(path));
        ++refused;
        continue;
      }
      EXPECT_EQ(Matrix(model.stiffness), ExpectedStiffness());
      EXPECT_EQ(Matrix(model.mass), ExpectedMass());
      EXPECT_GE(size + sample.spare, content.size()) << "a cut file was read";
    }
    EXPECT_GT(refused, tried / 2);
  }
}

std::string Replaced(std::string content, const std::string& from,
                     const std::string& to) {
  const size_t at = content.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return content.replace(at, from.size(), to);
}

TEST_F(BadFiniteElementFilesTest, BadOp4IsRefused) {
  TemporaryFolder folder;
  const std::string sparse = FileContent(Sample("op4/ascii_sparse.op4"));
  const std::string big = FileContent(Sample("op4/ascii_bigmat.op4"));
  const std::string dense = FileContent(Sample("op4/ascii_dense.op4"));
  const auto error_of = [&folder](const std::string& content) {
    return ErrorOf(OneFile(folder.Write("a.op4", content), false));
  };
  EXPECT_THAT(error_of(""), HasSubstr("a.op4:1: the file is empty"));
  EXPECT_THAT(error_of("solid\n"), HasSubstr("a.op4:1: the line is 'solid'"));
  EXPECT_THAT(error_of(std::string("\x01\xff\xfe\x00\x12", 5)),
              HasSubstr("24 or 48"));
  // Sizes.
  EXPECT_THAT(error_of(Replaced(dense, "       4       4       6",
                                "99999999       4       6")),
              HasSubstr("a.op4:1: matrix 'mgg' is 4 x 99999999"));
  EXPECT_THAT(error_of(Replaced(dense, "       4       4       6",
                                "       4       0       6")),
              HasSubstr("0 x 4"));
  EXPECT_THAT(
      error_of(Replaced(dense, "       6       2MGG", "       6       7MGG")),
      HasSubstr("type 7"));
  EXPECT_THAT(error_of(Replaced(dense, "1P,3E23.16", "(3E23.16")),
              HasSubstr("format"));
  // More numbers than rows; a row outside; a string longer than its column.
  EXPECT_THAT(error_of(Replaced(dense, "       1       1       2",
                                "       1       1       9")),
              HasSubstr("a.op4:2: 9 numbers from row 1 of column 1"));
  EXPECT_THAT(error_of(Replaced(sparse, "327681", "327689")),
              HasSubstr("a.op4:3: 2 numbers from row 9"));
  EXPECT_THAT(error_of(Replaced(sparse, "327681", "655361")),
              HasSubstr("at most 5 words"));
  EXPECT_THAT(error_of(Replaced(sparse, "327681", "   -10")),
              HasSubstr("at most 5 words"));
  EXPECT_THAT(
      error_of(Replaced(big, "       5       1\n", "       5       0\n")),
      HasSubstr("from row 0"));
  // A column twice, a matrix twice, words for numbers.
  EXPECT_THAT(error_of(Replaced(dense, "       2       1       2",
                                "       1       1       2")),
              HasSubstr("(1, 1) of 'mgg' was given before"));
  EXPECT_THAT(error_of(Replaced(dense, "2.0000000000000000E+00",
                                "2.000000000000000 E+00")),
              HasSubstr("a.op4:3: entry (1, 1)"));
  // Complex, and a form that is no square.
  EXPECT_THAT(
      error_of(Replaced(dense, "       6       2MGG", "       8       2MGG")),
      HasSubstr("form is 8"));
}

TEST_F(BadFiniteElementFilesTest, BadBinaryOp4IsRefused) {
  TemporaryFolder folder;
  const std::string content = FileContent(Sample("op4/little_32_sparse.op4"));
  const auto error_with_byte = [&](size_t at, char value) {
    std::string changed = content;
    changed[at] = value;
    return ErrorOf(OneFile(folder.Write("a.op4", changed), false));
  };
  // Bytes 4 to 7: columns; 8 to 11: rows; 28: the record's length again.
  EXPECT_THAT(error_with_byte(7, 0x7f), HasSubstr("rows and columns"));
  EXPECT_THAT(error_with_byte(11, '\x80'), HasSubstr("rows"));
  EXPECT_THAT(error_with_byte(28, 25), HasSubstr("expected 24 as before"));
  // The first column's record: length, column, 0, words, string header.
  EXPECT_THAT(error_with_byte(35, 0x7f),
              HasSubstr("check that the file is complete"));
  EXPECT_THAT(error_with_byte(44, 100), HasSubstr("at most 5 words"));
  EXPECT_THAT(error_with_byte(48, 9), HasSubstr("from row 9"));
  EXPECT_THAT(error_with_byte(50, 100), HasSubstr("header of a string"));
}

// The same where lengths, integers and names take 8 bytes a word.
TEST_F(BadFiniteElementFilesTest, BadLongBinaryOp4IsRefused) {
  TemporaryFolder folder;
  const auto error_with_byte = [&folder](const char* sample, size_t at,
                                         char value) {
    std::string changed = FileContent(Sample(sample));
    changed[at] = value;
    return ErrorOf(OneFile(folder.Write("a.op4", changed), false));
  };
  // Lengths of 4 bytes: columns from 4, rows from 12, the length again at 52;
  // then length, column, 0, words (from 76), header of a string, numbers.
  const char* const short_marker = "op4/little_64_sparse.op4";
  EXPECT_THAT(error_with_byte(short_marker, 11, 0x7f),
              HasSubstr("rows and columns"));
  EXPECT_THAT(error_with_byte(short_marker, 19, '\x80'), HasSubstr("rows"));
  EXPECT_THAT(error_with_byte(short_marker, 52, 49),
              HasSubstr("expected 48 as before"));
  EXPECT_THAT(error_with_byte(short_marker, 83, '\x80'),
              HasSubstr("at most 3 words"));
  EXPECT_THAT(error_with_byte(short_marker, 84, 9), HasSubstr("from row 9"));
  EXPECT_THAT(error_with_byte(short_marker, 91, '\x80'),
              HasSubstr("header of a string"));
  // Lengths of 8 bytes: columns from 8, the length again at 56, the next one
  // at 64.
  const char* const long_marker = "op4/little_64_marker.op4";
  EXPECT_THAT(error_with_byte(long_marker, 63, 1),
              HasSubstr("expected 48 as before"));
  EXPECT_THAT(error_with_byte(long_marker, 71, 0x7f),
              HasSubstr("check that the file is complete"));
  EXPECT_THAT(error_with_byte(long_marker, 71, '\x80'),
              HasSubstr("check that the file is complete"));
}

TEST_F(BadFiniteElementFilesTest, BadNpzIsRefused) {
  TemporaryFolder folder;
  EXPECT_THAT(ErrorOf(OneFile(folder.Write("a.npz", "PK"), false)),
              HasSubstr("NumPy archive"));
  EXPECT_THAT(ErrorOf(OneFile(Sample("npz/types.npz"), true)),
              HasSubstr("usual name of the damping matrix"));
  // An impossible shape in the header of the first array, stored uncompressed.
  const std::string content = FileContent(Sample("npz/full.npz"));
  for (const char* shape : {"(4, 5)", "(9, 4)", "(4, x)", "[4, 4]"}) {
    SCOPED_TRACE(shape);
    // The checksum of the archive, or the header, shows the error.
    EXPECT_THAT(
        ErrorOf(OneFile(
            folder.Write("a.npz", Replaced(content, "(4, 4)", shape)), false)),
        HasSubstr("a.npz: array "));
  }
}

}  // namespace
}  // namespace pinode
