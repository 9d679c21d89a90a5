#include "pinode/case/sections/ambient_section.h"

#include <cmath>
#include <string>
#include <tuple>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/record/files/universal_file.h"
#include "tests/support/case_testing.h"
#include "tests/support/temporary_folder_testing.h"

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

// A known gain divides the samples; volts need one. A free gain has nothing to
// compare itself with.
TEST_F(AmbientSectionTest, ChannelsMayHaveAKnownGain) {
  const auto with_gain = [this](const std::string& unit,
                                const std::string& gain) {
    std::string text = AmbientCase("");
    const std::string last = "unit = \"m/s^2\"\n";
    text.replace(text.rfind(last), last.size(),
                 "unit = \"" + unit + "\"\n" + gain);
    return folder_.Write("case.toml", text);
  };
  const Matrix plain = Read("").samples;
  for (const auto& [unit, gain, factor] :
       {std::tuple{"m/s^2", "gain = {initial = -0.5}\n", -2.0},
        std::tuple{"mV", "gain = {initial = 0.1, free = false}\n", 0.01}}) {
    const Case c = ReadOrFail(with_gain(unit, gain));
    const Matrix& samples = c.problem.ambient.front().samples;
    EXPECT_LT((samples.row(1) - factor * plain.row(1)).norm(),
              1e-12 * plain.norm());
    EXPECT_EQ(samples.row(0), plain.row(0));
    EXPECT_EQ(c.problem.sensors.size(), 0);
  }
  Case c;
  std::string error;
  EXPECT_FALSE(ReadCase(with_gain("V", ""), &c, &error));
  EXPECT_THAT(error, HasSubstr("needs a known sensitivity"));
  for (const char* gain : {"gain = {}\n", "gain = {free = false}\n"}) {
    EXPECT_FALSE(ReadCase(with_gain("V", gain), &c, &error)) << gain;
    EXPECT_THAT(error, HasSubstr("the nominal sensitivity, in volts"));
  }
  for (const char* gain : {"gain = {free = true}\n",
                           "gain = {initial = 2, prior_sigma = 0.1}\n"}) {
    EXPECT_FALSE(ReadCase(with_gain("m/s^2", gain), &c, &error)) << gain;
    EXPECT_THAT(error, HasSubstr("an unknown gain cannot be told apart"));
  }
  EXPECT_FALSE(
      ReadCase(with_gain("m/s^2", "gain = {initial = 0}\n"), &c, &error));
  EXPECT_THAT(error, HasSubstr("the gain is 0"));
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
              HasSubstr("'dofs' and 'areas' are both given"));
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

// Two histories, 1:x and 2:x.
UniversalFile UniversalWind(double step, int samples) {
  UniversalFile file;
  for (int c = 1; c <= 2; ++c) {
    UniversalFunction history;
    history.response_node = c;
    history.response_direction = 1;
    history.abscissa_step = step;
    history.abscissa_axis.type = 17;
    history.ordinate_axis.type = 12;
    history.values.resize(samples);
    for (int i = 0; i < samples; ++i) {
      history.values[i] = std::sin(0.7 * c * i) + std::sin(0.31 * i * i) / 3.0;
    }
    file.functions.push_back(history);
  }
  return file;
}

// Loggers of differing rates, each with a universal file: binary and text say
// what they were made of, and each record has its own rate.
TEST_F(AmbientSectionTest, UniversalFilesOfDifferingRates) {
  const UniversalFile files[] = {UniversalWind(0.02, 1500),
                                 UniversalWind(0.05, 800)};
  folder_.Write("fast.uff",
                FormatUniversalFile(files[0], UniversalEncoding::kBinary));
  folder_.Write("slow.uff",
                FormatUniversalFile(files[1], UniversalEncoding::kText));
  std::string text = Replaced(AmbientCase(""), "\"a1\"", "\"1:x\"");
  text = Replaced(text, "\"a2\"", "\"2:x\"");
  text = Replaced(text, "sampling_rate_hz = 20", "time = \"t\"");
  std::string second = text.substr(text.find("[[record]]"));
  // Its name, then its file.
  text = Replaced(Replaced(text, "wind", "fast"), "wind.csv", "fast.uff");
  second = Replaced(Replaced(second, "wind", "slow"), "wind.csv", "slow.uff");
  const Case c = ReadOrFail(folder_.Write("case.toml", text + second));
  ASSERT_EQ(c.problem.ambient.size(), 2u);
  for (size_t r = 0; r < 2; ++r) {
    const AmbientRecord& wind = c.problem.ambient[r];
    EXPECT_EQ(wind.name, r == 0 ? "fast" : "slow");
    EXPECT_NEAR(wind.sampling_step, r == 0 ? 0.02 : 0.05, 1e-12);
    for (size_t channel = 0; channel < 2; ++channel) {
      // But for rounding: samples are where even times are.
      const Vector off =
          wind.samples.row(static_cast<Eigen::Index>(channel)).transpose() -
          files[r].functions[channel].values.real();
      EXPECT_LT(off.cwiseAbs().maxCoeff(), 1e-12) << wind.name;
    }
  }
}

}  // namespace
}  // namespace pinode
