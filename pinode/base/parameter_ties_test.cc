#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pinode/base/parameter_block.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

Parameter Named(const std::string& name) {
  Parameter parameter;
  parameter.name = name;
  return parameter;
}

Parameter Tied(const std::string& name, const std::string& to,
               double factor = 1.0) {
  Parameter parameter = Named(name);
  parameter.free = false;
  parameter.tie = to;
  parameter.tie_factor = factor;
  return parameter;
}

class Ties : public ::testing::Test {
 protected:
  std::vector<const ParameterBlock*> Blocks() const {
    return {&groups_, &laws_};
  }
  std::string Refusal() const {
    std::string name;
    std::string error;
    return AreTiesValid(Blocks(), &name, &error) ? "" : name + ": " + error;
  }

  ParameterBlock groups_{"groups", {Named("k1"), Named("k2")}, {}, true};
  ParameterBlock laws_{"law", {Named("law.c")}, {}, true};
};

TEST_F(Ties, ValuesFollowAcrossBlocks) {
  groups_.parameters[0] = Tied("k1", "law.c", -0.5);
  EXPECT_EQ(Refusal(), "");
  const std::vector<ParameterTie> ties = FindTies(Blocks());
  ASSERT_EQ(ties.size(), 1u);
  EXPECT_EQ(ties[0].parameter, 0);
  EXPECT_EQ(ties[0].source, 2);
  Vector values(3);
  values << 7.0, 8.0, 9.0;
  ApplyTies(ties, values.data());
  EXPECT_EQ(values[0], -4.5);
  EXPECT_EQ(values[1], 8.0);
}

TEST_F(Ties, FreeParametersFollowNothing) {
  groups_.parameters[0] = Tied("k1", "law.c");
  groups_.parameters[0].free = true;
  EXPECT_TRUE(FindTies(Blocks()).empty());
}

TEST_F(Ties, RefusalsSayWhatToDo) {
  groups_.parameters[0] = Tied("k1", "k3");
  EXPECT_THAT(Refusal(), HasSubstr("k1: no unknown is named 'k3', expected one "
                                   "of k2, law.c"));
  EXPECT_TRUE(FindTies(Blocks()).empty());
  groups_.parameters[0] = Tied("k1", "k1");
  EXPECT_THAT(Refusal(), HasSubstr("tied to itself"));
  groups_.parameters[0] = Tied("k1", "k2", 0.0);
  EXPECT_THAT(Refusal(), HasSubstr("'tie_factor' is 0"));
  groups_.parameters[0] = Tied("k1", "k2");
  groups_.parameters[1] = Tied("k2", "law.c");
  EXPECT_THAT(Refusal(), HasSubstr("k1: 'k2' is tied itself; tie to 'law.c'"));
  groups_.parameters[1] = Tied("k2", "k1");
  EXPECT_THAT(Refusal(), HasSubstr("circle"));
}

TEST_F(Ties, BoundsOfTheSourceMustFit) {
  groups_.parameters[0] = Tied("k1", "k2", -1.0);
  groups_.parameters[0].lower = 0.0;
  groups_.parameters[1].value = -1.0;
  EXPECT_THAT(Refusal(), HasSubstr("change 'tie_factor', or the bounds of "
                                   "'k2'"));
  groups_.parameters[1].upper = 0.0;
  EXPECT_EQ(Refusal(), "");
}

}  // namespace
}  // namespace pinode
