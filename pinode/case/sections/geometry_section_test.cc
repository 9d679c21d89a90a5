#include "pinode/case/sections/geometry_section.h"

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/record/files/universal_file.h"
#include "pinode/study/picture/structure_picture.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class GeometrySectionTest : public ::testing::Test {
 protected:
  GeometrySectionTest() { folder_.Write("quake.csv", SmallRecord()); }

  std::shared_ptr<const PlacedGeometry> Read(const std::string& section) {
    return ReadOrFail(folder_.Write("case.toml", SmallCase() + section))
        .geometry;
  }

  std::string ErrorOf(const std::string& section) {
    Case c;
    std::string error;
    EXPECT_FALSE(ReadCase(folder_.Write("case.toml", SmallCase() + section), &c,
                          &error));
    EXPECT_EQ(error.find('\n'), std::string::npos);
    return error;
  }

  TemporaryFolder folder_;
};

constexpr char kPlacesTable[] = R"([geometry]
nodes = {g = [0, 0, 0], a = [0, 0, 3], b = [0, 0, 6], c = [4, 0, 6]}
dofs = {u1 = "a.1", u2 = ["b.1", "-c.1"]}
[[geometry.line]]
nodes = ["g", "a"]
set = "lower"
[[geometry.line]]
nodes = ["a", "b", "c"]
set = "upper"
)";

TEST_F(GeometrySectionTest, ATable) {
  EXPECT_EQ(Read(""), nullptr);
  const auto placed = Read(kPlacesTable);
  ASSERT_NE(placed, nullptr);
  EXPECT_THAT(placed->geometry.node_names, ElementsAre("g", "a", "b", "c"));
  EXPECT_EQ(placed->geometry.positions(3, 0), 4.0);
  ASSERT_EQ(placed->geometry.elements.size(), 3u);
  EXPECT_THAT(placed->geometry.elements[2].nodes, ElementsAre(2, 3));
  ASSERT_EQ(placed->geometry.SetIndex("upper"), 1);
  EXPECT_THAT(placed->geometry.sets[1].elements, ElementsAre(1, 2));
  ASSERT_EQ(placed->dofs.at("u2").size(), 2u);
  EXPECT_EQ(placed->dofs.at("u2")[1].node, "c");
  EXPECT_EQ(placed->dofs.at("u2")[1].sign, -1.0);
}

TEST_F(GeometrySectionTest, Files) {
  folder_.Write(
      "frame.inp",
      "*NODE\n1,0,0,0\n2,0,0,1\n*ELEMENT,TYPE=B31,ELSET=post\n1,1,2\n");
  const auto deck = Read("[geometry]\nfile = \"frame.inp\"\n");
  ASSERT_NE(deck, nullptr);
  EXPECT_EQ(deck->geometry.SetIndex("post"), 0);
  for (const char* name : {"missing.inp", "missing.bdf", "missing.uff"}) {
    const std::string error =
        ErrorOf("[geometry]\nfile = \"" + std::string(name) + "\"\n");
    EXPECT_THAT(error, HasSubstr(std::string(name) +
                                 ": cannot open the file: No such file"));
    EXPECT_EQ(error.find("CSV"), std::string::npos);
  }
}

TEST_F(GeometrySectionTest, DecksInOtherEncodings) {
  folder_.Write("frame.inp",
                "** Gr\xF6\xDF"
                "e\n*NODE\n1,0,0,0\n");
  EXPECT_NE(Read("[geometry]\nfile = \"frame.inp\"\n"), nullptr);
}

TEST_F(GeometrySectionTest, BulkData) {
  folder_.Write("mast.bdf",
                "GRID,1,,0.,0.,0.\nGRID,2,,0.,0.,4.\nCBAR,1,12,1,2\n");
  const auto placed = Read(
      "[geometry]\nfile = \"mast.bdf\"\ndofs = {u1 = \"2.1\"}\n"
      "groups = {k1 = \"PID 12\"}\n");
  ASSERT_NE(placed, nullptr);
  EXPECT_EQ(placed->geometry.positions(1, 2), 4.0);
  EXPECT_THAT(placed->groups.at("k1"), ElementsAre("PID 12"));
}

TEST_F(GeometrySectionTest, UniversalFiles) {
  UniversalFile file;
  for (int label : {7, 8, 12}) {
    file.nodes.push_back({label, {0.5, 0.0, 1.0 * label}, 0, 0});
  }
  // The pen is lifted before the last.
  file.lines.push_back({"mast", {7, 8, 0, 12}});
  folder_.Write("mast.uff", FormatUniversalFile(file));
  const auto placed = Read(
      "[geometry]\nfile = \"mast.uff\"\ndofs = {u1 = \"8.2\"}\n"
      "[[geometry.line]]\nnodes = [\"8\", \"12\"]\nset = \"top\"\n");
  ASSERT_NE(placed, nullptr);
  const StructureGeometry& geometry = placed->geometry;
  EXPECT_THAT(geometry.node_names, ElementsAre("7", "8", "12"));
  EXPECT_EQ(geometry.positions(2, 2), 12.0);
  ASSERT_EQ(geometry.elements.size(), 2u);
  EXPECT_THAT(geometry.elements[0].nodes, ElementsAre(0, 1));
  EXPECT_THAT(geometry.elements[1].nodes, ElementsAre(1, 2));
  ASSERT_EQ(geometry.sets.size(), 2u);
  EXPECT_EQ(geometry.sets[0].name, "mast");
  EXPECT_THAT(geometry.sets[1].elements, ElementsAre(1));
  EXPECT_EQ(placed->dofs.at("u1")[0].direction, 2);
  folder_.Write("empty.uff", FormatUniversalFile(UniversalFile()));
  EXPECT_NE(ErrorOf("[geometry]\nfile = \"empty.uff\"\n"), "");
}

