#include "pinode/structure/decks/deck_assembly.h"

#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/structure/decks/deck_geometry.h"
#include "pinode/structure/decks/deck_properties.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A column of two halves, and the keywords behind the instances in an assembly.
std::string Column(const std::string& assembly) {
  return R"(*Heading
*Part, name=Column
*Node
1,0.,0.,0.
2,0.,0.,1.
3,0.,0.,2.
*Element, type=B31
1,1,2
2,2,3
*Elset, elset=Low
1
*Elset, elset=High
2
*Beam Section, elset=Low, material=Steel, section=RECT
.1,.1
*Beam Section, elset=High, material=Steel, section=RECT
.1,.1
*End Part
*Assembly, name=Assembly
)" + assembly +
         R"(*End Assembly
*Material, name=Steel
*Density
7850.
*Elastic
2.1e11, 0.3
)";
}

constexpr char kOne[] =
    "*Instance, name=Column-1, part=Column\n*End Instance\n";
// The second instance is moved along x and then lies along y.
constexpr char kTwo[] =
    "*Instance, name=Column-1, part=Column\n*End Instance\n"
    "*Instance, name=\"Column 2\", part=COLUMN\n"
    "5., 0., 0.\n"
    "5., 0., 0., 6., 0., 0., -90.\n*End Instance\n";

StructureGeometry GeometryOrFail(const std::string& deck) {
  StructureGeometry geometry;
  std::string error;
  EXPECT_TRUE(ParseDeckGeometry("deck.inp", deck, &geometry, &error)) << error;
  EXPECT_TRUE(geometry.IsValid(&error)) << error;
  return geometry;
}

std::string GeometryErrorOf(const std::string& deck) {
  StructureGeometry geometry;
  std::string error;
  EXPECT_FALSE(ParseDeckGeometry("deck.inp", deck, &geometry, &error));
  EXPECT_TRUE(geometry.empty());
  EXPECT_EQ(error.find('\n'), std::string::npos);
  return error;
}

std::vector<int> SetOf(const StructureGeometry& geometry,
                       const std::string& name) {
  const int set = geometry.SetIndex(name);
  EXPECT_GE(set, 0) << name;
  return set < 0 ? std::vector<int>()
                 : geometry.sets[static_cast<size_t>(set)].elements;
}

// Moduli of the sections, or the error.
std::string Scaled(const std::string& deck, const std::string& set,
                   std::vector<double>* moduli) {
  moduli->clear();
  std::string scaled = "untouched", error;
  if (!ScaleDeck("deck.inp", deck, {{set, false, 2.0}}, &scaled, &error)) {
    EXPECT_EQ(scaled, "untouched");
    return error;
  }
  std::vector<DeckProperty> properties;
  EXPECT_TRUE(ReadDeckProperties("deck.inp", scaled, &properties, &error))
      << error;
  for (const DeckProperty& property : properties) {
    for (const double modulus : property.stiffness) moduli->push_back(modulus);
  }
  return "";
}

TEST(DeckAssemblyTest, OneInstanceHasPlainNames) {
  const StructureGeometry geometry = GeometryOrFail(
      Column("*Instance, name=Column-1, part=Column\n0., 1., 0.\n"
             "*End Instance\n"
             "*Node\n1, 0., 1., 3.\n7, 0., 0., 0.\n"
             "*Element, type=T3D2, elset=Stay\n1, Column-1.3, 7\n"
             "*Elset, elset=Both, instance=Column-1, generate\n1,2\n"));
  EXPECT_THAT(geometry.node_names,
              ElementsAre("1", "2", "3", "ASSEMBLY.1", "7"));
  EXPECT_EQ(geometry.positions(2, 1), 1.0);
  EXPECT_EQ(geometry.positions(2, 2), 2.0);
  ASSERT_EQ(geometry.elements.size(), 3u);
  EXPECT_THAT(geometry.elements[2].nodes, ElementsAre(2, 4));
  EXPECT_THAT(SetOf(geometry, "low"), ElementsAre(0));
  EXPECT_THAT(SetOf(geometry, "column-1.HIGH"), ElementsAre(1));
  EXPECT_THAT(SetOf(geometry, "both"), ElementsAre(0, 1));
  EXPECT_THAT(SetOf(geometry, "stay"), ElementsAre(2));
}

