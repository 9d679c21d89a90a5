#include "pinode/study/terms/term_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/dynamics/elements.h"
#include "pinode/integrate/rk4.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/study/problem/checkpoint.h"
#include "pinode/study/problem/make_problem.h"
#include "pinode/study/terms/library_term.h"
#include "tests/support/gaussian_testing.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;

constexpr int kTwinSamples = 1000;
constexpr double kTwinStep = 0.04;

// What drives the twin.
double TwinForce(double t) {
  return 4.0 * std::sin(2.3 * t) + 3.0 * std::sin(3.4 * t + 1.0) +
         2.5 * std::sin(5.9 * t + 2.0) + 2.0 * std::sin(0.9 * t + 0.4);
}

// x'' + 0.5 x' + 9 x + cubic x^3 + friction tanh(x' / 0.1) = force, from rest,
// by Runge-Kutta steps of its own.
Vector TwinDisplacement(double cubic, double friction) {
  constexpr int kTwinSubsteps = 40;
  Vector result(kTwinSamples);
  double state[] = {0.0, 0.0};
  Rk4Scratch<double> scratch(2);
  const double h = kTwinStep / kTwinSubsteps;
  for (int i = 0; i < kTwinSamples; ++i) {
    result[i] = state[0];
    for (int s = 0; s < kTwinSubsteps; ++s) {
      Rk4Step(
          [&](int, double t, const double* x, double* rate) {
            rate[0] = x[1];
            rate[1] = TwinForce(t) - 9.0 * x[0] - 0.5 * x[1] -
                      cubic * x[0] * x[0] * x[0] -
                      friction * std::tanh(x[1] / 0.1);
          },
          i * kTwinStep + s * h, h, state, &scratch);
    }
  }
  return result;
}

double SpreadOf(const Vector& values) {
  return std::sqrt((values.array() - values.mean()).square().mean());
}

// White noise of a unit deviation, or the same through a first-order filter.
Vector TwinNoise(uint64_t seed, double memory) {
  testing::Gaussian random(seed);
  Vector noise = random.Draw(kTwinSamples);
  for (int i = 1; i < kTwinSamples; ++i) {
    noise[i] =
        memory * noise[i - 1] + std::sqrt(1.0 - memory * memory) * noise[i];
  }
  return noise;
}

class TermChoiceTest : public ::testing::Test {
 protected:
  // The twin with free damping and stiffness, six terms, and, with
  // `with_elements`, friction and a hysteretic spring.
  void Make(const Vector& displacement, bool with_elements) {
    const Matrix one = Matrix::Ones(1, 1);
    const StructuralModel model =
        MakeStructuralModel(one, 0.4 * one, 8.0 * one, {"u"});
    StructureTerms terms;
    terms.groups = {MakeFreeGroup("c", MatrixGroup::Target::kDamping, one),
                    MakeFreeGroup("k", MatrixGroup::Target::kStiffness, one)};
    const std::vector<InputSpec> inputs = {
        {InputSpec::Kind::kForce, 0, "force_u"}};
    if (with_elements) {
      terms.laws.push_back(testing::MakeElement(
          "friction", "coulomb", 1, Feature::kGround, 0, {0.0, 0.1}));
      terms.laws.back().parameters.parameters[1].free = false;
      terms.laws.push_back(testing::MakeElement("hysteresis", "bouc_wen", 1,
                                                Feature::kGround, 0,
                                                {0.1, 1.0, 1.0, 1.0, 1.0}));
      for (const size_t fixed : {1u, 4u}) {
        terms.laws.back().parameters.parameters[fixed].free = false;
      }
      for (const LawTerm& law : terms.laws) {
        candidates_.push_back(
            ElementCandidate(law, ElementParameters(law.type)));
      }
    }
    LibrarySpec spec;
    spec.name = "nl";
    spec.features = {Feature::Displacement(0), Feature::Velocity(0)};
    spec.output = "u";
    spec.acts_as = ActsAs::kForce;
    for (const char* basis :
         {"x[u]^2", "x[u]^3", "x[u]*v[u]", "v[u]^2", "x[u]^2*v[u]", "v[u]^3"}) {
      spec.coefficients.push_back({basis, Parameter()});
    }
    StructuralDynamics dynamics(model, inputs);
    LawTerm library;
    ASSERT_TRUE(
        MakeLibraryTerm(spec, dynamics, UnitSystem(), &library, &error_))
        << error_;
    terms.laws.push_back(library);
    for (int k = 0; k < 6; ++k) {
      candidates_.push_back(LibraryCandidate(library, k));
    }
    ASSERT_TRUE(MakeProblem(model, inputs, terms, &problem_, &error_))
        << error_;
    Matrix force(1, kTwinSamples);
    for (int i = 0; i < kTwinSamples; ++i)
      force(0, i) = TwinForce(kTwinStep * i);
    MeasuredChannel channel =
        testing::MakeChannel("x", Quantity::kDisplacement, 1, 0);
    channel.values = displacement;
    ASSERT_TRUE(AddRecord("run", kTwinStep, force, Interpolation::kBandLimited,
                          {channel}, &problem_, &error_))
        << error_;
    ChooseStepsOrFail(&problem_);
  }

