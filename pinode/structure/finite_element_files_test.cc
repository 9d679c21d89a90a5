#include "pinode/structure/finite_element_files.h"

#include <matio.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/temporary_folder_testing.h"
#include "pinode/structure/matrix_market.h"
#include "pinode/structure/sparse_modes.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

namespace fs = std::filesystem;

// A file that tests/generators/matrix_files.py wrote.
std::string Sample(const std::string& name) {
  return std::string(PINODE_SOURCE_DIR) + "/tests/fuzz/corpus/" + name;
}

// The model of all samples.
Matrix ExpectedStiffness() {
  Matrix stiffness(4, 4);
  stiffness << 4, -2, 0, 0, -2, 5, -1.5, 0, 0, -1.5, 3, -1, 0, 0, -1, 1;
  return 1e6 * stiffness;
}

Matrix ExpectedMass() {
  Matrix mass = Matrix::Zero(4, 4);
  mass.topLeftCorner(2, 2) << 2.0, 0.5, 0.5, 2.0;
  mass(3, 3) = 1.0;
  return mass;
}

FiniteElementFiles Files(const MatrixSource& mass,
                         const MatrixSource& stiffness,
                         const std::string& dof_names = "") {
  FiniteElementFiles files;
  files.mass = mass;
  files.stiffness = stiffness;
  files.dof_names = dof_names;
  return files;
}

FiniteElementFiles OneFile(const std::string& path, bool damped) {
  FiniteElementFiles files = Files({path, ""}, {path, ""});
  if (damped) files.damping = {path, ""};
  return files;
}

FiniteElementModel ReadOrFail(const FiniteElementFiles& files) {
  FiniteElementModel model;
  std::string error;
  EXPECT_TRUE(ReadFiniteElementModel(files, &model, &error)) << error;
  return model;
}

std::string ErrorOf(const FiniteElementFiles& files) {
  FiniteElementModel model;
  model.dof_names = {"untouched"};
  std::string error;
  EXPECT_FALSE(ReadFiniteElementModel(files, &model, &error));
  EXPECT_THAT(model.dof_names, ElementsAre("untouched"));
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  return error;
}

struct SampleModel {
  const char* name;
  FiniteElementFiles files;
  bool has_names;
};

void PrintTo(const SampleModel& sample, std::ostream* stream) {
  *stream << sample.name;
}

std::vector<SampleModel> SampleModels() {
  const auto mm = [](const std::string& name) {
    return MatrixSource{Sample("matrix_market/" + name), ""};
  };
  std::vector<SampleModel> models = {
      {"MatrixMarket", Files(mm("M.mtx"), mm("K.mtx")), false},
      {"MatrixMarketGeneral", Files(mm("M.mtx"), mm("K_general.mtx")), false},
      {"MatrixMarketArrayWithNames",
       Files(mm("M.mtx"), mm("K_array.mtx"), Sample("calculix/beam.dof")),
       true},
      {"CalculiX",
       Files({Sample("calculix/beam.mas"), ""},
             {Sample("calculix/beam.sti"), ""}),
       true},
      {"Abaqus",
       Files({Sample("abaqus/beam_MASS2.mtx"), ""},
             {Sample("abaqus/beam_STIF2.mtx"), ""}),
       true},
      {"AbaqusFull",
       Files({Sample("abaqus/beam_MASS2.mtx"), ""},
             {Sample("abaqus/beam_full_STIF2.mtx"), ""}),
       true},
      {"MatSparse", OneFile(Sample("mat/sparse.mat"), true), true},
      {"MatCompressed", OneFile(Sample("mat/compressed.mat"), true), true},
      {"MatFullAndPairs", OneFile(Sample("mat/full.mat"), false), true},
      {"MatCharacterRows", OneFile(Sample("mat/char.mat"), false), true},
      {"NpzFull", OneFile(Sample("npz/full.npz"), true), true},
      {"NpzTypesAndPairs", OneFile(Sample("npz/types.npz"), false), true},
      {"NpzParts", OneFile(Sample("npz/parts.npz"), false), true},
      {"NpzCsr",
       Files({Sample("npz/M_csr.npz"), ""}, {Sample("npz/K_csr.npz"), ""}),
       false},
      {"NpzCsc",
       Files({Sample("npz/M_csr.npz"), ""}, {Sample("npz/K_csc.npz"), ""}),
       false},
      {"NpzCoo",
       Files({Sample("npz/full.npz"), "m"}, {Sample("npz/K_coo.npz"), ""}),
       true}};
  static const char* const kOp4[] = {
      "ascii_dense",      "ascii_sparse",     "ascii_bigmat",
      "little_32_dense",  "little_32_sparse", "little_32_bigmat",
      "little_64_dense",  "little_64_sparse", "little_64_bigmat",
      "big_32_dense",     "big_32_sparse",    "big_32_bigmat",
      "big_64_dense",     "big_64_sparse",    "big_64_bigmat",
      "little_32_marker", "little_64_marker", "big_32_marker",
      "big_64_marker"};
  for (const char* name : kOp4) {
    models.push_back(
        {name, OneFile(Sample("op4/" + std::string(name) + ".op4"), true),
         false});
  }
  return models;
}

