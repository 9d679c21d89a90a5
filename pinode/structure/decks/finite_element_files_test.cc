#include "pinode/structure/decks/finite_element_files.h"

#include <matio.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/structure/matrices/matrix_market.h"
#include "pinode/structure/sparse/sparse_modes.h"
#include "tests/support/finite_element_files_testing.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

namespace fs = std::filesystem;

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
    return MatrixSource{FiniteElementFilesTest::Sample("matrix_market/" + name),
                        ""};
  };
  std::vector<SampleModel> models = {
      {"MatrixMarket", FiniteElementFilesTest::Files(mm("M.mtx"), mm("K.mtx")),
       false},
      {"MatrixMarketGeneral",
       FiniteElementFilesTest::Files(mm("M.mtx"), mm("K_general.mtx")), false},
      {"MatrixMarketArrayWithNames",
       FiniteElementFilesTest::Files(
           mm("M.mtx"), mm("K_array.mtx"),
           FiniteElementFilesTest::Sample("calculix/beam.dof")),
       true},
      {"CalculiX",
       FiniteElementFilesTest::Files(
           {FiniteElementFilesTest::Sample("calculix/beam.mas"), ""},
           {FiniteElementFilesTest::Sample("calculix/beam.sti"), ""}),
       true},
      {"Abaqus",
       FiniteElementFilesTest::Files(
           {FiniteElementFilesTest::Sample("abaqus/beam_MASS2.mtx"), ""},
           {FiniteElementFilesTest::Sample("abaqus/beam_STIF2.mtx"), ""}),
       true},
      {"AbaqusFull",
       FiniteElementFilesTest::Files(
           {FiniteElementFilesTest::Sample("abaqus/beam_MASS2.mtx"), ""},
           {FiniteElementFilesTest::Sample("abaqus/beam_full_STIF2.mtx"), ""}),
       true},
      {"MatSparse",
       FiniteElementFilesTest::OneFile(
           FiniteElementFilesTest::Sample("mat/sparse.mat"), true),
       true},
      {"MatCompressed",
       FiniteElementFilesTest::OneFile(
           FiniteElementFilesTest::Sample("mat/compressed.mat"), true),
       true},
      {"MatFullAndPairs",
       FiniteElementFilesTest::OneFile(
           FiniteElementFilesTest::Sample("mat/full.mat"), false),
       true},
      {"MatCharacterRows",
       FiniteElementFilesTest::OneFile(
           FiniteElementFilesTest::Sample("mat/char.mat"), false),
       true},
      {"NpzFull",
       FiniteElementFilesTest::OneFile(
           FiniteElementFilesTest::Sample("npz/full.npz"), true),
       true},
      {"NpzTypesAndPairs",
       FiniteElementFilesTest::OneFile(
           FiniteElementFilesTest::Sample("npz/types.npz"), false),
       true},
      {"NpzParts",
       FiniteElementFilesTest::OneFile(
           FiniteElementFilesTest::Sample("npz/parts.npz"), false),
       true},
      {"NpzCsr",
       FiniteElementFilesTest::Files(
           {FiniteElementFilesTest::Sample("npz/M_csr.npz"), ""},
           {FiniteElementFilesTest::Sample("npz/K_csr.npz"), ""}),
       false},
      {"NpzCsc",
       FiniteElementFilesTest::Files(
           {FiniteElementFilesTest::Sample("npz/M_csr.npz"), ""},
           {FiniteElementFilesTest::Sample("npz/K_csc.npz"), ""}),
       false},
      {"NpzCoo",
       FiniteElementFilesTest::Files(
           {FiniteElementFilesTest::Sample("npz/full.npz"), "m"},
           {FiniteElementFilesTest::Sample("npz/K_coo.npz"), ""}),
       true}};
  const auto at = [](const std::string& name) {
    return MatrixSource{FiniteElementFilesTest::Sample(name), ""};
  };
  models.push_back(
      {"HarwellBoeing",
       FiniteElementFilesTest::Files(at("harwell_boeing/M_general.hb"),
                                     at("harwell_boeing/K_general.hb")),
       false});
  models.push_back(
      {"HarwellBoeingWithMapping",
       FiniteElementFilesTest::Files(at("harwell_boeing/M.matrix"),
                                     at("harwell_boeing/K.matrix")),
       true});
  for (const char* name : {"wide.pch", "narrow.dmig", "free.pch"}) {
    const std::string path = "dmig/" + std::string(name);
    models.push_back({std::string(name) == "wide.pch"      ? "DmigWide"
                      : std::string(name) == "narrow.dmig" ? "DmigNarrow"
                                                           : "DmigFree",
                      FiniteElementFilesTest::Files(at(path), at(path)), true});
  }
  static const char* const kOp4[] = {
      "ascii_dense",      "ascii_sparse",     "ascii_bigmat",
      "little_32_dense",  "little_32_sparse", "little_32_bigmat",
      "little_64_dense",  "little_64_sparse", "little_64_bigmat",
      "big_32_dense",     "big_32_sparse",    "big_32_bigmat",
      "big_64_dense",     "big_64_sparse",    "big_64_bigmat",
      "little_32_marker", "little_64_marker", "big_32_marker",
      "big_64_marker"};
  for (const char* name : kOp4) {
    models.push_back({name,
                      FiniteElementFilesTest::OneFile(
                          FiniteElementFilesTest::Sample(
                              "op4/" + std::string(name) + ".op4"),
                          true),
                      false});
  }
  return models;
}