  // The choice after a fit with all candidates.
  TermFit Choose(IdentificationWatch* watch = nullptr) {
    TermFit fit;
    fit.problem = problem_;
    FitOnce(problem_, options_, nullptr, &fit.summary, &fit.model);
    // With all candidates it may come to a halt: some are nearly the same.
    EXPECT_NE(fit.summary.termination, Termination::kFailure);
    InnerFit inner(watch);
    EXPECT_TRUE(
        ChooseTerms(problem_, candidates_, options_, &inner, &fit, &error_))
        << error_;
    if (fit.choice.complete) {
      EXPECT_EQ(WhyNotSound(GapTuning(), fit.summary), "");
    }
    return fit;
  }

  static std::vector<std::string> Kept(const ModelChoice& choice) {
    std::vector<std::string> kept;
    for (const std::string& name : choice.candidates) {
      if (std::count(choice.left_out.begin(), choice.left_out.end(), name) ==
          0) {
        kept.push_back(name);
      }
    }
    return kept;
  }

  std::string error_;
  IdentificationProblem problem_;
  std::vector<ModelCandidate> candidates_;
  IdentificationOptions options_;
};

Vector WithTwinNoise(const Vector& clean, uint64_t seed, double memory) {
  return clean + 0.01 * SpreadOf(clean) * TwinNoise(seed, memory);
}

using TermChoiceFigures = TermChoiceTest;

TEST_F(TermChoiceFigures, FindsTheCubicTermAmongSixInWhiteNoise) {
  const Vector clean = TwinDisplacement(4.0, 0.0);
  for (const uint64_t seed : {1, 2, 3, 4, 5}) {
    candidates_.clear();
    Make(WithTwinNoise(clean, seed, 0.0), false);
    const TermFit fit = Choose();
    const ModelChoice& choice = fit.choice;
    EXPECT_THAT(Kept(choice), ElementsAre("nl.x[u]^3")) << seed;
    EXPECT_TRUE(choice.complete);
    EXPECT_LT(choice.memory, 1.5);
    // The fit is that of what is left.
    const ParameterLayout layout(fit.problem);
    EXPECT_EQ(layout.num_parameters(), 3);
    const int cubic = layout.FreeIndex("nl.x[u]^3");
    ASSERT_GE(cubic, 0);
    EXPECT_NEAR(layout.Free(fit.model.parameters)[cubic], 4.0, 0.1) << seed;
    EXPECT_THAT(fit.choice.Sentence(),
                HasSubstr("Model choice: 6 candidates, 1 kept "
                          "(nl.x[u]^3). Left out: nl.x[u]^2, "));
    // Results of the choice are known as those of the whole problem.
    EXPECT_EQ(ProblemIdentity(fit.problem), ProblemIdentity(problem_));
  }
}

// Samples of noise that remembers are fewer than they look: by 1.9 / 0.1 for
// this one.
TEST_F(TermChoiceFigures, FindsTheCubicTermAmongSixInColouredNoise) {
  const Vector clean = TwinDisplacement(4.0, 0.0);
  for (const uint64_t seed : {11, 12, 13, 14, 15}) {
    candidates_.clear();
    Make(WithTwinNoise(clean, seed, 0.9), false);
    const TermFit fit = Choose();
    EXPECT_THAT(Kept(fit.choice), ElementsAre("nl.x[u]^3")) << seed;
    EXPECT_GT(fit.choice.memory, 4.0);
    EXPECT_LT(fit.choice.memory, 40.0);
  }
}

TEST_F(TermChoiceFigures, LeavesOutElementsThatAreNotThere) {
  Make(WithTwinNoise(TwinDisplacement(4.0, 0.0), 21, 0.0), true);
  const TermFit fit = Choose();
  EXPECT_THAT(Kept(fit.choice), ElementsAre("nl.x[u]^3"));
  EXPECT_THAT(fit.choice.left_out_parameters,
              IsSupersetOf({"friction.f", "friction.v0", "hysteresis.k",
                            "hysteresis.n"}));
  // The hysteretic state went with its element.
  EXPECT_EQ(fit.problem.dynamics->num_states(), 2);
  EXPECT_EQ(problem_.dynamics->num_states(), 3);
}

TEST_F(TermChoiceFigures, KeepsTheFrictionThatIsThere) {
  Make(WithTwinNoise(TwinDisplacement(0.0, 0.6), 22, 0.0), true);
  const TermFit fit = Choose();
  EXPECT_THAT(Kept(fit.choice), ElementsAre("friction"));
  const ParameterLayout layout(fit.problem);
  const int friction = layout.FreeIndex("friction.f");
  ASSERT_GE(friction, 0);
  EXPECT_NEAR(layout.Free(fit.model.parameters)[friction], 0.6, 0.03);
}

