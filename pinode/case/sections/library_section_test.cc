#include "pinode/case/sections/library_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pinode/case/results/model_case.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/problem/parameter_layout.h"
#include "tests/support/case_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const char kLibrary[] = R"toml([[library]]
name = "nl"
inputs = ["x[u1]", "v[u1]", "d[u1, u2]"]
output = "u1-u2"
acts_as = "force"
terms = ["x[u1]^3", {basis = "abs(v[u1]) * v[u1]", initial = 0.5, lower = 0.0, prior_sigma = 0.2, prior_mean = 0.1}, {basis = "sin(d[u1,u2])", initial = 2, free = false}]
)toml";

class LibrarySection : public ::testing::Test {
 protected:
  void SetUp() override { folder_.Write("quake.csv", SmallRecord()); }

  // The case with `library` in front of its record.
  bool Read(const std::string& library, Case* c) {
    const std::string path = folder_.Write(
        "case.toml",
        Replaced(SmallCase(), "[[record]]\n", library + "[[record]]\n"));
    error_.clear();
    return ReadCase(path, c, &error_);
  }
  std::string Refusal(const std::string& from, const std::string& to) {
    Case c;
    EXPECT_FALSE(Read(Replaced(kLibrary, from, to), &c)) << to;
    return error_;
  }

  TemporaryFolder folder_;
  std::string error_;
};

TEST_F(LibrarySection, IsReadWithAllItsKeys) {
  Case c;
  ASSERT_TRUE(Read(kLibrary, &c)) << error_;
  ASSERT_EQ(c.problem.dynamics->laws().size(), 1u);
  const LawTerm& law = c.problem.dynamics->laws()[0];
  EXPECT_EQ(law.name, "nl");
  EXPECT_EQ(law.type, "library");
  EXPECT_EQ(law.acts_as, ActsAs::kForce);
  EXPECT_EQ(law.outputs(0, 0), 1.0);
  EXPECT_EQ(law.outputs(1, 0), -1.0);
  const std::vector<Parameter>& xi = law.parameters.parameters;
  ASSERT_EQ(xi.size(), 3u);
  EXPECT_EQ(xi[0].name, "nl.x[u1]^3");
  EXPECT_EQ(xi[0].value, 0.0);
  EXPECT_TRUE(xi[0].free);
  EXPECT_EQ(xi[0].unit, "kN/m^3");
  EXPECT_EQ(xi[1].name, "nl.abs(v[u1])*v[u1]");
  EXPECT_EQ(xi[1].value, 0.5);
  EXPECT_EQ(xi[1].lower, 0.0);
  EXPECT_EQ(xi[1].prior_mean, 0.1);
  EXPECT_EQ(xi[1].prior_sigma, 0.2);
  EXPECT_EQ(xi[1].unit, "kN*s^2/m^2");
  // The sine of a displacement takes it for a number.
  EXPECT_EQ(xi[2].name, "nl.sin(d[u1,u2])");
  EXPECT_EQ(xi[2].unit, "kN");
  EXPECT_FALSE(xi[2].free);
}

TEST_F(LibrarySection, ActsAsAnAccelerationByDefault) {
  Case c;
  ASSERT_TRUE(Read(Replaced(kLibrary, "acts_as = \"force\"\n", ""), &c))
      << error_;
  const LawTerm& law = c.problem.dynamics->laws()[0];
  EXPECT_EQ(law.acts_as, ActsAs::kAcceleration);
  EXPECT_EQ(law.parameters.parameters[0].unit, "1/m^2/s^2");
}

TEST_F(LibrarySection, RefusesWhatIsWrong) {
  EXPECT_THAT(Refusal("output =", "ouput ="), HasSubstr("output"));
  EXPECT_THAT(Refusal("name = \"nl\"", "name = \"n/l\""),
              HasSubstr("cannot be a name"));
  EXPECT_THAT(Refusal("\"x[u1]^3\"", "\"x[u2]^3\""), HasSubstr("x[u2]"));
  EXPECT_THAT(Refusal("\"x[u1]^3\"", "\"x[u1]^^3\""), HasSubstr("column"));
  EXPECT_THAT(Refusal("\"x[u1]^3\"", "3"), HasSubstr("the number 3"));
  EXPECT_THAT(Refusal("\"x[u1]^3\"", "\"sin(d[u1,u2])\""), HasSubstr("twice"));
  EXPECT_THAT(Refusal("\"v[u1]\", \"d", "\"x[u1]\", \"d"), HasSubstr("twice"));
  EXPECT_THAT(Refusal("\"v[u1]\", \"d", "\"v[u9]\", \"d"), HasSubstr("u9"));
  EXPECT_THAT(Refusal("free = false", "fre = false"), HasSubstr("free"));
  EXPECT_THAT(Refusal("lower = 0.0", "lower = 0.9"), HasSubstr("bounds"));
  EXPECT_THAT(Refusal("u1-u2", "u1-u9"), HasSubstr("neither a DOF"));
  EXPECT_THAT(Refusal("acts_as = \"force\"", "acts_as = \"moment\""),
              HasSubstr("acceleration"));
  Case c;
  EXPECT_FALSE(Read(std::string(kLibrary) + kLibrary, &c));
  EXPECT_THAT(error_, HasSubstr("used twice"));
}

