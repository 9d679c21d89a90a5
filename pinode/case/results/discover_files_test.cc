#include "pinode/case/results/discover_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pinode/problem/identification_problem.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// A cubic spring in place of a network.
class DiscoverFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    problem_.dynamics = std::make_shared<StructuralDynamics>(
        MakeStructuralModel(Matrix::Ones(1, 1), Matrix::Zero(1, 1),
                            Matrix::Ones(1, 1), {"u"}),
        std::vector<InputSpec>());
    equation_.network = "nn";
    equation_.output = "u";
    equation_.features = {Feature::Displacement(0), Feature::Velocity(0)};
    equation_.feature_names = {"x[u]", "v[u]"};
    equation_.scale = 5.0;
    DiscoveredTerm term;
    term.basis = "x[u]^3";
    term.coefficient = -1.8;
    term.basis_rms = 0.7;
    equation_.terms = {term};
  }

  TemporaryFolder folder_;
  std::string error_;
  IdentificationProblem problem_;
  DiscoveredEquation equation_;
};

TEST_F(DiscoverFiles, HoldTheEquations) {
  const Discovery discovery = WithoutRefit(problem_, {equation_});
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

TEST_F(DiscoverFiles, NameTheRivalsOfAnUncertainTerm) {
  equation_.terms[0].probability = 0.625;
  Discovery discovery = WithoutRefit(problem_, {equation_});
  discovery.rivals = {{{"u: x[u]^3"}, {"u: x[u]^5"}, std::log(0.5), true},
                      {{"u: x[u]^3"}, {}, std::log(0.02), false}};
  const nlohmann::json json = nlohmann::json::parse(DiscoveryAsJson(discovery));
  EXPECT_EQ(json["equations"][0]["terms"][0]["probability"], 0.625);
  ASSERT_EQ(json["rivals"].size(), 2u);
  EXPECT_EQ(json["rivals"][0]["without"][0], "u: x[u]^3");
  EXPECT_EQ(json["rivals"][0]["with"][0], "u: x[u]^5");
  EXPECT_EQ(json["rivals"][0]["log_odds"], std::log(0.5));
  EXPECT_EQ(json["rivals"][0]["fitted"], true);
  const std::string text = EquationsAsText(discovery);
  EXPECT_THAT(text, HasSubstr("uncertain: probability 63 %"));
  EXPECT_THAT(text, HasSubstr("odds 0.5: without u: x[u]^3; with u: x[u]^5"));
  // Small odds doubt nothing.
  EXPECT_THAT(text, Not(HasSubstr("odds 0.02")));
  discovery.rivals[0].log_odds = 100.0;
  EXPECT_THAT(EquationsAsText(discovery),
              HasSubstr("    log odds 100: without"));
}

TEST_F(DiscoverFiles, CheckpointKeepsTermsAndCoefficients) {
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
  EXPECT_THAT(error_, HasSubstr("not a candidate of the section"));
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
