#include "pinode/structure/decks/deck_properties.h"

#include <cmath>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// Three bars that share a steel, two of another, springs and a mass.
constexpr char kDeck[] = R"(** A bridge
*NODE
1,0,0,0
2,1,0,0
3,2,0,0
4,3,0,0
5,4,0,0
6,5,0,0
*ELEMENT,TYPE=T3D2,ELSET=low
1,1,2
*ELEMENT,TYPE=T3D2,ELSET=mid
2,2,3
*ELEMENT,TYPE=T3D2,ELSET=top
3,3,4
*ELEMENT,TYPE=B31,ELSET=deck
4,4,5
5,5,6
*ELSET,ELSET=all_steel
low, mid, top
*ELSET,ELSET=half_deck
4
*ELEMENT,TYPE=SPRINGA,ELSET=stay
6,1,6
*ELEMENT,TYPE=SPRING1,ELSET=soil
7,1
*ELEMENT,TYPE=MASS,ELSET=ballast
8,4
*MATERIAL, NAME=Steel
*ELASTIC
** at two temperatures
2.1E11, 0.3, 20.
2.0E11, 0.3, 300.
*DENSITY
7850.
*DAMPING, ALPHA=0.5
*MATERIAL,NAME=WOOD
*ELASTIC,TYPE=ENGINEERING CONSTANTS
1.1E10,8.E8,5.E8,.3,.3,.4,6.E8,5.E8,
4.E7
*DENSITY
450
*SOLID SECTION,ELSET=low,MATERIAL=STEEL
1e-3
*SOLID SECTION,ELSET=mid,MATERIAL=steel
1e-3
*SOLID SECTION, ELSET=top, MATERIAL=steel
1e-3
*BEAM SECTION,ELSET=deck,MATERIAL=wood,SECTION=RECT
.2,.3
0,0,1
*SPRING,ELSET=stay,NONLINEAR
-10.,-1.
0.,0.
20.,1.
*SPRING,ELSET=soil
2
5000.
*MASS,ELSET=ballast
120.
*STEP
*END STEP
)";

std::vector<DeckProperty> PropertiesOrFail(const std::string& content) {
  std::vector<DeckProperty> properties;
  std::string error;
  EXPECT_TRUE(ReadDeckProperties("bridge.inp", content, &properties, &error))
      << error;
  return properties;
}

std::string ScaledOrFail(const std::vector<DeckFactor>& factors,
                         const std::string& content = kDeck) {
  std::string scaled, error;
  EXPECT_TRUE(ScaleDeck("bridge.inp", content, factors, &scaled, &error))
      << error;
  return scaled;
}

std::string ScalingErrorOf(const std::vector<DeckFactor>& factors,
                           const std::string& content = kDeck) {
  std::string scaled = "untouched", error;
  EXPECT_FALSE(ScaleDeck("bridge.inp", content, factors, &scaled, &error));
  EXPECT_EQ(scaled, "untouched");
  EXPECT_EQ(error.find('\n'), std::string::npos);
  return error;
}

TEST(DeckPropertiesTest, Reads) {
  const std::vector<DeckProperty> properties = PropertiesOrFail(kDeck);
  ASSERT_EQ(properties.size(), 7u);
  EXPECT_EQ(properties[0].set, "low");
  EXPECT_THAT(properties[0].stiffness, ElementsAre(2.1e11, 2.0e11));
  EXPECT_THAT(properties[0].mass, ElementsAre(7850.0));
  EXPECT_THAT(properties[3].stiffness,
              ElementsAre(1.1e10, 8e8, 5e8, 6e8, 5e8, 4e7));
  EXPECT_THAT(properties[4].stiffness, ElementsAre(-10.0, 0.0, 20.0));
  EXPECT_TRUE(properties[4].mass.empty());
  EXPECT_THAT(properties[5].stiffness, ElementsAre(5000.0));
  EXPECT_THAT(properties[6].mass, ElementsAre(120.0));
}