TEST(DeckAssemblyTest, InstancesAreMovedAndTurned) {
  const StructureGeometry geometry = GeometryOrFail(
      Column(kTwo + std::string("*Elset, elset=Ends, instance=Column-1\nLow\n"
                                "*Elset, elset=Ends, instance=\"Column 2\"\n2\n"
                                "*Elset, elset=All\nEnds, Column-1.High, "
                                "Column 2.1\n"
                                "*Node\n1,9.,9.,9.\n")));
  EXPECT_THAT(geometry.node_names,
              ElementsAre("Column-1.1", "Column-1.2", "Column-1.3",
                          "Column 2.1", "Column 2.2", "Column 2.3", "1"));
  ASSERT_EQ(geometry.num_nodes(), 7);
  Matrix expected(3, 3);
  expected << 5.0, 0.0, 0.0, 5.0, 1.0, 0.0, 5.0, 2.0, 0.0;
  EXPECT_LT((geometry.positions.middleRows(3, 3) - expected).norm(), 1e-14);
  EXPECT_THAT(geometry.elements[3].nodes, ElementsAre(4, 5));
  EXPECT_THAT(SetOf(geometry, "Low"), ElementsAre(0, 2));
  EXPECT_THAT(SetOf(geometry, "Column-1.Low"), ElementsAre(0));
  EXPECT_THAT(SetOf(geometry, "Ends"), ElementsAre(0, 3));
  EXPECT_THAT(SetOf(geometry, "All"), ElementsAre(0, 1, 2, 3));
}

TEST(DeckAssemblyTest, SectionsAreThoseOfAllInstances) {
  std::vector<double> moduli;
  EXPECT_EQ(Scaled(Column(kTwo), "Low", &moduli), "");
  EXPECT_THAT(moduli, ElementsAre(4.2e11, 2.1e11));
  EXPECT_EQ(Scaled(Column(kOne), "Column-1.High", &moduli), "");
  EXPECT_THAT(moduli, ElementsAre(2.1e11, 4.2e11));
  EXPECT_THAT(Scaled(Column(kTwo), "Column-1.Low", &moduli),
              HasSubstr("'Low' has elements outside of it"));
}

// A set of the assembly differs from a part's set of the same name.
TEST(DeckAssemblyTest, NamesOfSeveralSetsAreRefused) {
  std::vector<double> moduli;
  const std::string other = "*Elset, elset=Low, instance=Column-1\n2\n";
  EXPECT_THAT(Scaled(Column(kOne + other), "Low", &moduli),
              HasSubstr("several sets have this name, expected one of "
                        "'Column-1.Low', 'ASSEMBLY.Low'"));
  EXPECT_EQ(GeometryOrFail(Column(kOne + other)).SetIndex("Low"), -1);
  EXPECT_EQ(Scaled(Column(kOne + other), "ASSEMBLY.Low", &moduli), "");
  EXPECT_THAT(moduli, ElementsAre(2.1e11, 4.2e11));
  EXPECT_EQ(Scaled(Column(kOne + other), "Column-1.Low", &moduli), "");
  EXPECT_THAT(moduli, ElementsAre(4.2e11, 2.1e11));
  // The same elements are the same set.
  const std::string same = "*Elset, elset=Low, instance=Column-1\n1\n";
  EXPECT_EQ(Scaled(Column(kOne + same), "Low", &moduli), "");
  EXPECT_THAT(moduli, ElementsAre(4.2e11, 2.1e11));
}

TEST(DeckAssemblyTest, SeveralParts) {
  const std::string beam =
      "*Part, name=Beam\n*Node\n1,0.,0.,2.\n2,5.,0.,2.\n"
      "*Element, type=B31, elset=Low\n1,1,2\n*End Part\n";
  const StructureGeometry geometry = GeometryOrFail(
      beam + Column("*Instance, name=B, part=Beam\n*End Instance\n" +
                    std::string(kOne)));
  EXPECT_THAT(geometry.node_names, ElementsAre("B.1", "B.2", "Column-1.1",
                                               "Column-1.2", "Column-1.3"));
  EXPECT_EQ(geometry.SetIndex("Low"), -1);
  EXPECT_THAT(SetOf(geometry, "B.Low"), ElementsAre(0));
  EXPECT_THAT(SetOf(geometry, "Column-1.Low"), ElementsAre(1));
  EXPECT_THAT(SetOf(geometry, "High"), ElementsAre(2));
  // A part without an instance is not in the model.
  EXPECT_EQ(GeometryOrFail(beam + Column(kOne)).num_nodes(), 3);
}

