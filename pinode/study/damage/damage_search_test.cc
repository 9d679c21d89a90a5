#include "pinode/study/damage/damage_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/study_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;

TEST(DamageSearch, LooksWhereSensorsAndSpringsAre) {
  IdentificationProblem problem =
      MeasuredChain(2, *ChainAt(Vector{{0.0, 0.0}}), 1);
  problem.records[0].channels.pop_back();
  const DamageSearch search = LookEverywhere(problem);
  // The mass that no sensor is at comes after those that are measured.
  ASSERT_EQ(search.masses.size(), 2u);
  EXPECT_EQ(search.masses[0].name, "u1");
  EXPECT_THAT(search.masses[0].dofs, ElementsAre(0));
  EXPECT_EQ(search.masses[1].name, "u2");
  ASSERT_EQ(search.springs.size(), 2u);
  EXPECT_EQ(search.springs[0].name, "k1");
  EXPECT_EQ(search.springs[0].from, Feature::kGround);
  EXPECT_EQ(search.springs[0].to, 0);
  EXPECT_EQ(search.springs[1].from, 0);
  EXPECT_EQ(search.springs[1].to, 1);
  std::string error;
  EXPECT_TRUE(search.IsValid(problem.dynamics->model(), &error)) << error;
}

TEST(DamageSearch, TranslationsOfANodeAreOneMass) {
  StructuralModel model =
      MakeStructuralModel(Matrix::Identity(3, 3), Matrix::Zero(3, 3),
                          Matrix::Identity(3, 3), {"12.1", "12.2", "12.6"});
  EXPECT_THAT(PlaceOfMass(model, "12").dofs, ElementsAre(0, 1));
  EXPECT_TRUE(PlaceOfMass(model, "13").dofs.empty());
}

}  // namespace
}  // namespace pinode