TEST_F(TermChoiceTest, EachStepMakesTheCriterionSmaller) {
  Make(WithTwinNoise(TwinDisplacement(4.0, 0.0), 31, 0.0), false);
  struct CountingWatch : IdentificationWatch {
    void OnChoice(const IdentificationProblem&,
                  const Checkpoint& checkpoint) override {
      EXPECT_EQ(static_cast<int>(checkpoint.choice.steps.size()), ++calls);
    }
    int calls = 0;
  } watch;
  const TermFit fit = Choose(&watch);
  double left_out = 0.0;
  for (const ModelChoice::Step& step : fit.choice.steps) {
    EXPECT_EQ(step.accepted, step.fitted && step.criterion() < 0.0);
    const double change = static_cast<double>(step.taken_in.size()) -
                          static_cast<double>(step.left_out.size());
    // ln(1000) + 2 ln(6) each.
    EXPECT_NEAR(step.price, 10.491274217 * change, 1e-6);
    if (step.accepted) left_out -= change;
  }
  EXPECT_EQ(left_out, 5.0);
  EXPECT_EQ(watch.calls, static_cast<int>(fit.choice.steps.size()));
}

// A fit that is cut off leaves what was chosen by then, and the choice goes on
// from there.
TEST_F(TermChoiceTest, GoesOnAfterAnInterrupt) {
  Make(WithTwinNoise(TwinDisplacement(4.0, 0.0), 41, 0.0), true);
  struct StoppingWatch : IdentificationWatch {
    bool OnIteration(const std::string&, const IdentificationProblem&,
                     const IdentificationProgress&) override {
      return !stop;
    }
    void OnChoice(const IdentificationProblem&,
                  const Checkpoint& checkpoint) override {
      stop = stop || !checkpoint.choice.left_out.empty();
    }
    bool stop = false;
  } watch;
  const TermFit cut_off = Choose(&watch);
  EXPECT_EQ(cut_off.summary.termination, Termination::kInterrupted);
  EXPECT_FALSE(cut_off.choice.complete);
  const ModelChoice& chosen = cut_off.choice;
  EXPECT_LT(chosen.left_out.size(), 7u);
  EXPECT_EQ(ParameterLayout(cut_off.problem).num_parameters() +
                static_cast<int>(chosen.left_out_parameters.size()),
            ParameterLayout(problem_).num_parameters());
  EXPECT_THAT(cut_off.choice.Sentence(),
              HasSubstr("Model choice (interrupted): 8 candidates"));

  TermFit fit = cut_off;
  InnerFit inner;
  ASSERT_TRUE(
      ChooseTerms(problem_, candidates_, options_, &inner, &fit, &error_))
      << error_;
  EXPECT_THAT(Kept(fit.choice), ElementsAre("nl.x[u]^3"));
  EXPECT_TRUE(fit.choice.complete);
  EXPECT_THAT(fit.choice.left_out, Contains(chosen.left_out[0]));
}

TEST_F(TermChoiceTest, KnownStartsLoseTheStatesThatGo) {
  Make(WithTwinNoise(TwinDisplacement(4.0, 0.0), 51, 0.0), true);
  problem_.records[0].start = IdentificationRecord::Start::kKnown;
  problem_.records[0].known_start = Vector::LinSpaced(3, 1.0, 3.0);
  IdentificationProblem rest;
  ASSERT_TRUE(LeaveOut(problem_, {candidates_[1]}, &rest, &error_)) << error_;
  EXPECT_EQ(rest.records[0].known_start, Vector::LinSpaced(2, 1.0, 2.0));
  EXPECT_EQ(rest.dynamics->laws().size(), 2u);
  // A library without its functions is none.
  ASSERT_TRUE(LeaveOut(problem_, {candidates_.begin() + 2, candidates_.end()},
                       &rest, &error_))
      << error_;
  EXPECT_EQ(rest.dynamics->laws().size(), 2u);
}

TEST_F(TermChoiceTest, RefusesCandidatesThatCannotBeChosen) {
  Make(WithTwinNoise(TwinDisplacement(4.0, 0.0), 61, 0.0), true);
  ModelCandidate other = candidates_[0];
  other.name = other.law = "other";
  EXPECT_FALSE(AreCandidatesOf(problem_, {other}, &error_));
  EXPECT_THAT(error_, HasSubstr("'other' is not a term of the model"));
  EXPECT_FALSE(
      AreCandidatesOf(problem_, {candidates_[0], candidates_[0]}, &error_));
  EXPECT_THAT(error_, HasSubstr("'friction' is given twice"));
  ModelCandidate fixed = candidates_[0];
  fixed.amplitudes = {"friction.v0"};
  EXPECT_FALSE(AreCandidatesOf(problem_, {fixed}, &error_));
  EXPECT_THAT(error_, HasSubstr("no coefficient of its force is free"));
  IdentificationProblem untrained = problem_;
  untrained.records[0].role = IdentificationRecord::Role::kHoldout;
  EXPECT_FALSE(AreCandidatesOf(untrained, candidates_, &error_));
  EXPECT_THAT(error_, HasSubstr("no training record"));
  EXPECT_TRUE(AreCandidatesOf(problem_, candidates_, &error_)) << error_;
}

}  // namespace
}  // namespace pinode
