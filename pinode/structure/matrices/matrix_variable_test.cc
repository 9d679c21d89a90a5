#include "pinode/structure/matrices/matrix_variable.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "pinode/base/arrays/matlab_writer.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class MatrixVariableTest : public ::testing::Test {
 protected:
  MatrixVariableTest() : path_(folder_.Path("model.mat")) {
    mass_ << 2.0, 0.0, 0.0, 1.0;
    stiffness_ << 3.0, -1.0, -1.0, 1.0;
    MatlabWriter writer(path_);
    writer.AddMatrix("M", mass_);
    writer.AddSparse("K", stiffness_.sparseView());
    writer.AddText("note", "two masses");
    std::string error;
    EXPECT_TRUE(writer.Close(&error)) << error;
  }

  std::string ErrorOf(const std::string& path, const std::string& variable) {
    Matrix matrix = mass_;
    std::string error;
    EXPECT_FALSE(ReadMatrixVariable(path, variable, &matrix, &error));
    EXPECT_EQ(matrix, mass_);
    EXPECT_THAT(error, StartsWith(path));
    return error;
  }

  TemporaryFolder folder_;
  std::string path_;
  Matrix mass_{2, 2};
  Matrix stiffness_{2, 2};
};

TEST_F(MatrixVariableTest, IsFoundByName) {
  Matrix matrix;
  std::string error;
  ASSERT_TRUE(ReadMatrixVariable(path_, "M", &matrix, &error)) << error;
  EXPECT_EQ(matrix, mass_);
  ASSERT_TRUE(ReadMatrixVariable(path_, "k", &matrix, &error)) << error;
  EXPECT_EQ(matrix, stiffness_);
  const std::string alone = folder_.Path("alone.mat");
  MatlabWriter writer(alone);
  writer.AddMatrix("whatever", mass_);
  ASSERT_TRUE(writer.Close(&error)) << error;
  ASSERT_TRUE(ReadMatrixVariable(alone, "", &matrix, &error)) << error;
  EXPECT_EQ(matrix, mass_);
}

// MATLAB distinguishes M from m.
TEST_F(MatrixVariableTest, ExactNamesComeFirst) {
  const std::string both = folder_.Path("both.mat");
  MatlabWriter writer(both);
  writer.AddMatrix("m", 2.0 * mass_);
  writer.AddMatrix("M", mass_);
  std::string error;
  ASSERT_TRUE(writer.Close(&error)) << error;
  Matrix matrix;
  ASSERT_TRUE(ReadMatrixVariable(both, "M", &matrix, &error)) << error;
  EXPECT_EQ(matrix, mass_);
  ASSERT_TRUE(ReadMatrixVariable(both, "m", &matrix, &error)) << error;
  EXPECT_EQ(matrix, 2.0 * mass_);
}

TEST_F(MatrixVariableTest, RefusesInOneLine) {
  EXPECT_THAT(ErrorOf(path_, "C"),
              HasSubstr("no matrix 'C', expected 'variable' with one of 'M', "
                        "'K'"));
  EXPECT_THAT(ErrorOf(path_, ""), HasSubstr("2 matrices, expected 'variable'"));
  EXPECT_THAT(ErrorOf(folder_.Path("none.mat"), "M"), HasSubstr("none.mat"));
  EXPECT_THAT(ErrorOf(folder_.Write("text.npz", "no archive"), "M"),
              HasSubstr("text.npz"));
}

TEST(MatrixVariable, ByTheEndOfTheName) {
  EXPECT_TRUE(HoldsMatricesByName("a/model.MAT"));
  EXPECT_TRUE(HoldsMatricesByName("k.npz"));
  EXPECT_TRUE(HoldsMatricesByName("plate.op4"));
  EXPECT_FALSE(HoldsMatricesByName("K.mtx"));
  EXPECT_FALSE(HoldsMatricesByName("mat"));
}

}  // namespace
}  // namespace pinode
