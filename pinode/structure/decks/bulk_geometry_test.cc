#include "pinode/structure/decks/bulk_geometry.h"

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Small fields, large fields, commas, a card over two lines, an exponent
// without its letter.
constexpr char kBulk[] = R"(SOL 103
CEND
BEGIN BULK
$ a frame
GRID    1               0.0     0.0     0.0
GRID    2               1.0     0.0     0.0
GRID*                  3                             1.0             1.0
*                    0.0
GRID,4,,0.0,1.0,
GRID    5               0.0     0.0     2.5+0
GRID    6               1.0     0.0     25.-1
GRID    7               1.0     1.0     2.5
GRID    8               0.0     1.0     2.5
CHEXA   1       10      1       2       3       4       5       6       +
+       7       8
CQUAD4,2,11,1,2,3,4
CBAR    3       12      1       5       0.0     1.0     0.0
CBAR    4       12      2       6       0.0     1.0     0.0
CONM2   5       8               12.5
CELAS2  6       1000.   1       1
CWELD   7       1       2
ENDDATA
GRID    99              0.0     0.0     0.0
)";

StructureGeometry BulkOrFail(const std::string& content) {
  StructureGeometry geometry;
  std::string error;
  EXPECT_TRUE(ParseBulkGeometry("frame.bdf", content, &geometry, &error))
      << error;
  EXPECT_TRUE(geometry.IsValid(&error)) << error;
  return geometry;
}

std::string BulkErrorOf(const std::string& content) {
  StructureGeometry geometry;
  std::string error;
  EXPECT_FALSE(ParseBulkGeometry("frame.bdf", content, &geometry, &error));
  EXPECT_EQ(error.find('\n'), std::string::npos);
  return error;
}

TEST(BulkGeometryTest, Reads) {
  const StructureGeometry geometry = BulkOrFail(kBulk);
  EXPECT_THAT(geometry.node_names,
              ElementsAre("1", "2", "3", "4", "5", "6", "7", "8"));
  EXPECT_EQ(geometry.positions.row(2), Eigen::RowVector3d(1.0, 1.0, 0.0));
  EXPECT_EQ(geometry.positions.row(3), Eigen::RowVector3d(0.0, 1.0, 0.0));
  EXPECT_EQ(geometry.positions(4, 2), 2.5);
  EXPECT_EQ(geometry.positions(5, 2), 2.5);
  ASSERT_EQ(geometry.elements.size(), 5u);
  EXPECT_THAT(geometry.elements[0].nodes, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  EXPECT_EQ(geometry.elements[1].shape, ElementShape::kQuadrilateral);
  EXPECT_THAT(geometry.elements[3].nodes, ElementsAre(1, 5));
  EXPECT_THAT(geometry.elements[4].nodes, ElementsAre(7));
  const int bars = geometry.SetIndex("PID 12");
  ASSERT_GE(bars, 0);
  EXPECT_THAT(geometry.sets[static_cast<size_t>(bars)].elements,
              ElementsAre(2, 3));
  ASSERT_EQ(geometry.notes.size(), 1u);
  EXPECT_THAT(geometry.notes[0], HasSubstr("1 cards CWELD"));
}

// Fields left out at the end of a line with commas are blank.
TEST(BulkGeometryTest, LinesThatEndEarlyGoOn) {
  const StructureGeometry geometry = BulkOrFail(
      "GRDSET,,0,,,,0,456\nGRID*,1,,1.,2.,+\n*,3.\nGRID*,2,,4.\n*,5.\n"
      "CROD,7,8,1,2\n");
  EXPECT_EQ(geometry.positions.row(0), Eigen::RowVector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(geometry.positions.row(1), Eigen::RowVector3d(4.0, 0.0, 5.0));
}

TEST(BulkGeometryTest, RefusesWithTheLine) {
  EXPECT_THAT(BulkErrorOf("CEND\n"), HasSubstr("no GRID"));
  EXPECT_THAT(BulkErrorOf("GRID,1,,a,0.,0.\n"),
              HasSubstr("frame.bdf:1: GRID 1"));
  EXPECT_THAT(BulkErrorOf("GRID,1,,0.,0.,0.\nGRID,2,5,0.,0.,0.\n"),
              HasSubstr("frame.bdf:2: GRID 2 is in system 5"));
  EXPECT_THAT(BulkErrorOf("GRID,1,,0.,0.,0.,7\n"), HasSubstr("system 7"));
  EXPECT_THAT(BulkErrorOf("GRID,1\nGRID,1\n"), HasSubstr("given twice"));
  EXPECT_THAT(BulkErrorOf("GRID,1\nCROD,1,1,1,9\nGRID,2\n"),
              HasSubstr("frame.bdf:2: an element has node 9"));
  EXPECT_THAT(BulkErrorOf("GRID,1\nGRDSET,,2\n"),
              HasSubstr("frame.bdf:2: GRDSET is in system 2"));
  EXPECT_THAT(BulkErrorOf("GRDSET,,,,,,3,123\nGRID,1\n"),
              HasSubstr("system 3"));
  EXPECT_THAT(BulkErrorOf("GRID,1\nCROD,1,1,1\n"),
              HasSubstr("frame.bdf:2: CROD has ''"));
  EXPECT_THAT(BulkErrorOf("INCLUDE 'a.bdf'\n"), HasSubstr("INCLUDE"));
}

TEST(BulkGeometryTest, ByItsName) {
  EXPECT_TRUE(IsBulkFile("a/frame.BDF"));
  EXPECT_TRUE(IsBulkFile("frame.nas"));
  EXPECT_FALSE(IsBulkFile("frame.inp"));
}

}  // namespace
}  // namespace pinode