TEST_F(LibrarySection, TheModelCaseHasTheValuesFound) {
  Case c;
  ASSERT_TRUE(Read(kLibrary, &c)) << error_;
  IdentifiedModel model;
  model.parameters = ParameterLayout(c.problem).InitialValues();
  // The group k1 comes first, then the library.
  model.parameters[1] = -7.25;
  model.parameters[2] = 0.75;
  TemporaryFolder out;
  ASSERT_TRUE(WriteModelCase(c, model, out.Path(""), out.Path(""), &error_))
      << error_;
  Case again;
  ASSERT_TRUE(ReadCase(out.Path("model.toml"), &again, &error_)) << error_;
  ASSERT_EQ(again.problem.dynamics->laws().size(), 1u);
  const LawTerm& law = again.problem.dynamics->laws()[0];
  EXPECT_EQ(law.outputs, c.problem.dynamics->laws()[0].outputs);
  const std::vector<Parameter>& xi = law.parameters.parameters;
  ASSERT_EQ(xi.size(), 3u);
  EXPECT_EQ(xi[0].name, "nl.x[u1]^3");
  EXPECT_EQ(xi[0].value, -7.25);
  EXPECT_EQ(xi[1].value, 0.75);
  EXPECT_EQ(xi[1].prior_mean, 0.1);
  EXPECT_EQ(xi[1].lower, 0.0);
  EXPECT_EQ(xi[2].value, 2.0);
  EXPECT_FALSE(xi[2].free);
}

TEST_F(LibrarySection, DiscoverSectionIsReadAndRefused) {
  const std::string network =
      "[[network]]\nname = \"nn\"\ninputs = [\"x[u1]\", \"v[u1]\"]\noutputs = "
      "[\"u1\"]\nlayers = [3]\n";
  const std::string section =
      "[discover]\nsolver = \"stlsq\"\nfeatures = [\"x[u1]\", "
      "\"d[u1, u2]\"]\npolynomial_degree = 2\nsine = [\"d[u1, u2]\"]\n"
      "tolerance = 0.02\nbags = 10\nrefit = false\nnetworks = [\"nn\"]\n"
      "[[discover.output]]\nname = \"u1\"\npolynomial_degree = 3\n"
      "negative = [\"x[u1]^3\"]\ngiven = {\"x[u1]\" = -3.0}\n";
  Case c;
  ASSERT_TRUE(Read(network + section, &c)) << error_;
  const DiscoveryOptions& options = c.discover;
  EXPECT_EQ(options.solver, DiscoveryOptions::Solver::kStlsq);
  ASSERT_EQ(options.features.size(), 2u);
  EXPECT_EQ(options.features[1].kind, Feature::Kind::kDeformation);
  EXPECT_EQ(options.library.polynomial_degree, 2);
  EXPECT_THAT(options.library.sine_features, ElementsAre("d[u1,u2]"));
  EXPECT_EQ(options.tolerance, 0.02);
  EXPECT_EQ(options.num_bags, 10);
  EXPECT_FALSE(options.refit);
  ASSERT_EQ(options.outputs.size(), 1u);
  EXPECT_EQ(options.outputs[0].library.polynomial_degree, 3);
  EXPECT_THAT(options.outputs[0].library.sine_features,
              ElementsAre("d[u1,u2]"));
  ASSERT_EQ(options.outputs[0].constraints.size(), 2u);
  EXPECT_EQ(options.outputs[0].constraints[0].value, -3.0);
  EXPECT_EQ(options.outputs[0].constraints[1].sign, -1);

  const auto refusal = [&](const std::string& from, const std::string& to) {
    EXPECT_FALSE(Read(network + Replaced(section, from, to), &c)) << to;
    return error_;
  };
  EXPECT_THAT(refusal("sine", "sinus"), HasSubstr("sine"));
  EXPECT_THAT(refusal("[\"nn\"]", "[\"nm\"]"), HasSubstr("'nn'"));
  EXPECT_THAT(refusal("name = \"u1\"", "name = \"u2\""),
              HasSubstr("no network has an output 'u2'"));
  EXPECT_THAT(refusal("0.02", "1.5"), HasSubstr("tolerance"));
}

}  // namespace
}  // namespace pinode