class SampleModelTest : public ::testing::TestWithParam<SampleModel> {};

TEST_P(SampleModelTest, IsReadAndComesBackFromMatrixMarket) {
  const SampleModel& sample = GetParam();
  const FiniteElementModel model = ReadOrFail(sample.files);
  ASSERT_EQ(model.num_dofs(), 4);
  EXPECT_EQ(Matrix(model.mass), ExpectedMass());
  EXPECT_EQ(Matrix(model.stiffness), ExpectedStiffness());
  EXPECT_EQ(model.has_damping(), !sample.files.damping.path.empty());
  if (model.has_damping()) {
    const Matrix expected = 0.01 * ExpectedStiffness() + 0.5 * ExpectedMass();
    EXPECT_LT((Matrix(model.damping) - expected).cwiseAbs().maxCoeff(), 1e-10);
  }
  if (sample.has_names) {
    EXPECT_THAT(model.dof_names, ElementsAre("1.1", "2.1", "2.6", "3.1"));
  } else {
    EXPECT_THAT(model.dof_names, ElementsAre("u1", "u2", "u3", "u4"));
  }
  EXPECT_THAT(model.notes, ElementsAre(StartsWith("1 DOF without mass (")));

  TemporaryFolder folder;
  const auto written = [&folder](const char* name, const SparseMatrix& matrix) {
    std::string error;
    EXPECT_TRUE(WriteMatrixMarket(folder.Path(name), matrix, &error)) << error;
    SparseMatrix back;
    EXPECT_TRUE(ReadMatrixMarket(folder.Path(name), &back, &error)) << error;
    EXPECT_EQ(back.nonZeros(), matrix.nonZeros());
    EXPECT_EQ(Matrix(back), Matrix(matrix));
    EXPECT_THAT(FileContent(folder.Path(name)), HasSubstr("real symmetric"));
  };
  written("M.mtx", model.mass);
  written("K.mtx", model.stiffness);
  if (model.has_damping()) written("C.mtx", model.damping);
}

INSTANTIATE_TEST_SUITE_P(All, SampleModelTest,
                         ::testing::ValuesIn(SampleModels()),
                         [](const auto& test) { return test.param.name; });

// Zeros that a file states are part of its sparsity.
TEST(WriteSparseMatrixMarket, KeepsStatedZeros) {
  TemporaryFolder folder;
  const std::string content =
      "%%MatrixMarket matrix coordinate real symmetric\n3 3 4\n1 1 2\n2 1 0\n"
      "2 2 0.1\n3 3 0\n";
  SparseMatrix matrix;
  std::string error;
  ASSERT_TRUE(
      ReadMatrixMarket(folder.Write("K.mtx", content), &matrix, &error));
  EXPECT_EQ(matrix.nonZeros(), 5);
  ASSERT_TRUE(WriteMatrixMarket(folder.Path("L.mtx"), matrix, &error));
  SparseMatrix back;
  ASSERT_TRUE(ReadMatrixMarket(folder.Path("L.mtx"), &back, &error));
  EXPECT_EQ(back.nonZeros(), 5);
  EXPECT_EQ(Matrix(back), Matrix(matrix));
}

TEST(ReadFiniteElementModel, SinglePrecisionOp4) {
  for (const char* name : {"op4/single.op4", "op4/single_64.op4"}) {
    const FiniteElementModel model = ReadOrFail(
        Files({Sample(name), ""}, {Sample("op4/ascii_dense.op4"), "KGG"}));
    EXPECT_EQ(Matrix(model.mass), ExpectedMass());
  }
}