// Data set 18: the first is the global system, the second is moved and turned:
// its x axis is y, its z axis z; the third is spherical.
class UniversalSystemsTest : public GeometrySectionTest {
 protected:
  // `numbers`: of the systems of node 8's position and directions.
  std::string With(const std::string& numbers, const std::string& dofs = "") {
    folder_.Write(
        "mast.uff",
        "    -1\n    18\n1 0 0 1 1\nsame\n0. 0. 0. 1. 0. 0.\n0. 0. 1.\n"
        "2 0 0 1 1\nmoved\n0. 0. 9. 0. 1. 9.\n0. 0. 10.\n"
        "3 2 0 1 1\nround\n0. 0. 9. 0. 1. 9.\n0. 0. 10.\n    -1\n"
        "    -1\n    15\n7 0 0 1 0. 0. 0.\n8 " +
            numbers + " 1 0.5 0. 4.\n    -1\n");
    return "[geometry]\nfile = \"mast.uff\"\n" + dofs;
  }
};

TEST_F(UniversalSystemsTest, OfPositions) {
  auto placed = Read(With("1 1"));
  ASSERT_NE(placed, nullptr);
  EXPECT_TRUE(placed->geometry.notes.empty());
  EXPECT_TRUE(placed->geometry.axes.empty());
  placed = Read(With("2 0"));
  ASSERT_NE(placed, nullptr);
  const Vector position = placed->geometry.positions.row(1);
  EXPECT_TRUE(position.isApprox(Eigen::Vector3d(0.0, 0.5, 13.0)));
  for (const char* system : {"3", "4"}) {
    EXPECT_THAT(ErrorOf(With(std::string(system) + " 0")),
                HasSubstr("node 8 is in coordinate system " +
                          std::string(system) + ", expected the global one"));
  }
}

TEST_F(UniversalSystemsTest, OfDirections) {
  const std::string dof = "dofs = {u1 = \"-8.1\"}\n";
  const auto placed = Read(With("0 2", dof));
  ASSERT_NE(placed, nullptr);
  EXPECT_TRUE(placed->geometry.notes.empty());
  EXPECT_TRUE(
      placed->geometry.Direction(1, 1).isApprox(Eigen::Vector3d::UnitY()));
  EXPECT_TRUE(
      placed->geometry.Direction(1, 2).isApprox(-Eigen::Vector3d::UnitX()));
  EXPECT_EQ(placed->geometry.Direction(0, 2), Eigen::Vector3d::UnitY());
  // Drawn, but without what is measured there.
  for (const char* system : {"3", "4"}) {
    const auto unknown = Read(With("0 " + std::string(system)));
    ASSERT_NE(unknown, nullptr);
    ASSERT_EQ(unknown->geometry.notes.size(), 1u);
    EXPECT_THAT(unknown->geometry.notes[0],
                HasSubstr("1 nodes have local directions"));
    EXPECT_THAT(ErrorOf(With("0 " + std::string(system), dof)),
                HasSubstr("'8.1' has a local direction"));
  }
}

// Some programs use the system in set 2411 for the position.
TEST_F(UniversalSystemsTest, OfSet2411) {
  UniversalFile file;
  file.nodes = {{7, {0.0, 0.0, 1.0}, 2, 0}};
  UniversalSystem moved;
  moved.origin[2] = 9.0;
  file.systems[2] = moved;
  folder_.Write("mast.uff", FormatUniversalFile(file));
  EXPECT_THAT(ErrorOf("[geometry]\nfile = \"mast.uff\"\n"),
              HasSubstr("node 7 is in coordinate system 2"));
}

TEST_F(GeometrySectionTest, RefusesInOneLine) {
  EXPECT_THAT(ErrorOf("[geometry]\n"), HasSubstr("expected one of file"));
  EXPECT_THAT(ErrorOf("[geometry]\nfile = \"none.inp\"\n"),
              HasSubstr("none.inp"));
  EXPECT_THAT(ErrorOf(Replaced(kPlacesTable, "u1 = \"a.1\"", "u7 = \"a.1\"")),
              HasSubstr("'u7' is not a DOF"));
  EXPECT_THAT(ErrorOf(Replaced(kPlacesTable, "\"a.1\"", "\"a.4\"")),
              HasSubstr("'a.4' is not a place"));
  EXPECT_THAT(ErrorOf(Replaced(kPlacesTable, "\"a.1\"", "\"z.1\"")),
              HasSubstr("'z.1' is not a place"));
  EXPECT_THAT(ErrorOf(Replaced(kPlacesTable, "[\"g\", \"a\"]", "[\"g\"]")),
              HasSubstr("fewer than two"));
  EXPECT_THAT(
      ErrorOf(Replaced(kPlacesTable, "[\"g\", \"a\"]", "[\"g\", \"x\"]")),
      HasSubstr("'x' is not a node"));
  EXPECT_THAT(ErrorOf(Replaced(kPlacesTable, "[4, 0, 6]", "[4, 0]")),
              HasSubstr("coordinate"));
  EXPECT_THAT(ErrorOf(std::string(kPlacesTable) +
                      "[geometry.groups]\nk9 = \"upper\"\n"),
              HasSubstr("'k9' is not a group"));
}

}  // namespace
}  // namespace pinode
