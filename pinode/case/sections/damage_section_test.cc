#include "pinode/case/sections/damage_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "pinode/case/sections/case_file.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class DamageSection : public ::testing::Test {
 protected:
  void SetUp() override { folder_.Write("quake.csv", SmallRecord()); }

  bool Read(const std::string& section, Case* c) {
    error_.clear();
    return ReadCase(folder_.Write("case.toml", case_ + section), c, &error_);
  }
  std::string Refusal(const std::string& section) {
    Case c;
    EXPECT_FALSE(Read(section, &c)) << section;
    return error_;
  }

  std::string case_ = SmallCase();
  TemporaryFolder folder_;
  std::string error_;
};

TEST_F(DamageSection, LooksWhereSensorsAndSpringsAre) {
  Case c;
  ASSERT_TRUE(Read("", &c)) << error_;
  ASSERT_EQ(c.damage.masses.size(), 2u);
  EXPECT_EQ(c.damage.masses[0].name, "u1");
  EXPECT_THAT(c.damage.masses[1].dofs, ElementsAre(1));
  ASSERT_EQ(c.damage.springs.size(), 1u);
  EXPECT_EQ(c.damage.springs[0].name, "k1");
  EXPECT_EQ(c.damage.springs[0].from, Feature::kGround);
  EXPECT_EQ(c.damage.springs[0].to, 0);
}

TEST_F(DamageSection, AGroupOfSeveralSpringsIsNoPlace) {
  case_ = Replaced(case_, "between = [\"ground\", \"u1\"]\nscale = 200.0",
                   "matrix = [[3.0, -1.0], [-1.0, 1.0]]");
  Case c;
  ASSERT_TRUE(Read("", &c)) << error_;
  EXPECT_TRUE(c.damage.springs.empty());
  // One between two DOFs is.
  case_ = Replaced(case_, "[[3.0, -1.0]", "[[1.0, -1.0]");
  ASSERT_TRUE(Read("", &c)) << error_;
  ASSERT_EQ(c.damage.springs.size(), 1u);
  EXPECT_EQ(c.damage.springs[0].from, 0);
  EXPECT_EQ(c.damage.springs[0].to, 1);
}

TEST_F(DamageSection, TranslationsOfANodeAreOneMass) {
  for (const char* key : {"u1", "u2"}) {
    while (case_.find(std::string("\"") + key + "\"") != std::string::npos) {
      case_ = Replaced(case_, std::string("\"") + key + "\"",
                       key[1] == '1' ? "\"12.1\"" : "\"12.2\"");
    }
  }
  Case c;
  ASSERT_TRUE(Read("", &c)) << error_;
  ASSERT_EQ(c.damage.masses.size(), 1u);
  EXPECT_EQ(c.damage.masses[0].name, "12");
  EXPECT_THAT(c.damage.masses[0].dofs, ElementsAre(0, 1));
}

TEST_F(DamageSection, TakesPlacesAsGiven) {
  Case c;
  ASSERT_TRUE(
      Read("[damage]\nmasses = [\"u2\"]\n[[damage.place]]\nname = "
           "\"joint\"\nbetween = [\"u2\", \"ground\"]\n",
           &c))
      << error_;
  ASSERT_EQ(c.damage.masses.size(), 1u);
  EXPECT_EQ(c.damage.masses[0].name, "u2");
  ASSERT_EQ(c.damage.springs.size(), 1u);
  EXPECT_EQ(c.damage.springs[0].name, "joint");
  EXPECT_EQ(c.damage.springs[0].from, Feature::kGround);
  EXPECT_EQ(c.damage.springs[0].to, 1);

  ASSERT_TRUE(Read("[damage]\nkinds = []\n", &c)) << error_;
  EXPECT_TRUE(c.damage.masses.empty());
  EXPECT_TRUE(c.damage.springs.empty());
  EXPECT_FALSE(c.damage.stiffness);
  ASSERT_TRUE(Read("[damage]\nkinds = [\"stiffness\"]\n", &c)) << error_;
  EXPECT_TRUE(c.damage.stiffness);
  EXPECT_TRUE(c.damage.masses.empty());
  ASSERT_TRUE(Read("[damage]\nkinds = [\"mass\"]\n", &c)) << error_;
  EXPECT_FALSE(c.damage.stiffness);
  EXPECT_EQ(c.damage.masses.size(), 2u);
  EXPECT_TRUE(c.damage.springs.empty());
}

TEST_F(DamageSection, RefusesWhatItDoesNotKnow) {
  EXPECT_THAT(Refusal("[damage]\nkind = []\n"), HasSubstr("'kinds'"));
  EXPECT_THAT(Refusal("[damage]\nkinds = [\"nonlinaer\"]\n"),
              HasSubstr("did you mean 'nonlinear'"));
  EXPECT_THAT(Refusal("[damage]\nmasses = [\"u7\"]\n"),
              HasSubstr("'u7' is neither a DOF nor a node"));
  EXPECT_THAT(Refusal("[damage]\nkinds = [\"nonlinear\"]\nmasses = [\"u1\"]\n"),
              HasSubstr("needs mass among the 'kinds'"));
  EXPECT_THAT(Refusal("[[damage.place]]\nname = \"joint\"\n"),
              HasSubstr("between"));
  EXPECT_THAT(
      Refusal("[[damage.place]]\nname = \"a\"\nbetween = [\"u1\", \"u2\"]\n"
              "[[damage.place]]\nname = \"a\"\nbetween = [\"u1\", \"u2\"]\n"),
      HasSubstr("another [[damage.place]] has this name"));
}

}  // namespace
}  // namespace pinode
