#include "pinode/discover/coefficient_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Constraint = CoefficientConstraint;

const std::vector<std::string>& Names() {
  static const auto& names =
      *new std::vector<std::string>{"a", "b", "c", "d", "e"};
  return names;
}

CoefficientMap Created(const std::vector<Constraint>& constraints) {
  CoefficientMap map;
  std::string error;
  EXPECT_TRUE(CoefficientMap::Create(Names(), constraints, &map, &error))
      << error;
  return map;
}

TEST(CoefficientMap, WithoutConstraintsIsTheIdentity) {
  const CoefficientMap map = Created({});
  ASSERT_EQ(map.num_free(), 5);
  const Vector g = Vector::LinSpaced(5, 1.0, 5.0);
  EXPECT_EQ(map.Expand(g), g);
  EXPECT_THAT(map.signs(), ElementsAre(0, 0, 0, 0, 0));
  EXPECT_THAT(map.ExpandSupport({1, 4}), ElementsAre(1, 4));
  EXPECT_THAT(map.ReduceSupport({4, 1}), ElementsAre(1, 4));
}

TEST(CoefficientMap, BindsGivesAndSigns) {
  const CoefficientMap map = Created(
      {Constraint::Equal({"b", "d"}, {0.5, -2.0}), Constraint::Given("c", 7.0),
       Constraint::Positive("d"), Constraint::Negative("e")});
  // Unknowns: a; b = 0.5 g1, d = -2 g1; e.
  ASSERT_EQ(map.num_free(), 3);
  EXPECT_THAT(map.signs(), ElementsAre(0, -1, -1));
  EXPECT_EQ(map.Expand((Vector(3) << 1.0, -3.0, -5.0).finished()),
            (Vector(5) << 1.0, -1.5, 7.0, 6.0, -5.0).finished());
  EXPECT_THAT(map.ExpandSupport({1}), ElementsAre(1, 3));
  EXPECT_THAT(map.ReduceSupport({1, 2, 3}), ElementsAre(1));
}

TEST(CoefficientMap, AGivenMemberGivesItsWholeEquality) {
  const CoefficientMap map = Created(
      {Constraint::Given("d", 6.0), Constraint::Given("b", -1.5),
       Constraint::Equal({"b", "d"}, {0.5, -2.0}), Constraint::Positive("d")});
  EXPECT_EQ(map.num_free(), 3);
  EXPECT_EQ(map.Expand(Vector::Zero(3)),
            (Vector(5) << 0.0, -1.5, 0.0, 6.0, 0.0).finished());
}

TEST(CoefficientMap, AllMayBeGiven) {
  CoefficientMap map;
  std::string error;
  ASSERT_TRUE(CoefficientMap::Create({"a"}, {Constraint::Given("a", 2.0)}, &map,
                                     &error));
  EXPECT_EQ(map.num_free(), 0);
  EXPECT_EQ(map.Expand(Vector())[0], 2.0);
}

TEST(CoefficientMap, RefusesContradictions) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<std::vector<Constraint>, std::string>> examples =
      {
          {{Constraint::Given("aa", 1.0)},
           "unknown coefficient 'aa'; did you mean 'a'?"},
          {{Constraint::Given("a", kNan)}, "'a' given as nan"},
          {{Constraint::Given("a", 1.0), Constraint::Given("a", 2.0)},
           "'a' is given two values"},
          {{Constraint::Equal({"a", "b"}), Constraint::Given("a", 1.0),
            Constraint::Given("b", 2.0)},
           "'b' is given two values"},
          {{Constraint::Positive("a"), Constraint::Negative("a")},
           "'a' is to be both"},
          {{Constraint::Equal({"a", "b"}, {1.0, -1.0}),
            Constraint::Positive("a"), Constraint::Positive("b")},
           "'b' is to be both"},
          {{Constraint::Given("a", 1.0), Constraint::Negative("a")},
           "'a' is given a value of another sign"},
          {{Constraint::Equal({"a"})}, "an equality of 1 coefficients"},
          {{Constraint::Equal({"a", "b"}, {1.0})}, "with 1 factors"},
          {{Constraint::Equal({"a", "b"}, {1.0, 0.0})}, "factor 0 of 'b'"},
          {{Constraint::Equal({"a", "a"})}, "'a' is in two"},
          {{Constraint::Equal({"a", "b"}), Constraint::Equal({"b", "c"})},
           "'b' is in two"},
      };
  for (const auto& [constraints, message] : examples) {
    CoefficientMap map = Created({});
    std::string error;
    EXPECT_FALSE(CoefficientMap::Create(Names(), constraints, &map, &error));
    EXPECT_THAT(error, HasSubstr(message));
    EXPECT_EQ(map.num_free(), 5) << "touched";
  }
}

}  // namespace
}  // namespace pinode