TEST(DeckPropertiesTest, FactorsAreReadBack) {
  const std::vector<DeckFactor> factors = {
      {"mid", false, 0.8},  {"TOP", true, 1.25},  {"deck", false, 1.1},
      {"stay", false, 0.5}, {"soil", false, 3.0}, {"ballast", true, 0.9}};
  const std::vector<double> stiffness = {1.0, 0.8, 1.0, 1.1, 0.5, 3.0, 1.0};
  const std::vector<double> mass = {1.0, 1.0, 1.25, 1.0, 1.0, 1.0, 0.9};
  const std::string scaled = ScaledOrFail(factors);
  const std::vector<DeckProperty> before = PropertiesOrFail(kDeck);
  const std::vector<DeckProperty> after = PropertiesOrFail(scaled);
  ASSERT_EQ(after.size(), before.size());
  for (size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(after[i].set, before[i].set);
    ASSERT_EQ(after[i].stiffness.size(), before[i].stiffness.size());
    for (size_t k = 0; k < after[i].stiffness.size(); ++k) {
      const double expected = stiffness[i] * before[i].stiffness[k];
      EXPECT_NEAR(after[i].stiffness[k], expected, 1e-13 * std::abs(expected));
    }
    ASSERT_EQ(after[i].mass.size(), before[i].mass.size());
    for (size_t k = 0; k < after[i].mass.size(); ++k) {
      const double expected = mass[i] * before[i].mass[k];
      EXPECT_NEAR(after[i].mass[k], expected, 1e-13 * expected);
    }
  }
  // The shared material gets a copy for each section that differs, with all its
  // data.
  EXPECT_THAT(scaled, HasSubstr("*MATERIAL, NAME=Steel\n"));
  EXPECT_THAT(scaled, HasSubstr("*MATERIAL,NAME=STEEL_MID\n*ELASTIC\n** at two "
                                "temperatures\n1.6800000000000E+11,0.3,20."));
  EXPECT_THAT(scaled, HasSubstr("ELSET=mid,MATERIAL=STEEL_MID\n"));
  EXPECT_THAT(scaled, HasSubstr("*SOLID SECTION,ELSET=low,MATERIAL=STEEL\n"));
  EXPECT_THAT(scaled,
              HasSubstr("*SPRING,ELSET=soil\n2\n1.5000000000000E+04\n"));
  EXPECT_THAT(scaled, HasSubstr("0.3, 300.\n*DENSITY\n9.8125000000000E+03\n"
                                "*DAMPING, ALPHA=0.5\n"));
  EXPECT_EQ(scaled.substr(0, 100), std::string(kDeck).substr(0, 100));
}

TEST(DeckPropertiesTest, NothingElseIsTouched) {
  EXPECT_EQ(ScaledOrFail({}), kDeck);
  EXPECT_EQ(ScaledOrFail({{"all_steel", false, 1.0}}), kDeck);
  // One factor for all sections of a material needs no copy.
  const std::string scaled = ScaledOrFail({{"all_steel", false, 2.0}});
  EXPECT_THAT(scaled, Not(HasSubstr("STEEL_")));
  EXPECT_THAT(PropertiesOrFail(scaled)[2].stiffness,
              ElementsAre(4.2e11, 4.0e11));
}

TEST(DeckPropertiesTest, IncludesAreWrittenOut) {
  TemporaryFolder folder;
  const std::string deck = kDeck;
  const size_t from = deck.find("*MATERIAL,NAME=WOOD");
  const size_t to = deck.find("*SOLID SECTION");
  folder.Write("wood.inp", deck.substr(from, to - from));
  const std::string path = folder.Write(
      "bridge.inp",
      deck.substr(0, from) + "*INCLUDE,INPUT=wood.inp\n" + deck.substr(to));
  std::string content, scaled, error;
  ASSERT_TRUE(ReadTextFile(path, &content, &error));
  ASSERT_TRUE(ScaleDeck(path, content, {}, &scaled, &error)) << error;
  EXPECT_EQ(scaled, deck);
}

