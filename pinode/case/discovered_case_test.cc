#include "pinode/case/discovered_case.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pinode/base/strings.h"
#include "pinode/case/discover_files.h"
#include "pinode/case/testing.h"
#include "pinode/estimate/parameter_layout.h"
#include "pinode/integrate/rk4.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// x'' + 0.4 x' + 9 x + 2 x^3 = 0 from x = 1.5; the case lacks the cubic term.
std::string OscillatorRecord() {
  double state[] = {1.5, 0.0};
  Rk4Scratch<double> scratch(2);
  std::string text = "t,x,v\n";
  constexpr int kSubsteps = 200;
  constexpr double kStep = 0.05;
  for (int i = 0; i <= 80; ++i) {
    text += FormatNumber(kStep * i, 6) + "," + FormatNumber(state[0]) + "," +
            FormatNumber(state[1]) + "\n";
    for (int s = 0; s < kSubsteps; ++s) {
      Rk4Step(
          [](int, double, const double* h, double* rate) {
            rate[0] = h[1];
            rate[1] = -9.0 * h[0] - 0.4 * h[1] - 2.0 * h[0] * h[0] * h[0];
          },
          0.0, kStep / kSubsteps, state, &scratch);
    }
  }
  return text;
}

const char kOscillator[] = R"([units]
force = "N"
length = "m"
[model]
dofs = ["u"]
mass = [[1.0]]
stiffness = [[9.0]]
damping = [[0.4]]
[[network]]
name = "nn"
inputs = ["x[u]", "v[u]"]
outputs = ["u"]
layers = [2]
[[record]]
name = "free"
file = "free.csv"
time = "t"
start = "free"
  [[record.channel]]
  column = "x"
  quantity = "displacement"
  dof = "u"
  unit = "m"
  [[record.channel]]
  column = "v"
  quantity = "velocity"
  dof = "u"
  unit = "m/s"
[options]
threads = 1
)";

class DiscoveredCase : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.Write("free.csv", OscillatorRecord());
    const std::string path = folder_.Write("case.toml", kOscillator);
    ASSERT_TRUE(ReadCase(path, &case_, &error_)) << error_;
    model_.parameters = ParameterLayout(case_.problem).InitialValues();
    equation_.network = "nn";
    equation_.output = "u";
    equation_.features = {Feature::Displacement(0), Feature::Velocity(0)};
    equation_.feature_names = {"x[u]", "v[u]"};
    equation_.scale = 5.0;
    Add("x[u]^3", -1.8, 0.7);
  }
  void Add(const std::string& basis, double coefficient, double rms) {
    DiscoveredTerm term;
    term.basis = basis;
    term.coefficient = coefficient;
    term.basis_rms = rms;
    term.share = std::abs(coefficient) * rms / equation_.scale;
    equation_.terms.push_back(term);
  }

  TemporaryFolder folder_;
  std::string error_;
  Case case_;
  IdentifiedModel model_;
  DiscoveredEquation equation_;
};

TEST_F(DiscoveredCase, HasTheLibraryInPlaceOfTheNetwork) {
  Case found;
  IdentifiedModel initial;
  ASSERT_TRUE(MakeDiscoveredCase(case_, model_, {equation_}, {7}, &found,
                                 &initial, &error_))
      << error_;
  EXPECT_TRUE(found.problem.dynamics->networks().empty());
  ASSERT_EQ(found.problem.dynamics->laws().size(), 1u);
  const LawTerm& law = found.problem.dynamics->laws()[0];
  EXPECT_EQ(law.name, "nn_u");
  EXPECT_EQ(law.acts_as, ActsAs::kAcceleration);
  // v[u] is not looked at.
  EXPECT_EQ(law.features.size(), 1u);
  EXPECT_EQ(found.problem.records[0].substeps, 7);
  ASSERT_EQ(initial.parameters.size(), 1);
  EXPECT_EQ(initial.parameters[0], -1.8);
  // What scores are compared with has no cubic term.
  EXPECT_EQ(law.parameters.parameters[0].value, 0.0);
}