// A word of 64 bits holds four characters of a name and four blanks.
TEST(ReadFiniteElementModel, LongNamesOfOp4WithLongWords) {
  for (const char* name : {"op4/little_64_names.op4", "op4/big_64_names.op4"}) {
    const std::string path = Sample(name);
    ASSERT_THAT(FileContent(path), HasSubstr("MGGE    XT      "));
    const FiniteElementModel model =
        ReadOrFail(Files({path, "MGGEXT"}, {path, "kggext"}));
    EXPECT_EQ(Matrix(model.mass), ExpectedMass());
    EXPECT_EQ(Matrix(model.stiffness), ExpectedStiffness());
    EXPECT_THAT(ErrorOf(Files({path, "MGG"}, {path, "KGGEXT"})),
                HasSubstr("mggext, bggext, kggext"));
  }
}

// MATLAB's version 7.3 is HDF5; matio writes it as MATLAB does.
TEST(ReadFiniteElementModel, Mat73) {
  TemporaryFolder folder;
  const std::string path = folder.Path("model.mat");
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT73);
  ASSERT_NE(file, nullptr);
  size_t dims[] = {4, 4};
  Matrix mass = ExpectedMass();
  matvar_t* full = Mat_VarCreate("M", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims,
                                 mass.data(), MAT_F_DONT_COPY_DATA);
  ASSERT_EQ(Mat_VarWrite(file, full, MAT_COMPRESSION_NONE), 0);
  Mat_VarFree(full);
  SparseMatrix stiffness = ExpectedStiffness().sparseView();
  stiffness.makeCompressed();
  std::vector<mat_uint32_t> rows(
      stiffness.innerIndexPtr(),
      stiffness.innerIndexPtr() + stiffness.nonZeros());
  std::vector<mat_uint32_t> columns(stiffness.outerIndexPtr(),
                                    stiffness.outerIndexPtr() + 5);
  mat_sparse_t data = {};
  data.nzmax = data.nir = data.ndata =
      static_cast<mat_uint32_t>(stiffness.nonZeros());
  data.ir = rows.data();
  data.jc = columns.data();
  data.njc = 5;
  data.data = stiffness.valuePtr();
  matvar_t* sparse = Mat_VarCreate("K", MAT_C_SPARSE, MAT_T_DOUBLE, 2, dims,
                                   &data, MAT_F_DONT_COPY_DATA);
  ASSERT_EQ(Mat_VarWrite(file, sparse, MAT_COMPRESSION_NONE), 0);
  Mat_VarFree(sparse);
  Mat_Close(file);

  const FiniteElementModel model = ReadOrFail(OneFile(path, false));
  EXPECT_EQ(Matrix(model.mass), ExpectedMass());
  EXPECT_EQ(Matrix(model.stiffness), ExpectedStiffness());

  // Cut anywhere, it is refused, or read whole where only unused bytes go.
  const std::string content = FileContent(path);
  for (const size_t part : {1, 2, 5, 9}) {
    const std::string cut =
        folder.Write("cut.mat", content.substr(0, content.size() * part / 10));
    ErrorOf(OneFile(cut, false));
  }
}

// Structures, cells and text beside the matrices are nobody's business.
TEST(ReadFiniteElementModel, MatrixInAWholeMatlabWorkspace) {
  const FiniteElementModel model =
      ReadOrFail(OneFile(Sample("mat/workspace.mat"), false));
  EXPECT_EQ(Matrix(model.stiffness), ExpectedStiffness());
  EXPECT_EQ(Matrix(model.mass), ExpectedMass());
  EXPECT_EQ(model.dof_names,
            ReadOrFail(OneFile(Sample("mat/sparse.mat"), false)).dof_names);
}