TEST(DeckPropertiesTest, RefusesWhatItWouldGetWrong) {
  EXPECT_THAT(ScalingErrorOf({{"nobody", false, 2.0}}),
              HasSubstr("no such set"));
  EXPECT_THAT(ScalingErrorOf({{"half_deck", false, 2.0}}),
              HasSubstr("'deck' has elements outside of it"));
  EXPECT_THAT(ScalingErrorOf({{"mid", false, 2.0}, {"all_steel", false, 3.0}}),
              HasSubstr("'mid' has another factor already"));
  EXPECT_THAT(ScalingErrorOf({{"mid", false, -1.0}}),
              HasSubstr("not positive"));
  EXPECT_THAT(ScalingErrorOf({{"ballast", false, 2.0}}),
              HasSubstr("nothing of that kind"));
  EXPECT_THAT(ScalingErrorOf({{"stay", true, 2.0}}),
              HasSubstr("nothing of that kind"));
  const std::string deck = kDeck;
  const auto with = [&deck](const std::string& from, const std::string& to) {
    std::string other = deck;
    other.replace(other.find(from), from.size(), to);
    return other;
  };
  EXPECT_THAT(
      ScalingErrorOf({{"deck", false, 2.0}},
                     with("TYPE=ENGINEERING CONSTANTS", "TYPE=TRACTION")),
      HasSubstr("bridge.inp:37: *ELASTIC, TYPE=TRACTION"));
  EXPECT_THAT(ScalingErrorOf({{"low", false, 2.0}}, with("2.1E11", "two")),
              HasSubstr("'two', expected a number"));
  EXPECT_THAT(
      ScalingErrorOf({{"low", false, 2.0}}, with("*DAMPING", "*HOURGLASS")),
      HasSubstr("*HOURGLASS after a material"));
  EXPECT_THAT(
      ScalingErrorOf({{"deck", false, 2.0}}, with("*BEAM SECTION,ELSET=deck,",
                                                  "*BEAM GENERAL SECTION,")),
      HasSubstr("without a section"));
  EXPECT_THAT(
      ScalingErrorOf({{"low", false, 2.0}}, with("TYPE=B31", "TYPE=ODD7")),
      HasSubstr("ODD7"));
  EXPECT_THAT(ScalingErrorOf({{"low", false, 2.0}},
                             with("MATERIAL=wood", "MATERIAL=x")),
              HasSubstr("no *MATERIAL of that name"));
}

// Returns kDeck with `from` replaced by `to`.
std::string DeckWith(const std::string& from, const std::string& to) {
  std::string other = kDeck;
  other.replace(other.find(from), from.size(), to);
  return other;
}

// Elements of a composite, of a general section and of an unknown section, all
// of the steel of the bars.
TEST(DeckPropertiesTest, WhatCompositesUseStaysAsItIs) {
  for (const char* section :
       {"*SHELL SECTION,ELSET=skin,COMPOSITE\n.1,,wood\n.2,,steel,axes\n",
        "*SHELL GENERAL SECTION,ELSET=skin,MATERIAL=Steel\n.1\n",
        "*COHESIVE SECTION,ELSET=skin,MATERIAL=steel\n.1\n",
        "*GASKET SECTION,ELSET=skin\n.1,STEEL\n"}) {
    const std::string deck =
        DeckWith("*MATERIAL, NAME=Steel",
                 std::string("*ELEMENT,TYPE=S4,ELSET=skin\n20,1,2,3,4\n") +
                     section + "*MATERIAL, NAME=Steel");
    const std::string scaled = ScaledOrFail({{"all_steel", false, 2.0}}, deck);
    EXPECT_THAT(scaled, HasSubstr("Steel\n*ELASTIC\n** at two temperatures\n"
                                  "2.1E11, 0.3, 20.\n"))
        << section;
    EXPECT_THAT(scaled, HasSubstr(section));
    EXPECT_THAT(scaled, HasSubstr("ELSET=low,MATERIAL=STEEL_LOW\n"));
    for (size_t i = 0; i < 3; ++i) {
      EXPECT_THAT(PropertiesOrFail(scaled)[i].stiffness,
                  ElementsAre(4.2e11, 4.0e11))
          << section;
    }
    for (const bool mass : {false, true}) {
      EXPECT_THAT(ScalingErrorOf({{"skin", mass, 2.0}}, deck),
                  HasSubstr("without a section"))
          << section;
    }
  }
  EXPECT_THAT(
      ScalingErrorOf({{"low", false, 2.0}},
                     DeckWith("*STEP\n", "*CHANGE MATERIAL,NAME=steel\n")),
      HasSubstr("bridge.inp:60: *CHANGE MATERIAL uses material 'STEEL'"));
}

