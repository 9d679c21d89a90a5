#include "pinode/study/laws/refit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/discover/term_prices.h"
#include "pinode/integrate/rk4.h"
#include "pinode/network/network.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/laws/term_rivals.h"
#include "pinode/study/problem/inner_fit.h"
#include "pinode/study/terms/discovered_problem.h"
#include "pinode/study/terms/term_worth.h"
#include "tests/support/gaussian_testing.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// x'' + 0.4 x' + 9 x + 2 x^3 = 0 from x = 1.5; the model has a network in place
// of the cubic term.
class RefitTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto dynamics = std::make_shared<StructuralDynamics>(
        MakeStructuralModel(Matrix::Ones(1, 1), Matrix::Constant(1, 1, 0.4),
                            Matrix::Constant(1, 1, 9.0), {"u"}),
        std::vector<InputSpec>());
    NetworkArchitecture architecture;
    architecture.num_inputs = 2;
    architecture.num_outputs = 1;
    architecture.hidden_widths = {2};
    NetworkTerm network;
    network.name = "nn";
    network.network = std::make_shared<Network>(architecture);
    network.features = {Feature::Displacement(0), Feature::Velocity(0)};
    network.outputs = Matrix::Ones(1, 1);
    network.output_names = {"u"};
    network.weights.name = "nn";
    network.weights.decays = architecture.NonlinearWeights();
    for (int i = 0; i < architecture.NumWeights(); ++i) {
      Parameter weight;
      weight.name = "nn[" + std::to_string(i) + "]";
      weight.value = 0.1 * std::sin(1.7 * i + 0.3);
      network.weights.parameters.push_back(weight);
    }
    ASSERT_TRUE(dynamics->AddNetwork(std::move(network), &error_)) << error_;
    problem_.dynamics = dynamics;
    problem_.records = {FreeVibration()};
    problem_.description.remarks = {"network 'nn' is gauged.", "other"};
    ChooseStepsOrFail(&problem_);
    options_.num_threads = 1;
    model_.parameters = ParameterLayout(problem_).InitialValues();
    equation_.network = "nn";
    equation_.output = "u";
    equation_.features = {Feature::Displacement(0), Feature::Velocity(0)};
    equation_.feature_names = {"x[u]", "v[u]"};
    equation_.scale = 5.0;
    Add("x[u]^3", -1.8, 0.7);
  }

  static IdentificationRecord FreeVibration() {
    constexpr int kOscillatorSamples = 81;
    constexpr int kSubsteps = 200;
    constexpr double kOscillatorStep = 0.05;
    IdentificationRecord record;
    record.name = "free";
    record.excitation.emplace(0.0, kOscillatorStep,
                              Matrix(0, kOscillatorSamples),
                              Interpolation::kLinear);
    record.start = IdentificationRecord::Start::kFree;
    record.channels = {testing::MakeChannel("x", Quantity::kDisplacement, 1, 0),
                       testing::MakeChannel("v", Quantity::kVelocity, 1, 0)};
    for (MeasuredChannel& channel : record.channels) {
      channel.values.resize(kOscillatorSamples);
    }
    double state[] = {1.5, 0.0};
    Rk4Scratch<double> scratch(2);
    for (int i = 0; i < kOscillatorSamples; ++i) {
      record.channels[0].values[i] = state[0];
      record.channels[1].values[i] = state[1];
      for (int s = 0; s < kSubsteps; ++s) {
        Rk4Step(
            [](int, double, const double* h, double* rate) {
              rate[0] = h[1];
              rate[1] = -9.0 * h[0] - 0.4 * h[1] - 2.0 * h[0] * h[0] * h[0];
            },
            0.0, kOscillatorStep / kSubsteps, state, &scratch);
      }
    }
    return record;
  }

  void Add(const std::string& basis, double coefficient, double rms) {
    DiscoveredTerm term;
    term.basis = basis;
    term.coefficient = coefficient;
    term.basis_rms = rms;
    term.share = std::abs(coefficient) * rms / equation_.scale;
    equation_.terms.push_back(term);
  }

  // Offers these cubic and quintic candidates, and adds noise to the record.
  void OfferInNoise(double sigma) {
    for (const auto& [basis, degree] : std::vector<std::pair<std::string, int>>{
             {"x[u]^3", 3}, {"x[u]^2*v[u]", 3}, {"x[u]^5", 5}}) {
      DiscoveryCandidate candidate;
      candidate.basis = basis;
      candidate.degree = degree;
      candidate.rms = 0.7;
      equation_.candidates.push_back(candidate);
    }
    testing::Gaussian gaussian(11);
    for (MeasuredChannel& channel : problem_.records[0].channels) {
      channel.values += sigma * Vector(gaussian.Draw(81, 1));
    }
  }

  bool Refit(Discovery* discovery) {
    return RefitEquations(problem_, model_, {equation_}, DiscoveryOptions(),
                          options_, nullptr, nullptr, discovery, &error_);
  }

  std::string error_;
  IdentificationProblem problem_;
  IdentificationOptions options_;
  IdentifiedModel model_;
  DiscoveredEquation equation_;
};

