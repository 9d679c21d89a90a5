#include "pinode/base/arrays/matlab_writer.h"

#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/arrays/array_files.h"
#include "pinode/base/arrays/matlab_file.h"
#include "tests/support/temporary_folder_testing.h"

// tests/programs/mat_test.sh reads the written file with SciPy.

namespace pinode {
namespace {

TEST(MatlabWriterTest, NumbersComeBack) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("a.mat");
  Matrix matrix(2, 3);
  matrix << 1, 2, 3, 4, std::nan(""), 6e300;
  MatlabWriter writer(path);
  writer.AddMatrix("M", matrix);
  writer.AddStructure("table", {{"t", Vector::LinSpaced(5, 0.0, 1.0), {}},
                                {"a 1", Vector::Constant(5, 7.0), {}},
                                {"name", {}, {"x", "", "y", "\xC3\xA4", "z"}}});
  std::string error;
  ASSERT_TRUE(writer.Close(&error)) << error;

  std::vector<NamedArray> arrays;
  ASSERT_TRUE(ReadArrayFile(
      path, [](const std::string&) { return true; }, &arrays, &error))
      << error;
  bool seen_matrix = false, seen_field = false;
  for (const NamedArray& array : arrays) {
    if (array.name == "M") {
      seen_matrix = true;
      // Samples along the longer dimension.
      ASSERT_EQ(array.values.rows(), 3);
      EXPECT_EQ(array.values(2, 1), 6e300);
      EXPECT_TRUE(std::isnan(array.values(1, 1)));
    }
    if (array.name == "table.a_1") {
      seen_field = true;
      EXPECT_EQ(array.values.rows(), 5);
      EXPECT_EQ(array.values(4, 0), 7.0);
    }
  }
  EXPECT_TRUE(seen_matrix);
  EXPECT_TRUE(seen_field);
}

TEST(MatlabWriterTest, SparseMatricesAndTextsComeBack) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("a.mat");
  Eigen::SparseMatrix<double> sparse(4, 3);
  sparse.insert(3, 0) = 1.5;
  sparse.insert(0, 2) = -2.0;
  MatlabWriter writer(path);
  writer.AddSparse("K", sparse);
  writer.AddText("json", "{\"unit\": \"\xC2\xB5m\"}");
  writer.AddText("nothing", "");
  std::string error;
  ASSERT_TRUE(writer.Close(&error)) << error;

  MatlabFile file;
  ASSERT_TRUE(file.Open(path, &error)) << error;
  MatlabVariable k = file.Next();
  ASSERT_NE(k, nullptr);
  ASSERT_TRUE(file.ReadData(k.get()));
  ASSERT_EQ(k->class_type, MAT_C_SPARSE);
  EXPECT_EQ(k->dims[0], 4u);
  EXPECT_EQ(k->dims[1], 3u);
  const auto* read = static_cast<const mat_sparse_t*>(k->data);
  ASSERT_EQ(read->ndata, 2u);
  EXPECT_EQ(read->ir[0], 3u);
  EXPECT_EQ(read->ir[1], 0u);
  EXPECT_EQ(static_cast<const double*>(read->data)[1], -2.0);
  MatlabVariable text = file.Next();
  ASSERT_NE(text, nullptr);
  EXPECT_EQ(text->class_type, MAT_C_CHAR);
  EXPECT_EQ(text->dims[1], 14u);  // characters, not bytes
}

TEST(MatlabWriterTest, AllOrNothing) {
  const TemporaryFolder folder;
  const std::string path = folder.Path("a.mat");
  folder.Write("a.mat", "before");
  std::string error;
  {
    // Nothing is written without Close.
    MatlabWriter writer(path);
    writer.AddMatrix("M", Matrix::Random(100, 100));
  }
  EXPECT_EQ(folder.Read("a.mat"), "before");
  // No file may be longer than 4 kB, not even in memory.
  struct rlimit before, limit;
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  limit = before;
  limit.rlim_cur = 4096;
  const auto signal_before = std::signal(SIGXFSZ, SIG_IGN);
  MatlabWriter writer(path);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  writer.AddMatrix("M", Matrix::Random(100, 100));
  EXPECT_FALSE(writer.Close(&error));
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, signal_before);
  EXPECT_THAT(error, ::testing::HasSubstr("a.mat: cannot be written"));
  EXPECT_EQ(folder.Read("a.mat"), "before");
}

TEST(MatlabWriterTest, NamesAreValidAndDifferent) {
  std::vector<std::string> taken;
  EXPECT_EQ(MatlabName("a.b c", &taken), "a_b_c");
  EXPECT_EQ(MatlabName("a b.c", &taken), "a_b_c_2");
  EXPECT_EQ(MatlabName("1st", &taken), "x1st");
  EXPECT_EQ(MatlabName("", &taken), "x");
  EXPECT_EQ(MatlabName(std::string(90, 'k'), &taken).size(), 63u);
  EXPECT_EQ(MatlabName(std::string(90, 'k'), &taken).size(), 63u);
  EXPECT_NE(taken[4], taken[5]);
}

TEST(MatlabWriterTest, AFolderThatIsNotThereIsALine) {
  MatlabWriter writer("/nowhere/at/all.mat");
  writer.AddText("a", "b");
  std::string error;
  EXPECT_FALSE(writer.Close(&error));
  EXPECT_THAT(error, ::testing::HasSubstr("/nowhere/at/all.mat"));
}

TEST(MatlabWriterTest, KnowsWhatAFileOfVersion5CannotHold) {
  EXPECT_TRUE(FitsMatlabFile(0));
  EXPECT_TRUE(FitsMatlabFile(Eigen::Index{8} * 250000000));
  EXPECT_FALSE(FitsMatlabFile(Eigen::Index{8} * 300000000));
  // In 32 bits this size would wrap to one byte.
  EXPECT_FALSE(FitsMatlabFile((Eigen::Index{1} << 32) + 1));
}

}  // namespace
}  // namespace pinode