TEST_F(DiscoveredCase, HasTheRecordsAsTheyAreInMemory) {
  case_.problem.records[0].channels[0].values[3] = 7.0;
  folder_.Write("free.csv", OscillatorRecord());
  Case found;
  IdentifiedModel initial;
  ASSERT_TRUE(MakeDiscoveredCase(case_, model_, {equation_}, {}, &found,
                                 &initial, &error_))
      << error_;
  EXPECT_EQ(found.problem.records[0].channels[0].values[3], 7.0);
  EXPECT_EQ(found.problem.records[0].channels[1].values,
            case_.problem.records[0].channels[1].values);
}

TEST_F(DiscoveredCase, RefitFindsTheCoefficientAndDropsWhatIsNotThere) {
  Add("v[u]^3", 0.01, 30.0);
  Add("x[u]", -0.2, 0.8);
  Discovery discovery;
  ASSERT_TRUE(
      RefitEquations(case_, model_, {equation_}, nullptr, &discovery, &error_))
      << error_;
  EXPECT_TRUE(discovery.summary.usable) << discovery.summary.message;
  EXPECT_THAT(discovery.dropped,
              ::testing::UnorderedElementsAre("u: v[u]^3", "u: x[u]"));
  ASSERT_EQ(discovery.num_terms(), 1);
  ASSERT_EQ(discovery.equations[0].terms.size(), 1u);
  const DiscoveredTerm& term = discovery.equations[0].terms[0];
  EXPECT_EQ(term.basis, "x[u]^3");
  EXPECT_EQ(term.unit, "1/m^2/s^2");
  EXPECT_NEAR(term.coefficient, -2.0, 2e-8);
  EXPECT_LT(term.lower95, term.coefficient);
  EXPECT_GT(term.upper95, term.coefficient);
  EXPECT_LT(term.upper95 - term.lower95, 1e-6);
  EXPECT_EQ(term.regressed, -1.8);
  EXPECT_GT(discovery.step_refinement, 1);
}

// What is regressed on a network that follows the noise need not give finite
// trajectories.
TEST_F(DiscoveredCase, TermsThatCannotBeFittedDoNotStay) {
  equation_.terms.clear();
  Add("x[u]^3", 1e6, 0.7);
  Add("v[u]^3", 1e6, 30.0);
  equation_.num_candidates = 5;
  for (const char* basis :
       {"x[u]^2", "x[u]*v[u]", "v[u]^2", "x[u]^3", "v[u]^3"}) {
    DiscoveryCandidate candidate;
    candidate.basis = basis;
    candidate.rms = 1.0;
    equation_.candidates.push_back(candidate);
  }
  Discovery discovery;
  ASSERT_TRUE(
      RefitEquations(case_, model_, {equation_}, nullptr, &discovery, &error_))
      << error_;
  EXPECT_TRUE(discovery.refitted);
  EXPECT_TRUE(discovery.summary.usable) << discovery.summary.message;
  ASSERT_EQ(discovery.num_terms(), 1);
  EXPECT_EQ(discovery.equations[0].terms[0].basis, "x[u]^3");
  EXPECT_NEAR(discovery.equations[0].terms[0].coefficient, -2.0, 2e-8);
}

TEST_F(DiscoveredCase, GivenCoefficientsStayAndSignsAreBounds) {
  equation_.terms[0].coefficient = -2.1;
  equation_.terms[0].given = true;
  Add("v[u]", -0.05, 3.0);
  equation_.terms[1].sign = -1;
  Case found;
  IdentifiedModel initial;
  ASSERT_TRUE(MakeDiscoveredCase(case_, model_, {equation_}, {}, &found,
                                 &initial, &error_))
      << error_;
  const std::vector<Parameter>& xi =
      found.problem.dynamics->laws()[0].parameters.parameters;
  EXPECT_FALSE(xi[0].free);
  EXPECT_EQ(xi[0].value, -2.1);
  EXPECT_TRUE(xi[1].free);
  EXPECT_EQ(xi[1].upper, 0.0);
}