TEST_F(RefitTest, HasTheLibraryInPlaceOfTheNetwork) {
  IdentificationProblem found;
  IdentifiedModel initial;
  ASSERT_TRUE(MakeDiscoveredProblem(problem_, model_, {equation_}, {7}, &found,
                                    &initial, &error_))
      << error_;
  EXPECT_TRUE(found.dynamics->networks().empty());
  ASSERT_EQ(found.dynamics->laws().size(), 1u);
  const LawTerm& law = found.dynamics->laws()[0];
  EXPECT_EQ(law.name, "nn_u");
  EXPECT_EQ(law.acts_as, ActsAs::kAcceleration);
  // v[u] is not looked at.
  EXPECT_EQ(law.features.size(), 1u);
  EXPECT_EQ(found.records[0].substeps, 7);
  ASSERT_EQ(initial.parameters.size(), 1);
  EXPECT_EQ(initial.parameters[0], -1.8);
  // What scores are compared with has no cubic term.
  EXPECT_EQ(law.parameters.parameters[0].value, 0.0);
  EXPECT_THAT(found.description.remarks, ElementsAre("other"));
}

TEST_F(RefitTest, RefitFindsTheCoefficientAndDropsWhatIsNotThere) {
  Add("v[u]^3", 0.01, 30.0);
  Add("x[u]", -0.2, 0.8);
  Discovery discovery;
  ASSERT_TRUE(Refit(&discovery)) << error_;
  EXPECT_TRUE(discovery.summary.usable()) << discovery.summary.message;
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
TEST_F(RefitTest, TermsThatCannotBeFittedDoNotStay) {
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
  ASSERT_TRUE(Refit(&discovery)) << error_;
  EXPECT_TRUE(discovery.refitted);
  EXPECT_TRUE(discovery.summary.usable()) << discovery.summary.message;
  ASSERT_EQ(discovery.num_terms(), 1);
  EXPECT_EQ(discovery.equations[0].terms[0].basis, "x[u]^3");
  EXPECT_NEAR(discovery.equations[0].terms[0].coefficient, -2.0, 2e-8);
}

TEST_F(RefitTest, RivalHasTheOddsOfItsOwnRefit) {
  OfferInNoise(0.9);
  Discovery discovery;
  ASSERT_TRUE(Refit(&discovery)) << error_;
  ASSERT_EQ(discovery.num_terms(), 1);
  ASSERT_FALSE(discovery.rivals.empty());
  const TermRival& rival = discovery.rivals[0];
  EXPECT_THAT(rival.without, ElementsAre("u: x[u]^3"));
  ASSERT_THAT(rival.with, ElementsAre("u: x[u]^5"));
  EXPECT_TRUE(rival.fitted);
  // The odds are those of two refits without a search. Kinds with one of two
  // and none of one candidate a term cost 2 ln(2 / 2) and 2 ln(2 / 1).
  double deviances[2];
  for (int k = 0; k < 2; ++k) {
    equation_.terms[0].basis = k == 0 ? "x[u]^3" : "x[u]^5";
    DiscoveryOptions options;
    options.search = false;
    Discovery alone;
    ASSERT_TRUE(RefitEquations(problem_, model_, {equation_}, options, options_,
                               nullptr, nullptr, &alone, &error_))
        << error_;
    ASSERT_EQ(alone.num_terms(), 1);
    EXPECT_TRUE(std::isnan(alone.equations[0].terms[0].probability));
    deviances[k] = Deviance(problem_, alone.summary);
  }
  const double odds =
      std::exp(-0.5 * (deviances[1] - deviances[0]) - std::log(2.0));
  EXPECT_NEAR(std::exp(rival.log_odds), odds, 0.02 * odds);
  EXPECT_NEAR(discovery.equations[0].terms[0].probability, 1.0 / (1.0 + odds),
              0.01);
}

// P_j are the probabilities of the two candidates that are no terms, and P that
// of the term. Sets with the term and more have at most the weight sum P_j. A
// set holds at most two candidates, and sets without the term weigh 1 - P, so
// that they have at least (sum P_j) / 2 - (1 - P).
TEST_F(RefitTest, SetsWithMoreTermsHaveTheRestOfTheProbability) {
  OfferInNoise(0.9);
  Discovery discovery;
  ASSERT_TRUE(Refit(&discovery)) << error_;
  ASSERT_EQ(discovery.num_terms(), 1);
  std::vector<DiscoveredEquation> equations = discovery.equations;
  std::vector<int> substeps;
  for (const IdentificationRecord& record : discovery.problem.records) {
    substeps.push_back(record.substeps);
  }
  InnerFit inner;
  RivalComparison comparison;
  ASSERT_TRUE(CompareWithRivals(
      {problem_, discovery.problem, discovery.summary, discovery.model,
       substeps, discovery.equations},
      DiscoveryOptions(),
      TermPrices(NumFittedValues(problem_), discovery.equations), options_,
      &inner, &equations, &comparison, &error_))
      << error_;
  const double probability = equations[0].terms[0].probability;
  double others = 0.0;
  for (const DiscoveryCandidate& candidate : equations[0].candidates) {
    if (candidate.basis != equations[0].terms[0].basis) {
      others += candidate.probability;
    }
  }
  EXPECT_LE(comparison.incomplete, others + 1e-12);
  EXPECT_GE(comparison.incomplete, 0.5 * others - (1.0 - probability));
  // Even a candidate that fits noise alone has some weight.
  EXPECT_GT(comparison.incomplete, 0.02);
}

TEST_F(RefitTest, UncertainTermIsAFindingThatNamesItsRival) {
  equation_.terms[0].probability = 0.96;
  const std::vector<TermRival> rivals = {
      {{"u: x[u]^3"}, {"u: x[u]^5", "u: v[u]^3"}, -0.5, true}};
  EXPECT_THAT(CheckTerms({equation_}, rivals, 0.0, true), IsEmpty());
  equation_.terms[0].probability = 0.62;
  const std::vector<Finding> findings =
      CheckTerms({equation_}, rivals, 0.0, true);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].check, "uncertain_term");
  EXPECT_EQ(findings[0].what,
            "the records do not decide about a term: u: x[u]^3 or u: x[u]^5 + "
            "u: v[u]^3 (62 %)");
  EXPECT_EQ(findings[0].number, 0.62);
  EXPECT_EQ(Verdict(findings).grade(), Grade::kWithCare);
}

