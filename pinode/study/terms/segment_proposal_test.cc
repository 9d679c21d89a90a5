#include "pinode/study/terms/segment_proposal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/constants.h"
#include "pinode/discover/discovery.h"
#include "pinode/dynamics/feature.h"
#include "pinode/network/network.h"
#include "pinode/study/laws/refit.h"
#include "pinode/study/problem/identification_watch.h"
#include "pinode/study/terms/term_worth.h"
#include "tests/support/group_testing.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::IsSupersetOf;
using ::testing::UnorderedElementsAre;

// x'' + 0.08 x' + x + 0.8 x^3 = 0 from x = 1.5, displacements and
// velocities over 20 s. The model has the mass alone, and a network for all
// else.
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

  void Measure(double noise, uint64_t seed, int num_samples) {
    auto truth = Oscillator(0.08, 1.0);
    ASSERT_TRUE(truth->AddLaw(
        testing::MakeElement("spring", "cubic", 1, Feature::kGround, 0, {0.8}),
        &error_))
        << error_;
    IdentificationRecord record;
    record.name = "free";
    record.excitation.emplace(0.0, 20.0 / num_samples, Matrix(0, num_samples),
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

  // Expects the terms of the oscillator, and coefficients within `tolerance` of
  // themselves.
  void ExpectTrueTerms(double tolerance) {
    const TermPrices prices(NumFittedValues(problem_), equations_);
    std::vector<DiscoveredEquation> proposed;
    ASSERT_TRUE(ProposeFromSegments(problem_, model_, equations_, options_,
                                    prices, 1, &proposed, &error_))
        << error_;
    ASSERT_THAT(TermsOfFirst(proposed),
                UnorderedElementsAre("x[u]", "v[u]", "x[u]^3"));
    for (const DiscoveredTerm& term : proposed[0].terms) {
      EXPECT_NEAR(term.coefficient / TruthOf(term), 1.0, tolerance)
          << term.basis;
    }
  }

  static double TruthOf(const DiscoveredTerm& term) {
    return term.basis == "x[u]" ? -1.0 : term.basis == "v[u]" ? -0.08 : -0.8;
  }

  static DiscoveredTerm WrongTerm() {
    DiscoveredTerm wrong;
    wrong.basis = "x[u]*v[u]^2";
    wrong.coefficient = -1.0;
    wrong.basis_rms = 1.0;
    wrong.share = 1.0;
    return wrong;
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
  Measure(0.1, 1, 200);
  equations_[0].terms.clear();
  ExpectTrueTerms(0.2);
}

// A sensor that drops out leaves samples without a value.
TEST_F(SegmentProposalTest, SamplesMayMissAValue) {
  Measure(0.05, 1, 200);
  equations_[0].terms.clear();
  equations_[0].sample_outputs[7] = kNaN;
  equations_[0].sample_features(20, 1) = kNaN;
  ExpectTrueTerms(0.1);
}

TEST_F(SegmentProposalTest, AllCoefficientsMayBeGiven) {
  Measure(0.05, 1, 200);
  auto dynamics = std::make_shared<StructuralDynamics>(*problem_.dynamics);
  GroupTerm spring = testing::MakeGroupTerm(
      "k", MatrixGroup::Target::kStiffness, Matrix::Constant(1, 1, 0.1));
  ASSERT_TRUE(dynamics->AddGroup(spring, &error_)) << error_;
  problem_.dynamics = dynamics;
  ASSERT_TRUE(DiscoverFromDerivatives(problem_, options_, &equations_, &model_,
                                      &error_))
      << error_;
  equations_[0].candidates.clear();
  DiscoveredTerm given;
  given.basis = "x[u]^3";
  given.coefficient = -0.8;
  given.given = true;
  equations_[0].terms = {given};
  std::vector<DiscoveredEquation> proposed;
  ASSERT_TRUE(ProposeFromSegments(problem_, model_, equations_, options_,
                                  TermPrices(), 1, &proposed, &error_))
      << error_;
  EXPECT_THAT(TermsOfFirst(proposed), ElementsAre("x[u]^3"));
}

// The regression suggests a term that is none. The fits must not stay with it,
// nor end in a minimum beside the record, as free decays over many periods do
// if their start is sought from rest.
TEST_F(SegmentProposalTest, RefitLeavesWrongTermsOfTheRegression) {
  Measure(0.05, 4, 200);
  equations_[0].terms = {WrongTerm()};
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
    const double truth = TruthOf(term);
    // Four standard deviations.
    EXPECT_NEAR(term.coefficient, truth, 4.0 * term.sigma) << term.basis;
    EXPECT_LT(term.sigma, 0.02 * -truth) << term.basis;
  }
}

// An interrupt in the second fit, that of the regressed terms, keeps the good
// first fit and is not forgotten.
TEST_F(SegmentProposalTest, AnInterruptKeepsTheTermsOfTheSegments) {
  Measure(0.05, 4, 200);
  equations_[0].terms = {WrongTerm()};
  // The first fit leaves more than this.
  for (Vector& sigmas : model_.sigmas) sigmas *= 0.7;
  int fits = 0;
  options_.on_equations = [&fits](int fit,
                                  const std::vector<DiscoveredEquation>&) {
    fits = std::max(fits, fit);
  };
  struct StoppingWatch : IdentificationWatch {
    bool OnIteration(const std::string&, const IdentificationProblem&,
                     const IdentificationProgress&) override {
      return *num_fits < 2;
    }
    const int* num_fits = nullptr;
  } watch;
  watch.num_fits = &fits;
  IdentificationOptions identification;
  identification.num_threads = 1;
  Discovery discovery;
  ASSERT_TRUE(RefitEquations(problem_, model_, equations_, options_,
                             identification, nullptr, &watch, &discovery,
                             &error_))
      << error_;
  EXPECT_EQ(fits, 2);
  EXPECT_EQ(discovery.summary.termination, Termination::kInterrupted);
  EXPECT_EQ(discovery.summary.message,
            "interrupted before the search for terms");
  EXPECT_THAT(TermsOfFirst(discovery.equations),
              IsSupersetOf({"x[u]", "v[u]", "x[u]^3"}));
}

TEST_F(SegmentProposalTest, SaysNothingWithoutSamples) {
  Measure(0.05, 5, 100);
  equations_[0].sample_outputs.resize(0);
  std::vector<DiscoveredEquation> proposed;
  ASSERT_TRUE(ProposeFromSegments(problem_, model_, equations_, options_,
                                  TermPrices(), 1, &proposed, &error_))
      << error_;
  EXPECT_TRUE(proposed.empty());
}

}  // namespace
}  // namespace pinode