TEST_F(DiscoveredCase, Files) {
  const Discovery discovery = WithoutRefit(case_, {equation_});
  const nlohmann::json json = nlohmann::json::parse(DiscoveryAsJson(discovery));
  EXPECT_EQ(json["schema"], "pinode-discover-1");
  EXPECT_EQ(json["equations"][0]["output"], "u");
  const nlohmann::json& term = json["equations"][0]["terms"][0];
  EXPECT_EQ(term["basis"], "x[u]^3");
  EXPECT_EQ(term["coefficient"], -1.8);
  EXPECT_TRUE(term["lower95"].is_null());
  EXPECT_THAT(EquationsAsText(discovery), HasSubstr("-1.8 * x[u]^3"));
  EXPECT_THAT(EquationsAsLatex(discovery),
              HasSubstr("g_{\\mathrm{u}} &= -1.8\\,x_{\\mathrm{u}}^{3}"));
}

TEST_F(DiscoveredCase, CheckpointKeepsTermsAndCoefficients) {
  const std::string path = folder_.Path("checkpoint.json");
  DiscoveryCandidate candidate;
  candidate.basis = "v[u]^3";
  candidate.rms = 30.0;
  equation_.candidates = {candidate};
  const std::vector<DiscoveredEquation> regressed = {equation_};
  std::vector<DiscoveredEquation> current = {equation_};
  current[0].terms[0].coefficient = -1.0 / 3.0;
  current[0].terms.emplace_back();
  current[0].terms[1].basis = "v[u]^3";
  current[0].terms[1].coefficient = 0.25;
  ASSERT_TRUE(WriteDiscoverCheckpoint(path, "abc", current, &error_)) << error_;
  std::vector<DiscoveredEquation> resumed;
  ASSERT_TRUE(ReadDiscoverCheckpoint(path, "abc", regressed, &resumed, &error_))
      << error_;
  ASSERT_EQ(resumed[0].terms.size(), 2u);
  EXPECT_EQ(resumed[0].terms[0].coefficient, -1.0 / 3.0);
  EXPECT_EQ(resumed[0].terms[0].basis_rms, 0.7);
  EXPECT_EQ(resumed[0].terms[1].coefficient, 0.25);
  EXPECT_EQ(resumed[0].terms[1].basis_rms, 30.0);

  resumed.clear();
  EXPECT_FALSE(
      ReadDiscoverCheckpoint(path, "abd", regressed, &resumed, &error_));
  EXPECT_THAT(error_, HasSubstr("another case"));
  equation_.candidates.clear();
  EXPECT_FALSE(
      ReadDiscoverCheckpoint(path, "abc", {equation_}, &resumed, &error_));
  EXPECT_THAT(error_, HasSubstr("none of the candidates"));
  EXPECT_FALSE(ReadDiscoverCheckpoint(path, "abc", {}, &resumed, &error_));
  for (const char* text :
       {"", "{}", "[1]", "{\"schema\": 3}",
        "{\"schema\": \"pinode-checkpoint-1\"}",
        "{\"schema\": \"pinode-discover-checkpoint-1\", \"problem\": "
        "\"abc\", \"equations\": [{\"network\": \"nn\", \"output\": "
        "\"u\", \"terms\": [{\"basis\": \"x[u]^3\"}]}]}"}) {
    folder_.Write("checkpoint.json", text);
    error_.clear();
    EXPECT_FALSE(
        ReadDiscoverCheckpoint(path, "abc", regressed, &resumed, &error_))
        << text;
    EXPECT_THAT(error_, HasSubstr("checkpoint.json: ")) << text;
  }
  EXPECT_TRUE(resumed.empty());
}

TEST(BasisAsLatex, KnowsFeaturesPowersAndFunctions) {
  EXPECT_EQ(BasisAsLatex("x[a_1]^2*v[b]"),
            "x_{\\mathrm{a\\_1}}^{2}\\,\\dot{x}_{\\mathrm{b}}");
  EXPECT_EQ(BasisAsLatex("d[a,b]"), "(x_{\\mathrm{b}} - x_{\\mathrm{a}})");
  EXPECT_EQ(BasisAsLatex("w[ground,b]"), "\\dot{x}_{\\mathrm{b}}");
  EXPECT_EQ(BasisAsLatex("abs(v[b])*v[b]"),
            "\\operatorname{abs}(\\dot{x}_{\\mathrm{b}})\\,"
            "\\dot{x}_{\\mathrm{b}}");
  EXPECT_EQ(BasisAsLatex("x[b]^(1/2)"), "x_{\\mathrm{b}}^{1/2}");
}

}  // namespace
}  // namespace pinode