TEST_F(RefitTest, CandidateThatIsProbablyATermIsAFinding) {
  equation_.terms[0].probability = 0.99;
  equation_.candidates.resize(2);
  equation_.candidates[0].basis = equation_.terms[0].basis;
  equation_.candidates[0].probability = 0.99;
  equation_.candidates[1].basis = "v[u]^3";
  equation_.candidates[1].probability = 0.4;
  EXPECT_THAT(CheckTerms({equation_}, {}, 0.0, true), IsEmpty());
  equation_.candidates[1].probability = 0.7;
  const std::vector<Finding> findings = CheckTerms({equation_}, {}, 0.0, true);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].check, "missing_term");
  EXPECT_THAT(findings[0].what, ::testing::HasSubstr("u: v[u]^3 (70 %)"));
  EXPECT_EQ(Verdict(findings).grade(), Grade::kWithCare);
}

// Noise may spread the probability of one weak term over many candidates.
TEST_F(RefitTest, AnyTermThatMayBeMissingIsAFinding) {
  equation_.terms[0].probability = 0.99;
  equation_.candidates.resize(3);
  equation_.candidates[0].basis = equation_.terms[0].basis;
  equation_.candidates[0].probability = 0.99;
  equation_.candidates[1].basis = "x[u]^5";
  equation_.candidates[1].probability = 0.2;
  equation_.candidates[2].basis = "v[u]^3";
  equation_.candidates[2].probability = 0.3;
  EXPECT_THAT(CheckTerms({equation_}, {}, 0.35, true), IsEmpty());
  EXPECT_THAT(CheckTerms({equation_}, {}, kNaN, true), IsEmpty());
  const std::vector<Finding> findings = CheckTerms({equation_}, {}, 0.47, true);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].check, "missing_term");
  EXPECT_EQ(findings[0].what,
            "the equations may lack a term, which noise hides (47 %), such as "
            "u: v[u]^3 (30 %), u: x[u]^5 (20 %)");
  EXPECT_EQ(findings[0].number, 0.47);
  EXPECT_EQ(Verdict(findings).grade(), Grade::kWithCare);
}