// For each of them matio would allocate what the dimensions say.
TEST(ReadFiniteElementModel, MatlabFilesThatPromiseTooMuchAreRefused) {
  EXPECT_THAT(ErrorOf(OneFile(Sample("mat/found_allocation.mat"), false)),
              HasSubstr("an element of at most 4 bytes has more"));
  EXPECT_THAT(ErrorOf(OneFile(Sample("mat/found_types.mat"), false)),
              HasSubstr("a sparse matrix lacks its indices or numbers"));
  EXPECT_THAT(ErrorOf(OneFile(Sample("mat/found_empty_variable.mat"), false)),
              HasSubstr("an element is no variable"));
  TemporaryFolder folder;
  const std::string content = FileContent(Sample("mat/workspace.mat"));
  // An array begins so; its class (a sparse one's rows cost nothing) and two
  // dimensions follow.
  const std::string flags("\6\0\0\0\10\0\0\0", 8);
  for (const char kind : {'\x01', '\x02', '\x04', '\x05', '\x06'}) {
    size_t at = std::string::npos;
    for (size_t i = content.find(flags);
         i != std::string::npos && at == std::string::npos;
         i = content.find(flags, i + 1)) {
      if (content[i + 8] == kind) at = i;
    }
    ASSERT_NE(at, std::string::npos) << static_cast<int>(kind);
    std::string crafted = content;
    // Two milliard rows.
    crafted.replace(at + 24, 4, "\xff\xff\xff\x7f");
    const std::string error =
        ErrorOf(OneFile(folder.Write("crafted.mat", crafted), false));
    EXPECT_THAT(error, HasSubstr(kind == 5 ? "no matrix" : "dimensions say"));
  }
}

// The frame of data/: compressed exports, internal DOFs, a singular M.
TEST(ReadFiniteElementModel, CompressedCalculixFrame) {
  const std::string folder = std::string(PINODE_SOURCE_DIR) + "/data/frame/";
  const FiniteElementModel model = ReadOrFail(
      Files({folder + "frame.mas.gz", ""}, {folder + "frame.sti.gz", ""}));
  ASSERT_EQ(model.num_dofs(), 1620);
  EXPECT_EQ(model.dof_names[0], "1011.1");
  SparseModes modes;
  std::string error;
  ASSERT_TRUE(
      ComputeLowestModes(model.mass, model.stiffness, 12, &modes, &error))
      << error;
  // As CalculiX prints them, seven digits.
  const nlohmann::json truth =
      nlohmann::json::parse(FileContent(folder + "truth.json"));
  const std::vector<double> hertz = truth["design_frequencies_hz"];
  ASSERT_EQ(hertz.size(), 12u);
  EXPECT_TRUE(CheckExpectedFrequencies(modes, hertz, 1e-6, &error)) << error;
}

TEST(ReadFiniteElementModel, CompressedContainersAreRefused) {
  TemporaryFolder folder;
  const std::string path = folder.Write("model.npz.gz", "");
  FiniteElementModel model;
  std::string error;
  EXPECT_FALSE(
      ReadFiniteElementModel(Files({path, "M"}, {path, "K"}), &model, &error));
  EXPECT_THAT(error, HasSubstr("of compressed files only text"));
}

TEST(ReadFiniteElementModel, CalculixWithoutDofFileCountsIndices) {
  TemporaryFolder folder;
  const std::string stiffness =
      folder.Write("a.sti", FileContent(Sample("calculix/beam.sti")));
  const std::string mass =
      folder.Write("a.mas", FileContent(Sample("calculix/beam.mas")));
  const FiniteElementModel model =
      ReadOrFail(Files({mass, ""}, {stiffness, ""}));
  EXPECT_THAT(model.dof_names, ElementsAre("u1", "u2", "u3", "u4"));
  ASSERT_EQ(model.notes.size(), 2u);
  EXPECT_THAT(model.notes[0], HasSubstr("4 is the largest index"));
}

TEST(ReadFiniteElementModel, RepeatedNamesAreNumbered) {
  TemporaryFolder folder;
  const FiniteElementModel model = ReadOrFail(Files(
      {Sample("calculix/beam.mas"), ""}, {Sample("calculix/beam.sti"), ""},
      folder.Write("names.dof", "1.1\n2.1\n2.1\n3.1\n")));
  EXPECT_THAT(model.dof_names, ElementsAre("1.1", "2.1#1", "2.1#2", "3.1"));
  EXPECT_THAT(model.notes, ElementsAre(HasSubstr("more than once"),
                                       HasSubstr("without mass (2.1#2)")));
}

