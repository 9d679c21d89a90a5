#include "pinode/structure/matrices/dmig.h"

#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

std::vector<DmigMatrix> ReadOrFail(const std::string& content) {
  std::vector<DmigMatrix> matrices;
  std::string error;
  EXPECT_TRUE(ReadDmigText("model.pch", content, &matrices, &error)) << error;
  return matrices;
}

std::string DmigErrorOf(const std::string& content) {
  std::vector<DmigMatrix> matrices;
  std::string error;
  EXPECT_FALSE(ReadDmigText("model.pch", content, &matrices, &error));
  return error;
}

// Point 10 is a scalar point, as those of a superelement's modes are.
TEST(Dmig, ScalarPointsHaveDirectionZero) {
  const std::vector<DmigMatrix> read = ReadOrFail(
      "DMIG,KAAX,0,6,2,0\nDMIG,KAAX,1,3,,1,3,4.0\nDMIG,KAAX,10,0,,10,,2.5D1\n");
  ASSERT_EQ(read.size(), 1u);
  ASSERT_EQ(read[0].matrix.dofs.size(), 2u);
  EXPECT_EQ(read[0].matrix.dofs[0].Name(), "1.3");
  EXPECT_EQ(read[0].matrix.dofs[1].Name(), "10.0");
  EXPECT_EQ(read[0].matrix.entries[1].value, 25.0);
}

TEST(Dmig, SymmetricEntriesMayLieOnEitherSideOrOnBoth) {
  for (const char* content :
       {"DMIG,K,0,6,2,0\nDMIG,K,1,1,,2,1,-3.0\nDMIG,K,3,1,,2,1,5.0\n",
        "DMIG,K,0,6,2,0\nDMIG,K,1,1,,2,1,-3.0\nDMIG,K,3,1,,2,1,5.0\n"
        "DMIG,K,2,1,,3,1,5.0\nDMIG,K,2,1,,1,1,-3.0\n"}) {
    const std::vector<DmigMatrix> read = ReadOrFail(content);
    ASSERT_EQ(read.size(), 1u);
    ASSERT_EQ(read[0].fault, "");
    DofMatrix matrix = read[0].matrix;
    SparseMatrix assembled;
    MatrixEntry twice;
    ASSERT_TRUE(AssembleMatrix(3, 3, matrix.mirrored, &matrix.entries,
                               &assembled, &twice));
    Matrix expected(3, 3);
    expected << 0.0, -3.0, 0.0, -3.0, 0.0, 5.0, 0.0, 5.0, 0.0;
    EXPECT_EQ(Matrix(assembled), expected);
  }
}

// Square matrices state every term; one of a coupling is not mirrored.
TEST(Dmig, SquareMatricesAreTakenAsTheyStand) {
  const std::vector<DmigMatrix> read =
      ReadOrFail("DMIG,b,0,1,1,0\nDMIG,B,1,1,,2,1,5.0\nDMIG,B,1,1,,1,1,2.0\n");
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].fault, "");
  EXPECT_FALSE(read[0].matrix.mirrored);
}

TEST(Dmig, MatricesOfOtherKindsHaveAFault) {
  const std::vector<DmigMatrix> read = ReadOrFail(
      "DMIG,C,0,6,4,0\nDMIG,C,1,1,,1,1,1.0,2.0\n"
      "DMIG,R,0,2,1,0,,,1\nDMIG,R,1,1,,1,1,1.0\n"
      "DMIG,E,0,6,1,0\n"
      "DMIG,H,0,1,1,0\nDMIG,H,1,1,,2,1,1.0\nDMIG,H,2,1,,3,1,1.0\n"
      "DMIG,H,3,1,,2,1,1.0\n");
  ASSERT_EQ(read.size(), 4u);
  EXPECT_THAT(read[0].fault, HasSubstr("complex"));
  EXPECT_THAT(read[1].fault, HasSubstr("rectangular"));
  EXPECT_THAT(read[2].fault, HasSubstr("no entries"));
  EXPECT_THAT(read[3].fault, HasSubstr("the entry of "));
}

TEST(Dmig, BadFilesAreRefusedByLine) {
  EXPECT_THAT(DmigErrorOf("GRID,1\n"), HasSubstr("no DMIG entries"));
  EXPECT_THAT(DmigErrorOf("DMIG,K,1,1,,1,1,4.0\n"),
              HasSubstr(":1: matrix 'K' has "
                        "no header"));
  EXPECT_THAT(DmigErrorOf("DMIG,K,0,six,2,0\n"), HasSubstr("form 'six'"));
  EXPECT_THAT(DmigErrorOf("DMIG,K,0,6,2,0\nDMIG,K,0,6,2,0\n"),
              HasSubstr(":2: matrix 'K' has two headers"));
  EXPECT_THAT(DmigErrorOf("DMIG,K,0,6,2,0\nDMIG,K,1,7,,1,1,4.0\n"),
              HasSubstr(":2: the column is point '1', component '7'"));
  EXPECT_THAT(DmigErrorOf("DMIG,K,0,6,2,0\nDMIG,K,1,1,,x,1,4.0\n"),
              HasSubstr("the row is point 'x'"));
  EXPECT_THAT(DmigErrorOf("DMIG,K,0,6,2,0\nDMIG,K,1,1,,1,1,\n"),
              HasSubstr("the value is ''"));
  EXPECT_THAT(DmigErrorOf("DMIG,,0,6,2,0\n"), HasSubstr("names no matrix"));
}

}  // namespace
}  // namespace pinode