// "A or B" and "B is missing" would contradict each other. B may be likely
// beside A even so.
TEST_F(RefitTest, RivalOfAnUncertainTermIsNotMissing) {
  equation_.terms[0].probability = 0.4;
  equation_.candidates.resize(2);
  equation_.candidates[0].basis = "x[u]^5";
  equation_.candidates[0].probability = 0.6;
  equation_.candidates[1].basis = "v[u]^3";
  equation_.candidates[1].probability = 0.1;
  const std::vector<TermRival> rivals = {
      {{"u: x[u]^3"}, {"u: x[u]^5"}, 0.4, true}};
  std::vector<Finding> findings = CheckTerms({equation_}, rivals, 0.0, true);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_THAT(findings[0].what, HasSubstr("u: x[u]^3 or u: x[u]^5 (40 %)"));
  // At least 0.9 + 0.997 - 1 of the weight has both.
  equation_.terms[0].probability = 0.9;
  equation_.candidates[0].probability = 0.997;
  equation_.candidates[1].probability = 0.7;
  findings = CheckTerms({equation_}, rivals, 0.0, true);
  ASSERT_EQ(findings.size(), 2u);
  EXPECT_EQ(findings[1].check, "missing_term");
  EXPECT_THAT(findings[1].what,
              HasSubstr("lack 2 terms, which noise hides: u: x[u]^5 (100 %), "
                        "u: v[u]^3 (70 %)"));
}

TEST_F(RefitTest, ComparisonTakesTheBetterTerms) {
  OfferInNoise(0.9);
  equation_.terms[0].basis = "x[u]^5";
  DiscoveryOptions options;
  options.search = false;
  Discovery quintic;
  ASSERT_TRUE(RefitEquations(problem_, model_, {equation_}, options, options_,
                             nullptr, nullptr, &quintic, &error_))
      << error_;
  const TermPrices prices(NumFittedValues(problem_), {equation_});
  InnerFit inner(nullptr);
  const auto compare = [&](const IdentifiedModel& model) {
    RivalComparison comparison;
    EXPECT_TRUE(CompareWithRivals({problem_,
                                   quintic.problem,
                                   quintic.summary,
                                   model,
                                   {quintic.problem.records[0].substeps},
                                   quintic.equations},
                                  {}, prices, options_, &inner,
                                  &quintic.equations, &comparison, &error_))
        << error_;
    return comparison;
  };
  const RivalComparison comparison = compare(quintic.model);
  ASSERT_EQ(comparison.better.size(), 1u);
  ASSERT_EQ(comparison.better[0].terms.size(), 1u);
  EXPECT_EQ(comparison.better[0].terms[0].basis, "x[u]^3");
  EXPECT_LT(quintic.equations[0].terms[0].probability, 0.5);
  // Trajectories that diverge allow no comparison. Probabilities of the last
  // one must not stay.
  IdentifiedModel far = quintic.model;
  far.parameters.setConstant(1e9);
  quintic.equations[0].terms[0].coefficient = 1e9;
  EXPECT_TRUE(compare(far).rivals.empty());
  EXPECT_TRUE(std::isnan(quintic.equations[0].terms[0].probability));
  const std::vector<Finding> findings =
      CheckTerms(quintic.equations, {}, kNaN, true);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].check, "uncertain_term");
  EXPECT_THAT(findings[0].what, HasSubstr("could not be compared"));
  EXPECT_EQ(Verdict(findings).grade(), Grade::kWithCare);
  EXPECT_THAT(CheckTerms(quintic.equations, {}, kNaN, false), IsEmpty());
}