TEST(ReadFiniteElementModel, RefusesFilesThatDoNotFitEachOther) {
  TemporaryFolder folder;
  const MatrixSource mass = {Sample("calculix/beam.mas"), ""};
  const MatrixSource stiffness = {Sample("calculix/beam.sti"), ""};
  EXPECT_THAT(ErrorOf(Files({}, stiffness)), HasSubstr("no file for the mass"));
  EXPECT_THAT(ErrorOf(Files(mass, {})), HasSubstr("stiffness"));
  // A map of too few and of too many DOFs.
  const std::string few = folder.Write("few.dof", "1.1\n2.1\n2.6\n");
  EXPECT_THAT(ErrorOf(Files(mass, stiffness, few)),
              AllOf(HasSubstr("DOF 4"), HasSubstr("few.dof")));
  const std::string many = folder.Write("many.dof", "1.1\n2.1\n2.6\n3.1\n3.2");
  EXPECT_THAT(ErrorOf(Files(mass, stiffness, many)),
              HasSubstr("without mass and without stiffness (3.2)"));
  EXPECT_THAT(
      ErrorOf(Files({Sample("matrix_market/M.mtx"), ""},
                    {Sample("matrix_market/K.mtx"), ""}, many)),
      AllOf(HasSubstr("4 x 4"), HasSubstr("5 x 5"), HasSubstr("many.dof")));
  const std::string blank = folder.Write("blank.dof", "1.1 2.1\n");
  EXPECT_THAT(ErrorOf(Files(mass, stiffness, blank)),
              AllOf(HasSubstr("blank.dof:1: "), HasSubstr("one DOF")));
  // Names here, positions there.
  EXPECT_THAT(ErrorOf(Files(mass, {Sample("abaqus/beam_STIF2.mtx"), ""})),
              HasSubstr("files of one kind"));
  EXPECT_THAT(ErrorOf(Files({Sample("abaqus/beam_MASS2.mtx"), ""},
                            {Sample("abaqus/beam_STIF2.mtx"), ""}, many)),
              HasSubstr("name their DOFs themselves"));
  EXPECT_THAT(ErrorOf(Files(mass, {"K.xlsx", ""})), HasSubstr(".op4"));
  EXPECT_THAT(ErrorOf(Files(mass, {stiffness.path, "KGG"})),
              HasSubstr("holds only one"));
  // A lower triangle that calls itself general.
  EXPECT_THAT(
      ErrorOf(Files({folder.Write("M.mtx",
                                  "%%MatrixMarket matrix coordinate real "
                                  "general\n2 2 3\n1 1 1\n2 1 0.1\n2 2 1\n"),
                     ""},
                    {folder.Write("K.mtx",
                                  "%%MatrixMarket matrix coordinate real "
                                  "general\n2 2 2\n1 1 1\n2 2 1\n"),
                     ""})),
      HasSubstr("M is not symmetric"));
}

TEST(ReadFiniteElementModel, FindsMatricesByName) {
  const std::string op4 = Sample("op4/ascii_dense.op4");
  const std::string npz = Sample("npz/full.npz");
  FiniteElementFiles files = Files({op4, "mgg"}, {op4, "KGG"});
  EXPECT_EQ(Matrix(ReadOrFail(files).stiffness), ExpectedStiffness());
  files.stiffness.variable = "KAA";
  EXPECT_THAT(ErrorOf(files),
              AllOf(HasSubstr("'KAA'"), HasSubstr("mgg, bgg, kgg")));
  // One file of one matrix cannot be both.
  const std::string one = Sample("npz/K_csr.npz");
  EXPECT_THAT(ErrorOf(OneFile(one, false)), HasSubstr("usual name"));
  EXPECT_THAT(ErrorOf(Files({npz, ""}, {Sample("npz/complex.npz"), "K"})),
              HasSubstr("not of a real type"));
}

// A file of superelements has several matrices of one name.
TEST(ReadFiniteElementModel, FindsMatricesByTheirOccurrence) {
  TemporaryFolder folder;
  const std::string first = FileContent(Sample("op4/ascii_dense.op4"));
  // In the second the stiffness ends with another number.
  const std::string last = " 1.0000000000000000E+06\n";
  std::string second = first;
  second.replace(second.rfind(last), last.size(), " 3.0000000000000000E+06\n");
  const std::string path = folder.Write("a.op4", first + second);
  FiniteElementFiles files = Files({path, "mgg"}, {path, "kgg"});
  EXPECT_THAT(ErrorOf(files), HasSubstr("'mgg' occurs 2 times, and "
                                        "occurrence = 1 to 2"));
  files.mass.occurrence = 1;
  files.stiffness.occurrence = 1;
  EXPECT_EQ(Matrix(ReadOrFail(files).stiffness), ExpectedStiffness());
  files.stiffness.occurrence = 2;
  Matrix other = ExpectedStiffness();
  other(3, 3) = 3e6;
  EXPECT_EQ(Matrix(ReadOrFail(files).stiffness), other);
  files.stiffness.occurrence = 3;
  EXPECT_THAT(ErrorOf(files), HasSubstr("occurrence = 3 is beyond that"));
}

