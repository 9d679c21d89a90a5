#include "pinode/case/sections/frf_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>

#include "pinode/base/constants.h"
#include "pinode/base/strings.h"
#include "pinode/case/sections/case_file.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// Accelerance of one DOF with m = 2, c = 0.8 and k = 800, times `factor`.
std::complex<double> Accelerance(double hz, double factor) {
  const double w = kTwoPi * hz;
  return factor * -w * w / std::complex<double>(800.0 - 2.0 * w * w, 0.8 * w);
}

std::string FrfText(double factor) {
  std::string text = "Frequency,Real,Imaginary\n";
  for (int i = 0; i <= 40; ++i) {
    const double hz = 0.25 * i;
    const std::complex<double> value = Accelerance(hz, factor);
    text += FormatNumber(hz, 9) + "," + FormatNumber(value.real(), 12) + "," +
            FormatNumber(value.imag(), 12) + "\n";
  }
  return text;
}

constexpr char kCase[] = R"(
[model]
dofs = ["u1"]
mass = [[2]]
damping = [[0.8]]
stiffness = [[1000]]
[[group]]
name = "k"
adds_to = "stiffness"
matrix = [[1000]]
)";

bool ReadText(const TemporaryFolder& folder, const std::string& text, Case* c,
              std::string* error) {
  return ReadCase(folder.Write("case.toml", text), c, error);
}

TEST(FrfSectionTest, PlacesUnitsAndBand) {
  const TemporaryFolder folder;
  // The sensor points against the DOF and measures in cm/s^2 per kN.
  folder.Write("h.csv", FrfText(-1e5));
  Case c;
  std::string error;
  ASSERT_TRUE(ReadText(folder, std::string(kCase) + R"(
[[frf]]
name = "hammer"
files = ["h.csv"]
responses = ["p1"]
references = ["p1b"]
dofs = {p1 = "-u1", p1b = "u1"}
quantity = "acceleration"
unit = "cm/s^2"
force_unit = "kN"
band_hz = [1.0, 9.0]
stride = 2
sigma = 50.0
gain = {initial = 1.1, free = true}
loss_factor = {initial = 0.01, free = true}
)",
                       &c, &error))
      << error;
  ASSERT_EQ(c.problem.frfs.size(), 1u);
  const FrfRecord& record = c.problem.frfs.front();
  EXPECT_EQ(record.name, "hammer");
  EXPECT_EQ(record.PairName(0), "p1/p1b");
  ASSERT_EQ(record.num_lines(), 17);
  EXPECT_DOUBLE_EQ(record.frequencies[1], 1.5);
  EXPECT_EQ(record.responses[0].weights[0], -1.0);
  EXPECT_EQ(record.references(0, 0), 1.0);
  EXPECT_LT(std::abs(record.values(1, 0) - Accelerance(1.5, -1.0)), 1e-9);
  EXPECT_DOUBLE_EQ(record.sigma[0], 5e-4);
  ASSERT_EQ(c.problem.sensors.size(), 2);
  EXPECT_EQ(c.problem.sensors.parameters[0].name, "gain.p1");
  EXPECT_EQ(record.gains[0], 0);
  EXPECT_EQ(record.delays[0], -1);
  EXPECT_EQ(record.loss_factor, 1);
}

TEST(FrfSectionTest, RelativeNoise) {
  const TemporaryFolder folder;
  folder.Write("h.csv", FrfText(1.0));
  Case c;
  std::string error;
  ASSERT_TRUE(ReadText(folder, std::string(kCase) + R"(
[[frf]]
files = ["h.csv"]
responses = ["u1"]
references = ["u1"]
quantity = "acceleration"
noise = "relative"
)",
                       &c, &error))
      << error;
  const FrfRecord& record = c.problem.frfs.front();
  // The line at 0 Hz has no motion.
  ASSERT_EQ(record.num_lines(), 40);
  EXPECT_NEAR(record.variances.mean(), 1.0, 1e-9);
  EXPECT_NEAR(record.variances(20, 0) / record.variances(30, 0),
              std::norm(record.values(20, 0) / record.values(30, 0)), 1e-9);
}

