#include "pinode/structure/decks/deck_geometry.h"

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/structure/decks/deck_blocks.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

StructureGeometry ParseOrFail(const std::string& text) {
  StructureGeometry geometry;
  std::string error;
  EXPECT_TRUE(ParseDeckGeometry("deck.inp", text, &geometry, &error)) << error;
  EXPECT_TRUE(geometry.IsValid(&error)) << error;
  return geometry;
}

std::string ErrorOf(const std::string& text) {
  StructureGeometry geometry;
  std::string error;
  EXPECT_FALSE(ParseDeckGeometry("deck.inp", text, &geometry, &error));
  EXPECT_TRUE(geometry.empty());
  EXPECT_EQ(error.find('\n'), std::string::npos);
  return error;
}

constexpr char kNodes[] =
    "*Node, nset=all\n"
    "1, 0, 0, 0\n2, 1., 0\n 3, 1e0, 1, \n4, 0, 1, 0\n"
    "** above\n"
    "5,0,0,2\n6,1,0,2\n7,1,1,2\n8,0,1,2\n";

TEST(DeckGeometryTest, NodesElementsAndSets) {
  const StructureGeometry geometry =
      ParseOrFail(std::string("*HEADING\nwhat it is, 1, 2\n") + kNodes +
                  "*ELEMENT, TYPE=C3D8R, ELSET=Body\n10, 1,2,3,4, 5,6,7,8\n"
                  "*element, type = B32,\n elset=beams\n20,1,5,8\n21,2,6,7\n"
                  "*ELEMENT,TYPE=S4\n30,1,2,3,4\n"
                  "*ELSET,ELSET=some\n21, 10\n"
                  "*ELSET,ELSET=steps,GENERATE\n10,30,10\n"
                  "*ELSET,ELSET=both\nbeams, 30, SOME,\n"
                  "*STEP\n*STATIC\n1.,1.\n*END STEP\n");
  ASSERT_EQ(geometry.num_nodes(), 8);
  EXPECT_EQ(geometry.node_names[2], "3");
  EXPECT_EQ(Vector(geometry.positions.row(2).transpose()),
            Vector(Eigen::Vector3d(1.0, 1.0, 0.0)));
  ASSERT_EQ(geometry.elements.size(), 4u);
  EXPECT_EQ(geometry.elements[0].shape, ElementShape::kHexahedron);
  EXPECT_THAT(geometry.elements[0].nodes, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  // Ends of a beam of three nodes, the second of which is in the middle.
  EXPECT_EQ(geometry.elements[1].shape, ElementShape::kLine);
  EXPECT_THAT(geometry.elements[1].nodes, ElementsAre(0, 7));
  EXPECT_EQ(geometry.elements[3].shape, ElementShape::kQuadrilateral);
  const auto elements = [&](const char* name) {
    const int set = geometry.SetIndex(name);
    return set < 0 ? std::vector<int>()
                   : geometry.sets[static_cast<size_t>(set)].elements;
  };
  EXPECT_THAT(elements("body"), ElementsAre(0));
  EXPECT_THAT(elements("BEAMS"), ElementsAre(1, 2));
  EXPECT_THAT(elements("some"), ElementsAre(0, 2));
  EXPECT_THAT(elements("steps"), ElementsAre(0, 1, 3));
  EXPECT_THAT(elements("both"), ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(geometry.SetIndex("nothing"), -1);
}

TEST(DeckGeometryTest, HigherOrderElementsGoOnOverLines) {
  std::string text = "*NODE\n";
  for (int i = 1; i <= 20; ++i) {
    text += std::to_string(i) + "," + std::to_string(i) + ",0,0\n";
  }
  const StructureGeometry geometry =
      ParseOrFail(text +
                  "*ELEMENT,TYPE=C3D20R\n"
                  "1,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,\n16,17,18,19,20\n"
                  "*ELEMENT,TYPE=S9R5\n2,1,2,3,4,5,6,7,8,9\n"
                  "*ELEMENT,TYPE=UNHEARD7,ELSET=odd\n3,1,2\n4,1,2\n");
  ASSERT_EQ(geometry.elements.size(), 2u);
  EXPECT_THAT(geometry.elements[0].nodes, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  ASSERT_EQ(geometry.notes.size(), 1u);
  EXPECT_THAT(geometry.notes[0], HasSubstr("2 elements of type UNHEARD7"));
}

TEST(DeckGeometryTest, IncludesAreBesideTheDeck) {
  TemporaryFolder folder;
  folder.Write("nodes.inp", "*NODE\n1,0,0,0\n2,0,0,1\n");
  const std::string path = folder.Write(
      "deck.inp", "*INCLUDE, INPUT=nodes.inp\n*ELEMENT,TYPE=T3D2\n1,1,2\n");
  StructureGeometry geometry;
  std::string error;
  ASSERT_TRUE(ReadDeckGeometry(path, &geometry, &error)) << error;
  EXPECT_EQ(geometry.num_nodes(), 2);
  EXPECT_EQ(geometry.elements.size(), 1u);
}

// Paths are relative to the file that names them, or to the deck.
TEST(DeckGeometryTest, IncludesMayNameOthers) {
  TemporaryFolder folder;
  std::filesystem::create_directory(folder.Path("sub"));
  folder.Write("sub/all.inp",
               "*INCLUDE,INPUT=nodes.inp\n*INCLUDE,INPUT=sub/bars.inp\n"
               "*ELSET,ELSET=some\n*INCLUDE,INPUT=numbers.inp\n");
  folder.Write("sub/nodes.inp",
               "** Gr\xF6\xDF"
               "e\n*NODE\n1,0,0,0\n2,0,0,1\n");
  folder.Write("nodes.inp", "not this one");
  folder.Write("sub/bars.inp", "*ELEMENT,TYPE=T3D2\n1,1,2\n");
  folder.Write("numbers.inp", "1\n");
  const std::string path =
      folder.Write("deck.inp", "*INCLUDE, INPUT=\"sub/all.inp\"\n");
  StructureGeometry geometry;
  std::string error;
  ASSERT_TRUE(ReadDeckGeometry(path, &geometry, &error)) << error;
  EXPECT_EQ(geometry.num_nodes(), 2);
  EXPECT_EQ(geometry.elements.size(), 1u);
  EXPECT_THAT(geometry.sets[0].elements, ElementsAre(0));
}

// Ten files that each include all ten would be read 10^10 times.
TEST(DeckGeometryTest, IncludesEnd) {
  TemporaryFolder folder;
  std::string all;
  for (int i = 0; i < 10; ++i) {
    all += "*INCLUDE,INPUT=i" + std::to_string(i) + ".inp\n";
  }
  // The last one holds nothing, so that no depth is too large.
  for (int depth = 0; depth < 9; ++depth) {
    std::string next;
    for (int i = 0; i < 10; ++i) {
      next += "*INCLUDE,INPUT=i" + std::to_string(depth + 1) + ".inp\n";
    }
    folder.Write("i" + std::to_string(depth) + ".inp", next);
  }
  folder.Write("i9.inp", "*NODE\n");
  const std::string path = folder.Write("deck.inp", all);
  StructureGeometry geometry;
  std::string error;
  EXPECT_FALSE(ReadDeckGeometry(path, &geometry, &error));
  EXPECT_THAT(error, HasSubstr("*INCLUDE is one of more than 1000"));
  std::vector<DeckBlock> blocks;
  EXPECT_FALSE(ReadDeckBlocks(path, all, &blocks, &error));
  EXPECT_THAT(error, HasSubstr("*INCLUDE is one of more than 1000"));
}

TEST(DeckGeometryTest, IncludesOutsideOfTheFolderAreNamed) {
  TemporaryFolder folder;
  std::filesystem::create_directory(folder.Path("sub"));
  folder.Write("nodes.inp", "*NODE\n1,0,0,0\n2,0,0,1\n");
  folder.Write("sub/bars.inp", "*ELEMENT,TYPE=T3D2\n1,1,2\n");
  const std::string path =
      folder.Write("sub/deck.inp",
                   "*INCLUDE, INPUT=../nodes.inp\n*INCLUDE,INPUT=bars.inp\n");
  StructureGeometry geometry;
  std::string error;
  ASSERT_TRUE(ReadDeckGeometry(path, &geometry, &error)) << error;
  ASSERT_EQ(geometry.notes.size(), 1u);
  EXPECT_THAT(geometry.notes[0], HasSubstr("nodes.inp, which is not in its"));
}

TEST(DeckGeometryTest, RefusesWithTheLine) {
  const std::string nodes = kNodes;
  EXPECT_THAT(ErrorOf("*HEADING\n"), HasSubstr("no *NODE"));
  EXPECT_THAT(ErrorOf("*NODE\n1,0,a,0\n"), HasSubstr("deck.inp:2:"));
  EXPECT_THAT(ErrorOf("*NODE\n1,0,inf,0\n"), HasSubstr("deck.inp:2:"));
  EXPECT_THAT(ErrorOf("*NODE\n1,0,0,0\n1,0,0,1\n"),
              HasSubstr("node 1 is given twice"));
  EXPECT_THAT(ErrorOf("*NODE,SYSTEM=C\n1,0,0,0\n"), HasSubstr("SYSTEM=C"));
  EXPECT_THAT(ErrorOf(nodes + "*ELEMENT\n1,1,2\n"), HasSubstr("TYPE"));
  EXPECT_THAT(ErrorOf(nodes + "*ELEMENT,TYPE=B31\n1,1,9\n"),
              HasSubstr("element 1 has node 9"));
  EXPECT_THAT(ErrorOf("*NODE,INPUT=nodes.txt\n"),
              HasSubstr("deck.inp:1: *NODE has INPUT"));
  EXPECT_THAT(ErrorOf(nodes + "*ELEMENT,TYPE=B31,input=a.txt\n"),
              HasSubstr("deck.inp:11: *ELEMENT has INPUT"));
  EXPECT_THAT(ErrorOf(nodes + "*ELSET,ELSET=a,INPUT=a.txt\n"),
              HasSubstr("*ELSET has INPUT"));
  EXPECT_THAT(ErrorOf(nodes + "*ELEMENT,TYPE=B31\n1,1,2,3\n"),
              HasSubstr("has 3 nodes, expected 2"));
  EXPECT_THAT(ErrorOf(nodes + "*ELEMENT,TYPE=C3D8\n1,1,2,3\n*STEP\n"),
              HasSubstr("too few nodes"));
  EXPECT_THAT(ErrorOf(nodes + "*ELEMENT,TYPE=B31\n1,1,2\n1,2,3\n"),
              HasSubstr("element 1 is given twice"));
  EXPECT_THAT(ErrorOf(nodes + "*ELSET,ELSET=a\nb\n"),
              HasSubstr("deck.inp:12:"));
  EXPECT_THAT(ErrorOf(nodes + "*ELSET,ELSET=a,GENERATE\n3,1,1\n"),
              HasSubstr("first, last, step"));
  EXPECT_THAT(ErrorOf(nodes + "*NGEN\n1,2,1\n"), HasSubstr("*NGEN"));
  EXPECT_THAT(ErrorOf("*INCLUDE,INPUT=not_there.inp\n"),
              HasSubstr("not_there.inp"));
  EXPECT_THAT(ErrorOf("*INCLUDE\n"),
              HasSubstr("deck.inp:1: *INCLUDE has no INPUT"));
  TemporaryFolder folder;
  const std::string path = folder.Write("a.inp", "*INCLUDE,INPUT=a.inp\n");
  StructureGeometry geometry;
  std::string error;
  EXPECT_FALSE(ReadDeckGeometry(path, &geometry, &error));
  EXPECT_THAT(error, HasSubstr("a.inp:1: *INCLUDE is the 11th"));
}

// The deck of the frame agrees with its description in data/README.md.
TEST(DeckGeometryTest, TheFrame) {
  StructureGeometry geometry;
  std::string error;
  ASSERT_TRUE(
      ReadDeckGeometry(std::string(PINODE_SOURCE_DIR) + "/data/frame/frame.inp",
                       &geometry, &error))
      << error;
  EXPECT_EQ(geometry.num_nodes(), 304);
  EXPECT_EQ(geometry.elements.size(), 93u);
  EXPECT_TRUE(geometry.notes.empty());
  for (const char* set : {"columns_1_west", "columns_3_east", "brace_2"}) {
    ASSERT_GE(geometry.SetIndex(set), 0) << set;
  }
  EXPECT_EQ(
      geometry.sets[static_cast<size_t>(geometry.SetIndex("columns_1_west"))]
          .elements.size(),
      8u);
  EXPECT_NEAR(geometry.positions.col(2).maxCoeff(), 1.51, 1e-12);
}

TEST(StructureGeometryTest, FacesPointOutwards) {
  Matrix box(8, 3);
  box << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1;
  const Eigen::Vector3d center(0.5, 0.5, 0.5);
  const auto& faces = FacesOf(ElementShape::kHexahedron);
  ASSERT_EQ(faces.size(), 6u);
  for (const std::vector<int>& face : faces) {
    const auto corner = [&](size_t i) {
      return Eigen::Vector3d(box.row(face[i]).transpose());
    };
    const Eigen::Vector3d normal =
        (corner(1) - corner(0)).cross(corner(2) - corner(1));
    EXPECT_GT(normal.dot(corner(0) - center), 0.0);
  }
}

TEST(StructureGeometryTest, NamesOfDofs) {
  std::string node;
  int direction = 0;
  ASSERT_TRUE(SplitDofName("12.3", &node, &direction));
  EXPECT_EQ(node, "12");
  EXPECT_EQ(direction, 3);
  EXPECT_TRUE(SplitDofName("a.b.1", &node, &direction));
  EXPECT_EQ(node, "a.b");
  for (const char* name : {"u1", "12.7", "12.3#1", ".1", "12.", "12.12"}) {
    EXPECT_FALSE(SplitDofName(name, &node, &direction)) << name;
  }
}

}  // namespace
}  // namespace pinode