TEST(DeckPropertiesTest, OnlyWhatHasNoMassIsPassedOver) {
  const auto with_set = [](const std::string& members) {
    return DeckWith("*ELSET,ELSET=half_deck",
                    "*ELEMENT,TYPE=S4,ELSET=skin\n20,1,2,3,4\n"
                    "*ELSET,ELSET=part\n" +
                        members + "\n*ELSET,ELSET=half_deck");
  };
  std::string deck = with_set("low,skin");
  for (const char* section :
       {"*SHELL GENERAL SECTION,ELSET=skin\n.1\n",
        "*SHELL SECTION,ELSET=skin,COMPOSITE\n.1,,wood\n", ""}) {
    EXPECT_THAT(ScalingErrorOf({{"part", true, 2.0}}, section + deck),
                HasSubstr("the mass of element set 'part' cannot be changed"))
        << section;
  }
  const std::string light =
      "*MATERIAL,NAME=foil\n*ELASTIC\n1e5,.3\n"
      "*SHELL SECTION,ELSET=skin,MATERIAL=foil\n.1\n";
  EXPECT_THAT(
      PropertiesOrFail(ScaledOrFail({{"part", true, 2.0}}, light + deck))[1]
          .mass,
      ElementsAre(15700.0));
  deck = DeckWith("*MATERIAL, NAME=Steel",
                  "*ELSET,ELSET=part\nlow,stay,soil\n*MATERIAL, NAME=Steel");
  EXPECT_THAT(
      PropertiesOrFail(ScaledOrFail({{"part", true, 2.0}}, deck))[0].mass,
      ElementsAre(15700.0));
}

TEST(DeckPropertiesTest, DataInOtherFilesAreRefused) {
  EXPECT_THAT(
      ScalingErrorOf({{"low", false, 2.0}},
                     DeckWith("*STEP\n", "*AMPLITUDE,NAME=a,INPUT=a.txt\n")),
      HasSubstr("bridge.inp:60: *AMPLITUDE has INPUT"));
}

TEST(DeckPropertiesTest, CopiesOfQuotedNamesAreQuoted) {
  std::string deck = kDeck;
  for (const char* name : {"NAME=Steel", "=STEEL", "=steel", "=steel"}) {
    const std::string text = name;
    deck.replace(deck.find(text), text.size(),
                 text.substr(0, text.find('=')) + "=\"ST 37\"");
  }
  std::string scaled = ScaledOrFail({{"low", false, 2.0}}, deck);
  EXPECT_THAT(scaled, HasSubstr("*MATERIAL,NAME=\"ST 37_LOW\"\n"));
  EXPECT_THAT(scaled, HasSubstr("ELSET=low,MATERIAL=\"ST 37_LOW\"\n"));
  EXPECT_THAT(PropertiesOrFail(scaled)[0].stiffness,
              ElementsAre(4.2e11, 4.0e11));
  // The name of the copy comes from the set alone, and is not too long for
  // decks.
  deck = kDeck;
  const std::string set = '"' + std::string(76, 'A') + '"';
  for (size_t at = deck.find("=low"); at != std::string::npos;
       at = deck.find("=low")) {
    deck.replace(at + 1, 3, set);
  }
  deck.replace(deck.find("low, mid"), 3, "mid");
  scaled = ScaledOrFail({{set, false, 2.0}}, deck);
  EXPECT_THAT(scaled, HasSubstr("*MATERIAL,NAME=\"STEEL_" +
                                std::string(72, 'A') + "\"\n"));
}

TEST(DeckPropertiesTest, MassesThatAreNotIsotropicAreRefused) {
  EXPECT_THAT(
      ScalingErrorOf({{"ballast", true, 2.0}},
                     DeckWith("*MASS,ELSET=ballast\n120.",
                              "*MASS,ELSET=ballast,TYPE=ANISOTROPIC\n1.,2.")),
      HasSubstr("bridge.inp:58: *MASS, TYPE=ANISOTROPIC"));
  EXPECT_THAT(PropertiesOrFail(ScaledOrFail(
                  {{"ballast", true, 2.0}},
                  DeckWith("ELSET=ballast\n120.",
                           "ELSET=ballast,TYPE=isotropic\n120.")))[6]
                  .mass,
              ElementsAre(240.0));
}