TEST_F(RefitTest, TermThatTheRecordShowsIsCertain) {
  OfferInNoise(0.002);
  Discovery discovery;
  ASSERT_TRUE(Refit(&discovery)) << error_;
  ASSERT_EQ(discovery.num_terms(), 1);
  EXPECT_EQ(discovery.equations[0].terms[0].basis, "x[u]^3");
  EXPECT_GT(discovery.equations[0].terms[0].probability, 0.98);
  const Verdict verdict = discovery.verdict();
  for (const Finding& finding : verdict.findings()) {
    EXPECT_NE(finding.check, "uncertain_term");
  }
}

TEST_F(RefitTest, GivenCoefficientsStayAndSignsAreBounds) {
  equation_.terms[0].coefficient = -2.1;
  equation_.terms[0].given = true;
  Add("v[u]", -0.05, 3.0);
  equation_.terms[1].sign = -1;
  IdentificationProblem found;
  IdentifiedModel initial;
  ASSERT_TRUE(MakeDiscoveredProblem(problem_, model_, {equation_}, {}, &found,
                                    &initial, &error_))
      << error_;
  const std::vector<Parameter>& xi =
      found.dynamics->laws()[0].parameters.parameters;
  EXPECT_FALSE(xi[0].free);
  EXPECT_EQ(xi[0].value, -2.1);
  EXPECT_TRUE(xi[1].free);
  EXPECT_EQ(xi[1].upper, 0.0);
}

TEST_F(RefitTest, RefusesWhatDoesNotFitTogether) {
  Discovery discovery;
  const auto refusal = [&] {
    error_.clear();
    EXPECT_FALSE(Refit(&discovery));
    return error_;
  };
  const DiscoveredEquation good = equation_;
  equation_.output = "w";
  EXPECT_THAT(refusal(), HasSubstr("'w' is neither a DOF"));
  equation_ = good;
  equation_.terms[0].basis = "x[w]^3";
  EXPECT_THAT(refusal(), HasSubstr("x[w]"));
  equation_ = good;
  equation_.feature_names.pop_back();
  EXPECT_THAT(refusal(), HasSubstr("name for every feature"));
  equation_ = good;
  equation_.features[1].a = 4;
  EXPECT_FALSE(refusal().empty());
  equation_ = good;
  equation_.candidates.emplace_back();
  equation_.candidates[0].basis = "sin(";
  EXPECT_FALSE(refusal().empty());
  equation_ = good;
  model_.parameters.conservativeResize(1);
  EXPECT_THAT(refusal(), HasSubstr("parameters"));
  model_.parameters = ParameterLayout(problem_).InitialValues();
  options_.max_num_iterations = -1;
  EXPECT_THAT(refusal(), HasSubstr("max_iterations"));
  options_ = {};
  const std::vector<DiscoveredEquation> resumed;
  EXPECT_FALSE(RefitEquations(problem_, model_, {equation_}, {}, options_,
                              &resumed, nullptr, &discovery, &error_));
  EXPECT_THAT(error_, HasSubstr("other equations"));
  IdentificationProblem found;
  IdentifiedModel initial;
  EXPECT_FALSE(MakeDiscoveredProblem(problem_, model_, {equation_}, {1, 1},
                                     &found, &initial, &error_));
  EXPECT_THAT(error_, HasSubstr("2 records, expected 1"));
}

}  // namespace
}  // namespace pinode
