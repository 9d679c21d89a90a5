#include "pinode/case/ambient_section.h"

#include <cmath>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/temporary_folder_testing.h"
#include "pinode/case/testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string AmbientCase(const std::string& loads) {
  return R"([model]
dofs = ["u1", "u2"]
mass = {diagonal = [2.0, 1.0]}
stiffness = [[800.0, -400.0], [-400.0, 400.0]]
damping = {rayleigh = [0.1, 0.001]}
[[group]]
name = "k1"
adds_to = "stiffness"
between = ["ground", "u1"]
[[record]]
name = "wind"
file = "wind.csv"
sampling_rate_hz = 20
excitation = "ambient"
[record.ambient]
)" + loads +
         R"(
[[record.channel]]
column = "a1"
dof = "u1"
quantity = "absolute_acceleration"
unit = "m/s^2"
[[record.channel]]
column = "a2"
dof = "u2"
quantity = "absolute_acceleration"
unit = "m/s^2"
)";
}

class AmbientSectionTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string text = "a1,a2\n";
    for (int i = 0; i < 1000; ++i) {
      text += std::to_string(std::sin(0.7 * i) + std::sin(0.31 * i * i)) + "," +
              std::to_string(std::cos(0.3 * i) + std::sin(0.17 * i * i)) + "\n";
    }
    folder_.Write("wind.csv", text);
  }
  AmbientRecord Read(const std::string& loads) {
    const Case c = ReadOrFail(folder_.Write("case.toml", AmbientCase(loads)));
    return c.problem.ambient.empty() ? AmbientRecord()
                                     : c.problem.ambient.front();
  }
  std::string Error(const std::string& loads) {
    Case c;
    std::string error;
    EXPECT_FALSE(
        ReadCase(folder_.Write("case.toml", AmbientCase(loads)), &c, &error))
        << loads;
    return error;
  }

  TemporaryFolder folder_;
};

TEST_F(AmbientSectionTest, LoadsAtDofs) {
  const AmbientRecord record = Read("dofs = [\"u2\"]\nknots = 3");
  EXPECT_THAT(record.areas, ElementsAre("u2"));
  EXPECT_EQ(record.loads, Matrix(Vector::Unit(2, 1)));
  EXPECT_EQ(record.knots, 3);
  EXPECT_TRUE(record.correlated);
  EXPECT_THAT(Error("dofs = [\"u3\"]"), HasSubstr("'u3'"));
}

TEST_F(AmbientSectionTest, LoadsOfAreas) {
  const AmbientRecord record = Read(
      "areas = {deck = [\"u1\", \"u2\"], pier = {u1 = 0.5}}\n"
      "correlated = false");
  EXPECT_THAT(record.areas, ElementsAre("deck", "pier"));
  ASSERT_EQ(record.loads.cols(), 2);
  EXPECT_EQ(record.loads.col(0), Vector::Ones(2));
  EXPECT_EQ(record.loads.col(1), 0.5 * Vector::Unit(2, 0));
  EXPECT_FALSE(record.correlated);
  EXPECT_THAT(Error("areas = {deck = [\"u3\"]}"), HasSubstr("'u3'"));
  EXPECT_THAT(Error("areas = {deck = []}"), HasSubstr("'deck' has no DOF"));
  EXPECT_THAT(Error("areas = {deck = {u1 = \"all\"}}"), HasSubstr("u1"));
  EXPECT_THAT(Error("areas = {deck = 3}"), HasSubstr("deck"));
  EXPECT_THAT(Error("areas = {deck = [\"u1\"]}\ndofs = [\"u1\"]"),
              HasSubstr("'dofs' beside 'areas'"));
}

TEST_F(AmbientSectionTest, LoadsLikeThoseOfAccelerations) {
  const AmbientRecord mass = Read("proportional_to_mass = [\"x\"]");
  EXPECT_EQ(mass.loads, Matrix((Vector(2) << 2.0, 1.0).finished()));
  const AmbientRecord base = Read("base = [\"x\"]\nband_hz = [0.5, 6.0]");
  EXPECT_EQ(base.base, Matrix(Vector::Ones(2)));
  EXPECT_EQ(base.loads.cols(), 0);
  EXPECT_EQ(base.lowest_frequency, 0.5);
  EXPECT_EQ(base.highest_frequency, 6.0);
  EXPECT_THAT(Error("base = [\"y\"]"), HasSubstr("'y'"));
  EXPECT_THAT(Error("proportional_to_mass = [\"y\"]"), HasSubstr("'y'"));
  EXPECT_THAT(Error("band_hz = [6.0, 0.5]"),
              HasSubstr("two frequencies, the first positive and smaller"));
}

}  // namespace
}  // namespace pinode