// What is wrong with a text, by format.
struct BadText {
  const char* name;
  // Takes the place of the stiffness.
  const char* file;
  const char* content;
  int line;
  const char* message;
};

void PrintTo(const BadText& bad, std::ostream* stream) { *stream << bad.name; }

class BadTextTest : public ::testing::TestWithParam<BadText> {};

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

// Every prefix of a file is refused or gives the whole model (where the end
// holds nothing that matters); never a crash, never a different model.
TEST(ReadFiniteElementModel, TruncatedFilesAreRefused) {
  TemporaryFolder folder;
  struct Truncated {
    const char* name;
    bool damped;
    // Bytes at the end that may be missing: what ends the last matrix of an
    // OP4 file, a variable behind those that are asked for.
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

TEST(ReadFiniteElementModel, BadOp4IsRefused) {
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

TEST(ReadFiniteElementModel, BadBinaryOp4IsRefused) {
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
  EXPECT_THAT(error_with_byte(28, 25), HasSubstr("24 was expected as before"));
  // The first column's record: length, column, 0, words, string header.
  EXPECT_THAT(error_with_byte(35, 0x7f), HasSubstr("is the file whole"));
  EXPECT_THAT(error_with_byte(44, 100), HasSubstr("at most 5 words"));
  EXPECT_THAT(error_with_byte(48, 9), HasSubstr("from row 9"));
  EXPECT_THAT(error_with_byte(50, 100), HasSubstr("header of a string"));
}

// The same where lengths, integers and names take 8 bytes a word.
TEST(ReadFiniteElementModel, BadLongBinaryOp4IsRefused) {
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
              HasSubstr("48 was expected as before"));
  EXPECT_THAT(error_with_byte(short_marker, 83, '\x80'),
              HasSubstr("at most 3 words"));
  EXPECT_THAT(error_with_byte(short_marker, 84, 9), HasSubstr("from row 9"));
  EXPECT_THAT(error_with_byte(short_marker, 91, '\x80'),
              HasSubstr("header of a string"));
  // Lengths of 8 bytes: columns from 8, the length again at 56, the next one
  // at 64.
  const char* const long_marker = "op4/little_64_marker.op4";
  EXPECT_THAT(error_with_byte(long_marker, 63, 1),
              HasSubstr("48 was expected as before"));
  EXPECT_THAT(error_with_byte(long_marker, 71, 0x7f),
              HasSubstr("is the file whole"));
  EXPECT_THAT(error_with_byte(long_marker, 71, '\x80'),
              HasSubstr("is the file whole"));
}

TEST(ReadFiniteElementModel, BadNpzIsRefused) {
  TemporaryFolder folder;
  EXPECT_THAT(ErrorOf(OneFile(folder.Write("a.npz", "PK"), false)),
              HasSubstr("NumPy archive"));
  EXPECT_THAT(ErrorOf(OneFile(Sample("npz/types.npz"), true)),
              HasSubstr("usual name of the damping matrix"));
  // An absurd shape in the header of the first array, stored uncompressed.
  const std::string content = FileContent(Sample("npz/full.npz"));
  for (const char* shape : {"(4, 5)", "(9, 4)", "(4, x)", "[4, 4]"}) {
    SCOPED_TRACE(shape);
    // The checksum of the archive notices, or the header does.
    EXPECT_THAT(
        ErrorOf(OneFile(
            folder.Write("a.npz", Replaced(content, "(4, 4)", shape)), false)),
        HasSubstr("a.npz: array "));
  }
}

// Pairs of matrices from public collections, with eigenvalues computed by
// another program.
class MeasuredModelsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("PINODE_MEASURED_DATA");
    folder_ = (folder != nullptr
                   ? fs::path(folder)
                   : fs::path(PINODE_SOURCE_DIR) / ".." / "shared" / "data") /
              "matrices";
    if (!fs::exists(folder_)) {
      GTEST_SKIP() << "no measured data; set PINODE_MEASURED_DATA to the "
                      "folder that holds 'matrices'";
    }
  }

  MatrixSource Source(const std::string& name) const {
    return {(folder_ / name).string(), ""};
  }

  fs::path folder_;
};