// Abaqus' masses of paving and cladding, in total or by size.
TEST(DeckPropertiesTest, NonstructuralMassesAreMassesOfTheirSets) {
  const std::string deck =
      DeckWith("*STEP\n",
               "*NONSTRUCTURAL MASS, ELSET=deck, UNITS=TOTAL MASS\n900.\n"
               "*Nonstructural Mass,Units=Mass Per "
               "Volume,Elset=all_steel\n12.5\n*STEP\n");
  const std::vector<DeckProperty> properties = PropertiesOrFail(deck);
  ASSERT_EQ(properties.size(), 9u);
  EXPECT_EQ(properties[7].set, "deck");
  EXPECT_THAT(properties[7].mass, ElementsAre(900.0));
  EXPECT_THAT(properties[7].stiffness, ElementsAre());
  EXPECT_THAT(properties[8].mass, ElementsAre(12.5));

  // The mass follows the density of the same elements. A factor of stiffness
  // does not change it.
  const std::vector<DeckProperty> scaled = PropertiesOrFail(
      ScaledOrFail({{"deck", true, 2.0}, {"deck", false, 3.0}}, deck));
  EXPECT_THAT(scaled[3].mass, ElementsAre(900.0));
  EXPECT_THAT(scaled[7].mass, ElementsAre(1800.0));
  EXPECT_THAT(scaled[8].mass, ElementsAre(12.5));
  // Mass beyond the set's edge cannot be separated.
  EXPECT_THAT(ScalingErrorOf({{"low", true, 2.0}}, deck),
              HasSubstr("'all_steel' has elements outside"));
  EXPECT_THAT(
      PropertiesOrFail(ScaledOrFail({{"all_steel", true, 2.0}}, deck))[8].mass,
      ElementsAre(25.0));
  // Elements without a density have only this mass.
  std::string without = deck;
  const std::string density = "*DENSITY\n450\n";
  without.erase(without.find(density), density.size());
  const std::vector<DeckProperty> light =
      PropertiesOrFail(ScaledOrFail({{"deck", true, 2.0}}, without));
  EXPECT_THAT(light[3].mass, ElementsAre());
  EXPECT_THAT(light[7].mass, ElementsAre(1800.0));
}

// The copy of a shared material is inserted in front of a material.
TEST(DeckPropertiesTest, NonstructuralMassesMayStandBehindMaterials) {
  const std::string deck =
      DeckWith("*MATERIAL,NAME=WOOD",
               "*NONSTRUCTURAL MASS,ELSET=mid,UNITS=MASS PER VOLUME\n5.\n"
               "*MATERIAL,NAME=WOOD");
  const std::vector<DeckProperty> scaled =
      PropertiesOrFail(ScaledOrFail({{"low", false, 2.0}}, deck));
  EXPECT_THAT(scaled[0].mass, ElementsAre(5.0));
  EXPECT_EQ(scaled[1].set, "low");
  EXPECT_THAT(scaled[1].stiffness, ElementsAre(4.2e11, 4.0e11));
  EXPECT_THAT(scaled[2].stiffness, ElementsAre(2.1e11, 2.0e11));
}

// Constants at two temperatures, as whole numbers.
TEST(DeckPropertiesTest, ConstantsOfSpringsAreNoDirections) {
  const std::string deck =
      DeckWith("ELSET=stay,NONLINEAR\n-10.,-1.\n0.,0.\n20.,1.",
               "ELSET=stay\n1000,,20\n5,,40");
  EXPECT_THAT(PropertiesOrFail(deck)[4].stiffness, ElementsAre(1000.0, 5.0));
  // A set of its own with unknown types.
  const auto of_set = [](const std::string& data) {
    return DeckWith(
        "*SPRING,ELSET=soil\n2\n",
        "*ELSET,ELSET=ground\nsoil\n*SPRING,ELSET=ground\n" + data + "\n");
  };
  for (const char* line : {"1000,,20", "7", "1,2,3", ",", "1,0"}) {
    EXPECT_THAT(ScalingErrorOf({{"ground", false, 2.0}}, of_set(line)),
                HasSubstr("bridge.inp:57: *SPRING begins with '" +
                          std::string(line) + "', expected directions"))
        << line;
  }
  for (const char* line : {"2", "2,", "1, 6"}) {
    EXPECT_THAT(PropertiesOrFail(of_set(line))[5].stiffness,
                ElementsAre(5000.0))
        << line;
  }
}