class SampleModelTest : public FiniteElementFilesTest,
                        public ::testing::WithParamInterface<SampleModel> {};

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

// Rows of K must not get names from a mapping that another job has written.
TEST_F(FiniteElementFilesTest, MappingsBesideTheMatricesAgree) {
  TemporaryFolder folder;
  for (const char* name : {"K.matrix", "M.matrix", "K.mapping"}) {
    folder.Write(name,
                 FileContent(Sample("harwell_boeing/" + std::string(name))));
  }
  const FiniteElementFiles files =
      Files({folder.Path("M.matrix"), ""}, {folder.Path("K.matrix"), ""});
  const std::string mapping = FileContent(Sample("harwell_boeing/K.mapping"));
  folder.Write("M.mapping", mapping);
  EXPECT_THAT(ReadOrFail(files).dof_names,
              ElementsAre("1.1", "2.1", "2.6", "3.1"));
  std::string other = mapping;
  other.replace(other.find("ROTZ"), 4, "ROTY");
  folder.Write("M.mapping", other);
  EXPECT_THAT(ErrorOf(files), HasSubstr("expected files of one job"));
}

// Explicit zeros of a file are part of its sparsity.
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

TEST_F(FiniteElementFilesTest, SinglePrecisionOp4) {
  for (const char* name : {"op4/single.op4", "op4/single_64.op4"}) {
    const FiniteElementModel model = ReadOrFail(
        Files({Sample(name), ""}, {Sample("op4/ascii_dense.op4"), "KGG"}));
    EXPECT_EQ(Matrix(model.mass), ExpectedMass());
  }
}

// A word of 64 bits holds four characters of a name and four blanks.
TEST_F(FiniteElementFilesTest, LongNamesOfOp4WithLongWords) {
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
TEST_F(FiniteElementFilesTest, Mat73) {
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

  // A file cut at any place is refused, or read completely if only unused bytes
  // are missing.
  const std::string content = FileContent(path);
  for (const size_t part : {1, 2, 5, 9}) {
    const std::string cut =
        folder.Write("cut.mat", content.substr(0, content.size() * part / 10));
    ErrorOf(OneFile(cut, false));
  }
}

// Structures, cells and text beside the matrices are ignored.
TEST_F(FiniteElementFilesTest, MatrixInAWholeMatlabWorkspace) {
  const FiniteElementModel model =
      ReadOrFail(OneFile(Sample("mat/workspace.mat"), false));
  EXPECT_EQ(Matrix(model.stiffness), ExpectedStiffness());
  EXPECT_EQ(Matrix(model.mass), ExpectedMass());
  EXPECT_EQ(model.dof_names,
            ReadOrFail(OneFile(Sample("mat/sparse.mat"), false)).dof_names);
}

// For each of them matio would allocate the announced dimensions.
TEST_F(FiniteElementFilesTest, MatlabFilesThatPromiseTooMuchAreRefused) {
  EXPECT_THAT(ErrorOf(OneFile(Sample("mat/found_allocation.mat"), false)),
              HasSubstr("an element of at most 4 bytes has more"));
  EXPECT_THAT(ErrorOf(OneFile(Sample("mat/found_types.mat"), false)),
              HasSubstr("a sparse matrix lacks its indices or numbers"));
  EXPECT_THAT(ErrorOf(OneFile(Sample("mat/found_empty_variable.mat"), false)),
              HasSubstr("an element is not a variable"));
  TemporaryFolder folder;
  const std::string content = FileContent(Sample("mat/workspace.mat"));
  // Beginning of an array. Its class (the rows of a sparse one cost nothing)
  // and two dimensions follow.
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
    // Two billion (2e9) rows.
    crafted.replace(at + 24, 4, "\xff\xff\xff\x7f");
    const std::string error =
        ErrorOf(OneFile(folder.Write("crafted.mat", crafted), false));
    EXPECT_THAT(error, HasSubstr(kind == 5 ? "no matrix" : "dimensions say"));
  }
}

// The frame of data/: compressed exports, internal DOFs, a singular M.
TEST_F(FiniteElementFilesTest, CompressedCalculixFrame) {
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
  // Values as CalculiX prints them, with seven digits.
  const nlohmann::json truth =
      nlohmann::json::parse(FileContent(folder + "truth.json"));
  const std::vector<double> hertz = truth["design_frequencies_hz"];
  ASSERT_EQ(hertz.size(), 12u);
  EXPECT_TRUE(CheckExpectedFrequencies(modes, hertz, 1e-6, &error)) << error;
}