// Abaqus/CAE writes meshes of independent instances into these.
TEST(DeckAssemblyTest, InstancesMayHaveTheirOwnMesh) {
  const std::string deck =
      "*Part, name=P\n*End Part\n*Assembly, name=A\n"
      "*Instance, name=P-1, part=P\n1.,0.,0.\n*Node\n1,0.,0.,0.\n2,0.,0.,1.\n"
      "*Element, type=T3D2, elset=Bar\n1,1,2\n"
      "*Solid Section, elset=Bar, material=S\n.1\n*End Instance\n"
      "*End Assembly\n*Material, name=S\n*Elastic\n1e5,.3\n";
  EXPECT_EQ(GeometryOrFail(deck).positions(1, 0), 1.0);
  std::vector<double> moduli;
  EXPECT_EQ(Scaled(deck, "Bar", &moduli), "");
  EXPECT_THAT(moduli, ElementsAre(2e5));
}

// The result for solvers without assemblies.
TEST(DeckAssemblyTest, OnePartNeedsNoAssembly) {
  const std::string part = "*PART,NAME=P\n*NODE\n1,0,0,0\n*END PART\n";
  const StructureGeometry geometry = GeometryOrFail(
      part + "*ELEMENT,TYPE=MASS,ELSET=a\n1,1\n*ELSET,ELSET=b\n1\n");
  EXPECT_THAT(geometry.node_names, ElementsAre("1"));
  EXPECT_THAT(SetOf(geometry, "b"), ElementsAre(0));
  EXPECT_EQ(geometry.sets.size(), 2u);
  EXPECT_THAT(GeometryErrorOf(part + "*NODE\n1,0,0,0\n"),
              HasSubstr("node 1 is given twice, expected"));
  EXPECT_THAT(GeometryErrorOf(part + "*PART,NAME=Q\n*NODE\n1,0,0,0\n"),
              HasSubstr("2 parts and no *INSTANCE"));
}

TEST(DeckAssemblyTest, RefusesWithTheLine) {
  const auto error = [](const std::string& assembly) {
    return GeometryErrorOf(Column(assembly));
  };
  EXPECT_THAT(error("*Instance, name=a, part=b\n"),
              HasSubstr("deck.inp:20: *INSTANCE 'a' has PART=b, expected"));
  EXPECT_THAT(error("*Instance, name=a\n"), HasSubstr("has no PART"));
  EXPECT_THAT(error("*Instance, part=column\n"), HasSubstr("has no NAME"));
  EXPECT_THAT(error(std::string(kOne) + kOne),
              HasSubstr("'Column-1' is given twice"));
  EXPECT_THAT(error("*Part, name=COLUMN\n"), HasSubstr("is given twice"));
  EXPECT_THAT(error("*Part, name=b\n*Part, name=c\n"),
              HasSubstr("begins within a part"));
  for (const char* line : {"1.,2.,3.,4.", "a", "0,0,0\n1,1,1", "0,inf,0",
                           "0,0,0\n1,1,1,1,1,1,90", "0\n0,0,0,1,1,1,90\n0"}) {
    EXPECT_THAT(
        error("*Instance, name=a, part=column\n" + std::string(line) + "\n"),
        HasSubstr("expected a translation"))
        << line;
  }
  EXPECT_THAT(error("*Elset, elset=a, instance=b\n1\n"),
              HasSubstr("*ELSET has INSTANCE=b"));
  EXPECT_THAT(error(kOne + std::string("*Elset, elset=a\nColumn-1.x\n")),
              HasSubstr("deck.inp:23: set 'a' has 'Column-1.x'"));
  EXPECT_THAT(
      error(kOne + std::string("*Elset, elset=a\n2\n")),
      HasSubstr("set 'a' of the assembly has element 2, which is none"));
  EXPECT_THAT(
      error(kOne + std::string("*Element, type=T3D2\n1,Column-1.9,2\n")),
      HasSubstr("element 1 has node 9"));
  EXPECT_THAT(error(kOne + std::string("*Element, type=T3D2\n1,Beam-1.1,2\n")),
              HasSubstr("'Beam-1.1', expected a number"));
  EXPECT_THAT(error("*Instance, name=a, part=column\n*Node\n1,0,0,0\n"),
              HasSubstr("node 1 is given twice in instance 'a'"));
}

}  // namespace
}  // namespace pinode
