#include "pinode/study/terms/segment_proposal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/discover/discovery.h"
#include "pinode/dynamics/feature.h"
#include "pinode/network/network.h"
#include "pinode/study/laws/refit.h"
#include "pinode/study/terms/term_worth.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

using ::testing::UnorderedElementsAre;

// x'' + 0.08 x' + x + 0.8 x^3 = 0 from x = 1.5, 400 displacements and
// velocities. The model has the mass alone, and a network for all else.
class SegmentProposalTest : public ::testing::Test {
 protected:
  void SetUp() override {
    options_.source = DiscoveryOptions::Source::kDerivatives;
    options_.library.polynomial_degree = 3;
    options_.library.constant = false;
  }

  static std::shared_ptr<StructuralDynamics> Oscillator(double damping,
                                                        double stiffness) {
    return std::make_shared<StructuralDynamics>(
        MakeStructuralModel(Matrix::Ones(1, 1), Matrix::Constant(1, 1, damping),
                            Matrix::Constant(1, 1, stiffness), {"u"}),
        std::vector<InputSpec>());
  }

  void Measure(double noise, uint64_t seed) {
    auto truth = Oscillator(0.08, 1.0);
    ASSERT_TRUE(truth->AddLaw(
        testing::MakeElement("spring", "cubic", 1, Feature::kGround, 0, {0.8}),
        &error_))
        << error_;
    IdentificationRecord record;
    record.name = "free";
    record.excitation.emplace(0.0, 0.05, Matrix(0, 400),
                              Interpolation::kLinear);
    record.start = IdentificationRecord::Start::kFree;
    record.channels = {testing::MakeChannel("x", Quantity::kDisplacement, 1, 0),
                       testing::MakeChannel("v", Quantity::kVelocity, 1, 0)};
    record.substeps = 8;
    testing::Simulate(*truth, truth->Parameters(), Eigen::Vector2d(1.5, 0.0),
                      noise, seed, &record);
    record.substeps = 0;
    auto dynamics = Oscillator(0.0, 0.0);
    NetworkArchitecture architecture;
    architecture.num_inputs = 2;
    architecture.num_outputs = 1;
    NetworkTerm network;
    network.name = "rest";
    network.network = std::make_shared<Network>(architecture);
    network.features = {Feature::Displacement(0), Feature::Velocity(0)};
    network.outputs = Matrix::Ones(1, 1);
    network.output_names = {"u"};
    network.weights.name = "rest";
    for (int i = 0; i < architecture.NumWeights(); ++i) {
      network.weights.parameters.push_back(
          Parameter{"rest[" + std::to_string(i) + "]"});
    }
    ASSERT_TRUE(dynamics->AddNetwork(std::move(network), &error_)) << error_;
    problem_.dynamics = dynamics;
    problem_.records = {std::move(record)};
    ChooseStepsOrFail(&problem_);
    ASSERT_TRUE(DiscoverFromDerivatives(problem_, options_, &equations_,
                                        &model_, &error_))
        << error_;
    ASSERT_EQ(equations_.size(), 1u);
  }

  static std::vector<std::string> TermsOfFirst(
      const std::vector<DiscoveredEquation>& equations) {
    std::vector<std::string> names;
    if (equations.empty()) return names;
    for (const DiscoveredTerm& term : equations[0].terms) {
      names.push_back(term.basis);
    }
    return names;
  }

  std::string error_;
  IdentificationProblem problem_;
  DiscoveryOptions options_;
  IdentifiedModel model_;
  std::vector<DiscoveredEquation> equations_;
};

// At 10 % noise the derivatives are known to a fifth. The choice must not
// depend on the terms that they suggest.
TEST_F(SegmentProposalTest, FindsTheTermsInTenPerCentNoise) {
  for (const uint64_t seed : {1, 2, 3}) {
    equations_.clear();
    Measure(0.1, seed);
    const TermPrices prices(NumFittedValues(problem_), equations_);
    equations_[0].terms.clear();
    std::vector<DiscoveredEquation> proposed;
    ASSERT_TRUE(ProposeFromSegments(problem_, model_, equations_, options_,
                                    prices, 1, &proposed, &error_))
        << error_;
    EXPECT_THAT(TermsOfFirst(proposed),
                UnorderedElementsAre("x[u]", "v[u]", "x[u]^3"))
        << "seed " << seed;
    for (const DiscoveredTerm& term : proposed[0].terms) {
      const double truth = term.basis == "x[u]"   ? -1.0
                           : term.basis == "v[u]" ? -0.08
                                                  : -0.8;
      EXPECT_NEAR(term.coefficient / truth, 1.0, 0.2) << term.basis;
    }
  }
}

// The regression suggests a term that is none. The fits must not stay with it,
// nor end in a minimum beside the record, as free decays over many periods do
// if their start is sought from rest.
TEST_F(SegmentProposalTest, RefitLeavesWrongTermsOfTheRegression) {
  Measure(0.05, 4);
  DiscoveredTerm wrong;
  wrong.basis = "x[u]*v[u]^2";
  wrong.coefficient = -1.0;
  wrong.basis_rms = 1.0;
  wrong.share = 1.0;
  equations_[0].terms = {wrong};
  IdentificationOptions identification;
  identification.num_threads = 1;
  Discovery discovery;
  ASSERT_TRUE(RefitEquations(problem_, model_, equations_, options_,
                             identification, nullptr, nullptr, &discovery,
                             &error_))
      << error_;
  EXPECT_TRUE(discovery.summary.usable()) << discovery.summary.message;
  EXPECT_THAT(TermsOfFirst(discovery.equations),
              UnorderedElementsAre("x[u]", "v[u]", "x[u]^3"));
  for (const DiscoveredTerm& term : discovery.equations[0].terms) {
    const double truth = term.basis == "x[u]"   ? -1.0
                         : term.basis == "v[u]" ? -0.08
                                                : -0.8;
    // Four standard deviations.
    EXPECT_NEAR(term.coefficient, truth, 4.0 * term.sigma) << term.basis;
    EXPECT_LT(term.sigma, 0.02 * -truth) << term.basis;
  }
}

TEST_F(SegmentProposalTest, SaysNothingWithoutSamples) {
  Measure(0.05, 5);
  equations_[0].sample_outputs.resize(0);
  std::vector<DiscoveredEquation> proposed;
  ASSERT_TRUE(ProposeFromSegments(problem_, model_, equations_, options_,
                                  TermPrices(), 1, &proposed, &error_))
      << error_;
  EXPECT_TRUE(proposed.empty());
}

}  // namespace
}  // namespace pinode