TEST_F(MeasuredModelsTest, LowestEigenvaluesAgreeWithTheReference) {
  nlohmann::json reference;
  std::ifstream(folder_ / "reference_eigenvalues.json") >> reference;
  for (const auto& [stiffness, mass, massless] :
       {std::tuple("bcsstk01", "bcsstm01", 24),
        std::tuple("bcsstk02", "bcsstm02", 0),
        std::tuple("lunda", "lundb", 0)}) {
    const std::string key = std::string(stiffness) + "/" + mass;
    SCOPED_TRACE(key);
    const FiniteElementModel model =
        ReadOrFail(Files(Source(std::string(mass) + ".mtx"),
                         Source(std::string(stiffness) + ".mtx")));
    EXPECT_EQ(FindSpecialDofs(model).massless.size(),
              static_cast<size_t>(massless));
    SparseModes modes;
    std::string error;
    ASSERT_TRUE(
        ComputeLowestModes(model.mass, model.stiffness, 10, &modes, &error))
        << error;
    const auto expected =
        reference.at(key).at("lowest_eigenvalues").get<std::vector<double>>();
    ASSERT_EQ(expected.size(), 10u);
    double worst = 0.0;
    for (Eigen::Index i = 0; i < 10; ++i) {
      const double wanted = expected[static_cast<size_t>(i)];
      EXPECT_NEAR(modes.eigenvalues[i], wanted, 1e-6 * wanted);
      worst = std::max(worst, std::abs(modes.eigenvalues[i] / wanted - 1.0));
    }
    RecordProperty(key, std::to_string(worst));
    std::printf("%s: worst relative difference %.2g\n", key.c_str(), worst);
  }
}

TEST_F(MeasuredModelsTest, AllModesOfBcsstk01) {
  const FiniteElementModel model =
      ReadOrFail(Files(Source("bcsstm01.mtx"), Source("bcsstk01.mtx")));
  SparseModes modes;
  std::string error;
  ASSERT_TRUE(
      ComputeLowestModes(model.mass, model.stiffness, 48, &modes, &error))
      << error;
  EXPECT_EQ(modes.eigenvalues.size(), 24);
  EXPECT_THAT(modes.notes, ElementsAre(HasSubstr("24 modes, 48 were asked")));
}

TEST_F(MeasuredModelsTest, CalculixCantilever) {
  const FiniteElementModel model = ReadOrFail(Files(
      Source("ccx_cantilever/cantm.mas"), Source("ccx_cantilever/cantm.sti")));
  ASSERT_EQ(model.num_dofs(), 288);
  EXPECT_EQ(model.dof_names[0], "2.1");
  EXPECT_EQ(model.dof_names[287], "104.3");
  EXPECT_THAT(model.notes, ElementsAre());
  SparseModes modes;
  std::string error;
  ASSERT_TRUE(
      ComputeLowestModes(model.mass, model.stiffness, 10, &modes, &error))
      << error;
  // The table of eigenvalues in CalculiX's own output, seven digits.
  std::ifstream output(folder_ / "ccx_cantilever" / "cant.dat");
  std::string line;
  double worst = 0.0;
  int compared = 0;
  while (compared < 10 && std::getline(output, line)) {
    std::istringstream words(line);
    int mode = 0;
    double eigenvalue = 0.0;
    if (!(words >> mode >> eigenvalue) || mode != compared + 1) continue;
    const double found = modes.eigenvalues[compared];
    EXPECT_NEAR(found, eigenvalue, 1e-6 * eigenvalue) << "mode " << mode;
    worst = std::max(worst, std::abs(found / eigenvalue - 1.0));
    ++compared;
  }
  EXPECT_EQ(compared, 10);
  std::printf("CalculiX cantilever: worst relative difference %.2g\n", worst);
  EXPECT_TRUE(CheckExpectedFrequencies(
      modes, {17.0420, 42.2637, 108.090, 263.467, 309.589, 559.969}, 1e-5,
      &error))
      << error;
}

}  // namespace
}  // namespace pinode