// Relative variances |h|^2 (1 - coherence) / coherence, without being asked.
TEST(FrfSectionTest, CoherenceOfTheFilesWeightsLines) {
  const TemporaryFolder folder;
  std::string text = "Frequency,Real,Imaginary,Coherence\n";
  Vector expected(40);
  for (int i = 1; i <= 40; ++i) {
    const std::complex<double> value = Accelerance(0.25 * i, 1.0);
    const double coherence = 0.5 + 0.01 * i;
    expected[i - 1] = std::norm(value) * (1.0 - coherence) / coherence;
    text += FormatNumber(0.25 * i, 9) + "," + FormatNumber(value.real(), 15) +
            "," + FormatNumber(value.imag(), 15) + "," +
            FormatNumber(coherence, 15) + "\n";
  }
  folder.Write("h.csv", text);
  const std::string frf = std::string(kCase) +
                          "[[frf]]\nfiles = [\"h.csv\"]\nresponses = [\"u1\"]"
                          "\nreferences = [\"u1\"]\n"
                          "quantity = \"acceleration\"\n";
  Case c;
  std::string error;
  ASSERT_TRUE(ReadText(folder, frf, &c, &error)) << error;
  expected /= expected.mean();
  const FrfRecord& record = c.problem.frfs.front();
  ASSERT_EQ(record.variances.rows(), 40);
  EXPECT_LT((record.variances.col(0) - expected).norm(),
            1e-9 * expected.norm());
  ASSERT_TRUE(ReadText(folder, frf + "noise = \"constant\"\n", &c, &error))
      << error;
  EXPECT_EQ(c.problem.frfs.front().variances.size(), 0);
}

TEST(FrfSectionTest, MistakesAreOneLine) {
  const TemporaryFolder folder;
  folder.Write("h.csv", FrfText(1.0));
  const std::string begin =
      std::string(kCase) + "[[frf]]\nfiles = [\"h.csv\"]\n";
  const std::string places =
      "responses = [\"u1\"]\nreferences = [\"u1\"]\n"
      "quantity = \"acceleration\"\n";
  const struct {
    std::string text;
    std::string message;
  } mistakes[] = {
      {std::string(kCase) + "[[frf]]\nname = \"a\"\n", "files"},
      {begin + "quantity = \"acceleration\"\n", "is not a DOF of the model"},
      {begin + "responses = [\"u1\"]\nreferences = [\"u1\"]\n",
       "does not say what was measured"},
      {begin + places + "dofs = {u1 = \"u7\"}\n", "'u7' is not a DOF"},
      {begin + places + "noise = \"coherence\"\n", "have no coherence"},
      {begin + places + "unit = \"m\"\n", "acceleration"},
      {begin + places + "band_hz = [5.0, 5.5]\n", "at least 10 lines"},
      {begin + places + "name = \"a\"\n[[frf]]\nfiles = [\"h.csv\"]\n" +
           places + "name = \"a\"\n",
       "this name is used twice"},
      {begin + places + "gain = {initial = 1.1}\n[[frf]]\n" +
           "files = [\"h.csv\"]\n" + places + "gain = {initial = 1.2}\n",
       "given twice with different values"},
      {begin + places +
           "[[element]]\nname = \"e\"\ntype = \"cubic\"\n"
           "between = [\"ground\", \"u1\"]\nparameters.k3 = 1.0\n",
       "an element, a library or a network with memory"},
  };
  for (const auto& mistake : mistakes) {
    Case c;
    std::string error;
    EXPECT_FALSE(ReadText(folder, mistake.text, &c, &error)) << mistake.text;
    EXPECT_THAT(error, HasSubstr(mistake.message)) << mistake.text;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

}  // namespace
}  // namespace pinode