// The type of the elements defines the first line, whatever set they are in.
TEST(DeckPropertiesTest, SpringsAreWhatTheirElementsAre) {
  const auto of_set = [](const std::string& members) {
    return DeckWith(
        "*SPRING,ELSET=soil\n2\n5000.\n",
        "*ELEMENT,TYPE=SPRING1\n30,2\n*ELEMENT,TYPE=SPRINGA\n31,2,3\n"
        "*ELSET,ELSET=ties\n" +
            members + "\n*SPRING,ELSET=ties,NONLINEAR\n1,1\n2,2\n3,3\n");
  };
  EXPECT_THAT(PropertiesOrFail(of_set("31"))[5].stiffness,
              ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(PropertiesOrFail(of_set("30"))[5].stiffness,
              ElementsAre(2.0, 3.0));
  // A spring to the ground is a point but has stiffness.
  EXPECT_THAT(
      ScalingErrorOf({{"both", false, 2.0}},
                     "*ELSET,ELSET=both\nstay,soil\n" +
                         DeckWith("*SPRING,ELSET=soil\n2\n5000.\n", "")),
      HasSubstr("elements without a section"));
}

TEST(DeckPropertiesTest, SetsMayNameWhatStandsBelow) {
  for (const char* set :
       {"*ELSET,ELSET=all\n1,2,4,5\n", "*ELSET,ELSET=all,GENERATE\n1,5\n",
        "*ELSET,ELSET=all\nlater,1,2\n"}) {
    std::string deck = set + DeckWith("*SOLID SECTION,ELSET=low",
                                      "*ELSET,ELSET=later\ndeck,all\n"
                                      "*SOLID SECTION,ELSET=all");
    EXPECT_THAT(ScalingErrorOf({{"low", false, 2.0}}, deck),
                HasSubstr("'all' has elements outside of it"))
        << set;
  }
}

TEST(DeckPropertiesTest, UnknownKeywordsEndNoMaterial) {
  for (const char* keyword :
       {"*CONCRETE DAMAGED PLASTICITY", "*NOBODY KNOWS"}) {
    const std::string deck = DeckWith(
        "*DENSITY\n450", keyword + std::string("\n36,.1\n*DENSITY\n450"));
    EXPECT_THAT(PropertiesOrFail(deck)[3].mass, ElementsAre(450.0));
    const std::string scaled = ScaledOrFail({{"deck", true, 2.0}}, deck);
    EXPECT_THAT(PropertiesOrFail(scaled)[3].mass, ElementsAre(900.0));
    EXPECT_THAT(scaled, HasSubstr("\n36,.1\n"));
  }
  // Sections do not end a material either, as CalculiX reads it; but then it
  // cannot be copied.
  const std::string apart = DeckWith(
      "*DENSITY\n7850.\n*DAMPING, ALPHA=0.5\n",
      "*SOLID SECTION,ELSET=low,MATERIAL=steel\n1e-3\n*DENSITY\n7850.\n");
  const std::string without_twin =
      apart.substr(0, apart.find("*SOLID SECTION,ELSET=low,MATERIAL=STEEL")) +
      apart.substr(apart.find("*SOLID SECTION,ELSET=mid"));
  EXPECT_THAT(PropertiesOrFail(
                  ScaledOrFail({{"all_steel", true, 2.0}}, without_twin))[0]
                  .mass,
              ElementsAre(15700.0));
  EXPECT_THAT(ScalingErrorOf({{"low", true, 2.0}}, without_twin),
              HasSubstr("*DENSITY after a material"));
}

TEST(DeckPropertiesTest, WhatSectionsHaveOfTheirOwnIsRefused) {
  const auto with = [](const std::string& keyword) {
    return DeckWith(".2,.3\n0,0,1\n", ".2,.3\n0,0,1\n" + keyword + "\n3.,3.\n");
  };
  const auto error = [&with](const std::string& keyword, bool mass) {
    return ScalingErrorOf({{"deck", mass, 2.0}}, with(keyword));
  };
  EXPECT_THAT(error("*Transverse Shear Stiffness", false),
              HasSubstr("the section of 'deck' has *TRANSVERSE SHEAR STIFFNESS "
                        "(bridge.inp:51)"));
  EXPECT_THAT(error("*BEAM ADDED INERTIA", true), HasSubstr("*BEAM ADDED"));
  EXPECT_THAT(error("*REBAR LAYER", true), HasSubstr("*REBAR LAYER"));
  EXPECT_THAT(error("*REBAR LAYER", false), HasSubstr("*REBAR LAYER"));
  EXPECT_THAT(error("*REBAR,ELEMENT=BEAM", false), HasSubstr("*REBAR"));
  // The keyword may stay if it does not affect the scaled property.
  ScaledOrFail({{"deck", true, 2.0}}, with("*TRANSVERSE SHEAR STIFFNESS"));
  ScaledOrFail({{"deck", false, 2.0}}, with("*BEAM ADDED INERTIA"));
  ScaledOrFail({{"mid", false, 2.0}}, with("*REBAR LAYER"));
}

TEST(DeckPropertiesTest, RotaryInertiasAreMasses) {
  const std::string deck =
      DeckWith("*MASS,ELSET=ballast",
               "*ELEMENT,TYPE=ROTARYI,ELSET=ballast\n9,4\n"
               "*ROTARY INERTIA,ELSET=ballast\n1.,2.,3.,,.5,.25\n"
               "*MASS,ELSET=ballast");
  const std::vector<DeckProperty> scaled =
      PropertiesOrFail(ScaledOrFail({{"ballast", true, 2.0}}, deck));
  EXPECT_THAT(scaled[6].mass, ElementsAre(2.0, 4.0, 6.0, 1.0, 0.5));
  EXPECT_THAT(scaled[7].mass, ElementsAre(240.0));
}

// CalculiX ignores blanks in keywords, parameters and names.
TEST(DeckPropertiesTest, BlanksMakeNoDifference) {
  std::string deck = DeckWith("*SOLID SECTION,ELSET=mid,MATERIAL=steel",
                              "*SOLIDSECTION,ELSET= m id,MATERIAL=st eel");
  deck.replace(deck.find("TYPE=ENGINEERING CONSTANTS"), 26,
               "T YPE=ENGINEERINGCONSTANTS");
  const std::vector<DeckProperty> scaled = PropertiesOrFail(
      ScaledOrFail({{"mid", false, 2.0}, {"deck", false, 2.0}}, deck));
  EXPECT_THAT(scaled[1].stiffness, ElementsAre(4.2e11, 4.0e11));
  EXPECT_THAT(scaled[0].stiffness, ElementsAre(2.1e11, 2.0e11));
  EXPECT_THAT(scaled[3].stiffness,
              ElementsAre(2.2e10, 16e8, 10e8, 12e8, 10e8, 8e7));
}

TEST(DeckPropertiesTest, LineEndsStayAsTheyAre) {
  const auto windows = [](std::string text) {
    ReplaceAll("\n", "\r\n", &text);
    return text;
  };
  const std::vector<DeckFactor> factors = {{"mid", false, 0.8},
                                           {"low", true, 1.5},
                                           {"deck", false, 1.1},
                                           {"soil", false, 3.0},
                                           {"ballast", true, 0.9}};
  const std::string scaled = ScaledOrFail(factors);
  std::string deck = windows(kDeck);
  EXPECT_EQ(ScaledOrFail(factors, deck), windows(scaled));
  deck.resize(deck.size() - 2);
  EXPECT_EQ(ScaledOrFail(factors, deck), windows(scaled));
}

TEST(DeckPropertiesTest, CommentsMayBeInAnyEncoding) {
  const std::string deck =
      "*HEADING\n\xDC"
      "bersicht\n** Gr\xF6\xDF"
      "e\n" +
      std::string(kDeck);
  EXPECT_EQ(ScaledOrFail({}, deck), deck);
  EXPECT_THAT(ScaledOrFail({{"mid", false, 2.0}}, deck),
              HasSubstr("\n** Gr\xF6\xDF"
                        "e\n"));
  for (const char* place : {"low, mid", "NAME=Steel", "2.1E11"}) {
    EXPECT_THAT(ScalingErrorOf({}, DeckWith(place, "\xFC")),
                HasSubstr("not valid UTF-8"));
  }
}

}  // namespace
}  // namespace pinode