TEST_F(FiniteElementFilesTest, CompressedContainersAreRefused) {
  TemporaryFolder folder;
  const std::string path = folder.Write("model.npz.gz", "");
  FiniteElementModel model;
  std::string error;
  EXPECT_FALSE(
      ReadFiniteElementModel(Files({path, "M"}, {path, "K"}), &model, &error));
  EXPECT_THAT(error, HasSubstr("this compressed file is not text"));
}

TEST_F(FiniteElementFilesTest, CalculixWithoutDofFileCountsIndices) {
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

TEST_F(FiniteElementFilesTest, ListedNamesAreRefusedWhereTheyRepeat) {
  FiniteElementFiles files = Files({Sample("calculix/beam.mas"), ""},
                                   {Sample("calculix/beam.sti"), ""});
  files.names = {"1.1", "2.1", "2.1", "3.1"};
  EXPECT_THAT(ErrorOf(files),
              HasSubstr("the list of DOFs has '2.1' at 2 and at 3"));
}

TEST_F(FiniteElementFilesTest, RepeatedNamesAreNumbered) {
  TemporaryFolder folder;
  const FiniteElementModel model = ReadOrFail(Files(
      {Sample("calculix/beam.mas"), ""}, {Sample("calculix/beam.sti"), ""},
      folder.Write("names.dof", "1.1\n2.1\n2.1\n3.1\n")));
  EXPECT_THAT(model.dof_names, ElementsAre("1.1", "2.1#1", "2.1#2", "3.1"));
  EXPECT_THAT(model.notes, ElementsAre(HasSubstr("more than once"),
                                       HasSubstr("without mass (2.1#2)")));
}

TEST_F(FiniteElementFilesTest, RefusesFilesThatDoNotFitEachOther) {
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
  // Names in one file, positions in the other.
  EXPECT_THAT(ErrorOf(Files(mass, {Sample("abaqus/beam_STIF2.mtx"), ""})),
              HasSubstr("files of one kind"));
  EXPECT_THAT(ErrorOf(Files({Sample("abaqus/beam_MASS2.mtx"), ""},
                            {Sample("abaqus/beam_STIF2.mtx"), ""}, many)),
              HasSubstr("name their DOFs themselves"));
  EXPECT_THAT(ErrorOf(Files(mass, {"K.xlsx", ""})), HasSubstr(".op4"));
  EXPECT_THAT(ErrorOf(Files(mass, {stiffness.path, "KGG"})),
              HasSubstr("holds only one"));
  // A lower triangle that is labelled general.
  EXPECT_THAT(
      ErrorOf(Files({folder.Write("M.mtx",
                                  "%%MatrixMarket matrix coordinate real "
                                  "general\n2 2 3\n1 1 1\n2 1 0.1\n2 2 1\n"),
                     ""},
                    {folder.Write("K.mtx",
                                  "%%MatrixMarket matrix coordinate real "
                                  "general\n2 2 2\n1 1 1\n2 2 1\n"),
                     ""})),
      HasSubstr("M.mtx: M is not symmetric"));
}

TEST_F(FiniteElementFilesTest, FindsMatricesByName) {
  const std::string op4 = Sample("op4/ascii_dense.op4");
  const std::string npz = Sample("npz/full.npz");
  FiniteElementFiles files = Files({op4, "mgg"}, {op4, "KGG"});
  EXPECT_EQ(Matrix(ReadOrFail(files).stiffness), ExpectedStiffness());
  files.stiffness.variable = "KAA";
  EXPECT_THAT(ErrorOf(files),
              AllOf(HasSubstr("'KAA'"), HasSubstr("mgg, bgg, kgg")));
  // A file of one matrix cannot be two matrices.
  const std::string one = Sample("npz/K_csr.npz");
  EXPECT_THAT(ErrorOf(OneFile(one, false)), HasSubstr("usual name"));
  EXPECT_THAT(ErrorOf(Files({npz, ""}, {Sample("npz/complex.npz"), "K"})),
              HasSubstr("not of a real type"));
}

// A file of superelements has several matrices of one name.
TEST_F(FiniteElementFilesTest, FindsMatricesByTheirOccurrence) {
  TemporaryFolder folder;
  const std::string first = FileContent(Sample("op4/ascii_dense.op4"));
  // In the second file the stiffness ends with another number.
  const std::string last = " 1.0000000000000000E+06\n";
  std::string second = first;
  second.replace(second.rfind(last), last.size(), " 3.0000000000000000E+06\n");
  const std::string path = folder.Write("a.op4", first + second);
  FiniteElementFiles files = Files({path, "mgg"}, {path, "kgg"});
  EXPECT_THAT(ErrorOf(files),
              HasSubstr("'mgg' occurs 2 times, expected occurrence = 1 to 2"));
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

}  // namespace
}  // namespace pinode
