#include "pinode/study/identify/step_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/statistics.h"
#include "pinode/dynamics/elements.h"
#include "pinode/integrate/rk4.h"
#include "pinode/problem/record_grid.h"
#include "pinode/study/identify/identify.h"
#include "pinode/study/problem/checkpoint.h"
#include "pinode/study/problem/identification_watch.h"
#include "pinode/study/problem/make_problem.h"
#include "pinode/study/problem/substeps.h"
#include "pinode/study/terms/library_term.h"
#include "pinode/study/terms/model_candidate.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/gaussian_testing.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

// A chain of three with a stiff top, and a spring that hardens, which is not
// known to be there before the fit.
IdentificationProblem Hardening(double sigma) {
  auto dynamics = testing::MakeGroupedChain(3, 100.0, 0.5);
  std::string error;
  EXPECT_TRUE(
      dynamics->AddElement("hard", "cubic", Feature::kGround, 0, {0.0}, &error))
      << error;
  IdentificationProblem problem;
  IdentificationRecord record =
      testing::MakeExcitedRecord(*dynamics, 400, 0.05);
  record.start = IdentificationRecord::Start::kRest;
  for (int i = 0; i < 3; ++i) {
    record.channels.push_back(testing::MakeChannel(
        "x" + std::to_string(i + 1), Quantity::kDisplacement, 3, i));
  }
  Vector truth = Vector::Zero(4);
  truth[3] = 4000.0;
  record.substeps = 64;
  testing::Simulate(*dynamics, truth, Vector::Zero(6), sigma, 5, &record);
  record.substeps = 0;
  record.integrator = Integrator::kExponential;
  problem.dynamics = dynamics;
  problem.records.push_back(std::move(record));
  ChooseStepsOrFail(&problem);
  return problem;
}

TEST(StepCheck, SeesTheStepsWhereTheyCount) {
  TestFit fit;
  fit.problem = Hardening(1e-3);
  IdentificationRecord& record = fit.problem.records[0];
  // Nothing hardens yet.
  EXPECT_EQ(record.exponential_steps, 1);
  const auto identify = [&fit] {
    testing::FitAndJudge(fit.problem, IdentificationOptions(), nullptr,
                         &fit.summary, &fit.model);
    ASSERT_EQ(fit.summary.termination, Termination::kConverged)
        << fit.summary.message;
  };
  identify();
  StepCheck check;
  ASSERT_TRUE(CheckStepsAtFit(fit.problem, fit.summary, fit.model, 1, &check));
  EXPECT_GT(check.shift, 0.1);
  EXPECT_THAT(check.Sentence(), HasSubstr("'" + check.parameter + "'"));
  // What it promises is what a fit with so many steps comes to.
  const double before =
      fit.model.parameters
          [ParameterLayout(fit.problem)
               .free()[static_cast<size_t>(
                   ParameterLayout(fit.problem).FreeIndex(check.parameter))]];
  TestFit fine = fit;
  fine.problem.records[0].exponential_steps *= 2;
  testing::FitAndJudge(fine.problem, IdentificationOptions(), nullptr,
                       &fine.summary, &fine.model);
  const double after =
      fine.model.parameters
          [ParameterLayout(fit.problem)
               .free()[static_cast<size_t>(
                   ParameterLayout(fit.problem).FreeIndex(check.parameter))]];
  EXPECT_NEAR(after - before, check.change, 0.2 * std::abs(check.change));

  // As asked for, with steps that are chosen.
  EXPECT_TRUE(record.substeps_chosen);
  const std::string identity = ProblemIdentity(fit.problem);
  ASSERT_TRUE(RefineSteps(check, &fit.problem));
  // A checkpoint stays one of this problem.
  EXPECT_EQ(ProblemIdentity(fit.problem), identity);
  EXPECT_GT(record.exponential_steps, 1);
  identify();
  ASSERT_TRUE(CheckStepsAtFit(fit.problem, fit.summary, fit.model, 1, &check));
  EXPECT_LT(check.shift, 0.1);
  EXPECT_FALSE(RefineSteps(check, &fit.problem));
}

// A chain with a stop that is hit, perhaps with a mode at 5 kHz.
IdentificationProblem WithAStop(bool stiff, bool with_stop,
                                std::optional<Integrator> integrator) {
  StructuralModel model = testing::MakeChain(3, 100.0, 0.5);
  if (stiff) {
    const double square = std::pow(2.0 * 3.14159265358979 * 5000.0, 2);
    model.stiffness(2, 2) += square;
    model.damping(2, 2) += 0.02 * std::sqrt(square);
  }
  auto dynamics = std::make_shared<StructuralDynamics>(
      model, std::vector<InputSpec>{
                 {InputSpec::Kind::kGroundAcceleration, 0, "ground"}});
  std::string error;
  EXPECT_TRUE(with_stop
                  ? dynamics->AddElement("stop", "bilinear", Feature::kGround,
                                         0, {200.0, 0.01}, &error)
                  : dynamics->AddElement("hard", "cubic", Feature::kGround, 0,
                                         {500.0}, &error))
      << error;
  IdentificationProblem problem;
  IdentificationRecord record =
      testing::MakeExcitedRecord(*dynamics, 400, 0.02);
  record.start = IdentificationRecord::Start::kRest;
  record.channels.push_back(
      testing::MakeChannel("x1", Quantity::kDisplacement, 3, 0));
  record.substeps = stiff ? 1600 : 16;
  testing::Simulate(*dynamics, dynamics->Parameters(), Vector::Zero(6), 0.0, 1,
                    &record);
  record.channels[0].sigma =
      1e-4 * StandardDeviationOfPresent(record.channels[0].values);
  record.substeps = 0;
  record.integrator = integrator;
  problem.dynamics = dynamics;
  problem.records.push_back(std::move(record));
  ChooseStepsOrFail(&problem);
  return problem;
}

int StepsWithAStop(bool stiff, bool with_stop) {
  return WithAStop(stiff, with_stop, Integrator::kExponential)
      .records[0]
      .exponential_steps;
}

TEST(ExponentialSteps, AreNotMoreForAModeAtFiveKilohertz) {
  EXPECT_LE(StepsWithAStop(true, false), StepsWithAStop(false, false));
  const int with_a_stop = StepsWithAStop(false, true);
  EXPECT_GT(with_a_stop, 1);
  EXPECT_LE(StepsWithAStop(true, true), 2 * with_a_stop);
}

TEST(ExponentialSteps, AreChosenWhereRungeKuttaNeedsMore) {
  const auto chosen = [](bool stiff, std::optional<Integrator> integrator) {
    const IdentificationProblem problem = WithAStop(stiff, false, integrator);
    return IntegratorOf(*problem.dynamics, problem.records[0]);
  };
  EXPECT_EQ(chosen(true, std::nullopt), Integrator::kExponential);
  EXPECT_EQ(chosen(false, std::nullopt), Integrator::kRungeKutta);
  EXPECT_EQ(chosen(true, Integrator::kRungeKutta), Integrator::kRungeKutta);
}

TEST(StepCheck, HasNothingToSayOfTheExactSolution) {
  const IdentificationProblem problem =
      MeasuredChain(2, *ChainAt(Eigen::Vector2d(0.1, -0.1)), 3);
  const TestFit fit = FitOf(problem);
  StepCheck check;
  EXPECT_FALSE(CheckStepsAtFit(fit.problem, fit.summary, fit.model, 1, &check));
}

// x'' + 0.2 x' + 57 x + 1.5 tanh(x' / 0.01) = 0, a dry friction whose steep law
// the chosen steps do not resolve: they are found for the initial model, in
// which it does not act.
class DryFriction : public ::testing::Test {
 protected:
  static constexpr double kStep = 0.02;

  void SetUp() override {
    const Matrix one = Matrix::Ones(1, 1);
    const StructuralModel model =
        MakeStructuralModel(one, 0.1 * one, 50.0 * one, {"u"});
    const std::vector<InputSpec> inputs = {
        {InputSpec::Kind::kForce, 0, "force"}};
    StructureTerms terms;
    terms.groups = {MakeFreeGroup("c", MatrixGroup::Target::kDamping, one),
                    MakeFreeGroup("k", MatrixGroup::Target::kStiffness, one)};
    LibrarySpec spec;
    spec.name = "law";
    spec.features = {Feature::Displacement(0), Feature::Velocity(0)};
    spec.output = "u";
    spec.acts_as = ActsAs::kForce;
    for (const char* basis :
         {"tanh(v[u]/0.01)", "tanh(v[u]/0.1)", "abs(x[u])*x[u]"}) {
      spec.coefficients.push_back({basis, Parameter()});
    }
    const StructuralDynamics dynamics(model, inputs);
    LawTerm library;
    ASSERT_TRUE(
        MakeLibraryTerm(spec, dynamics, UnitSystem(), &library, &error_))
        << error_;
    terms.laws.push_back(library);
    for (int k = 0; k < static_cast<int>(spec.coefficients.size()); ++k) {
      extras_.candidates.push_back(LibraryCandidate(library, k));
    }
    ASSERT_TRUE(MakeProblem(model, inputs, terms, &problem_, &error_))
        << error_;
    const Matrix motion = Motion();
    testing::Gaussian random(3);
    std::vector<MeasuredChannel> channels = {
        testing::MakeChannel("x", Quantity::kDisplacement, 1, 0),
        testing::MakeChannel("a", Quantity::kRelativeAcceleration, 1, 0)};
    for (size_t i = 0; i < 2; ++i) {
      const Vector exact = motion.col(static_cast<Eigen::Index>(i));
      channels[i].values = exact + 0.02 * StandardDeviationOfPresent(exact) *
                                       random.Draw(exact.size());
    }
    ASSERT_TRUE(AddRecord("run", kStep, Matrix::Zero(1, motion.rows()),
                          Interpolation::kLinear, channels, &problem_, &error_))
        << error_;
    problem_.records[0].start = IdentificationRecord::Start::kFree;
    ChooseStepsOrFail(&problem_);
  }

  // Displacement and acceleration of the samples, by steps of 0.2 ms.
  static Matrix Motion() {
    constexpr int kSamples = 500;
    constexpr int kSteps = 100;
    const auto acceleration = [](const double* state) {
      return -0.2 * state[1] - 57.0 * state[0] -
             1.5 * std::tanh(state[1] / 0.01);
    };
    Matrix motion(kSamples, 2);
    double state[] = {0.5, 0.0};
    Rk4Scratch<double> scratch(2);
    for (int i = 0; i < kSamples; ++i) {
      motion.row(i) << state[0], acceleration(state);
      for (int s = 0; s < kSteps; ++s) {
        Rk4Step(
            [&](int, double, const double* x, double* rate) {
              rate[0] = x[1];
              rate[1] = acceleration(x);
            },
            0.0, kStep / kSteps, state, &scratch);
      }
    }
    return motion;
  }

  IdentificationProblem problem_;
  IdentificationExtras extras_;
  std::string error_;
};

// Stops the fit of this name.
class StopAt : public IdentificationWatch {
 public:
  explicit StopAt(std::string what) : what_(std::move(what)) {}
  bool OnIteration(const std::string& what, const IdentificationProblem&,
                   const IdentificationProgress&) override {
    has_stopped_ = has_stopped_ || what == what_;
    return !has_stopped_;
  }
  bool has_stopped() const { return has_stopped_; }

 private:
  const std::string what_;
  bool has_stopped_ = false;
};

TEST_F(DryFriction, KeepsWhatWasFoundIfTheSecondChoiceIsInterrupted) {
  for (const char* what : {"finer steps", "all terms, finer steps"}) {
    StopAt watch(what);
    const Identification found =
        Identify(problem_, IdentificationOptions(), extras_, &watch);
    EXPECT_TRUE(watch.has_stopped()) << what;
    EXPECT_EQ(found.summary.termination, Termination::kInterrupted) << what;
    EXPECT_FALSE(found.summary.usable());
    EXPECT_FALSE(found.summary.choice.empty()) << what;
    EXPECT_LT(found.summary.records[0].nrmse, 0.05) << what;
  }
}

TEST_F(DryFriction, HasNoFalseTermsThatMakeUpForLongSteps) {
  EXPECT_EQ(problem_.records[0].substeps, 1);
  const std::string identity = ProblemIdentity(problem_);
  const Identification found =
      Identify(problem_, IdentificationOptions(), extras_, nullptr);
  EXPECT_GT(found.problem.records[0].substeps, 1);
  // A checkpoint stays one of this problem.
  EXPECT_EQ(ProblemIdentity(found.problem), identity);
  EXPECT_TRUE(found.summary.usable()) << found.summary.message;
  EXPECT_THAT(found.summary.choice.left_out,
              ::testing::UnorderedElementsAre("law.tanh(v[u]/0.1)",
                                              "law.abs(x[u])*x[u]"));
  for (const ParameterEstimate& estimate : found.summary.parameters) {
    if (estimate.name != "law.tanh(v[u]/0.01)") continue;
    EXPECT_LT(std::abs(estimate.value - 1.5), 4.0 * estimate.sigma);
  }
  // A checkpoint lacks the terms that were left out.
  extras_.start = &found.model;
  extras_.resumed = true;
  extras_.choice = found.summary.choice;
  const Identification again =
      Identify(problem_, IdentificationOptions(), extras_, nullptr);
  EXPECT_TRUE(again.summary.usable()) << again.summary.message;
  EXPECT_EQ(again.summary.choice.left_out, found.summary.choice.left_out);
}

TEST_F(DryFriction, HoldOutsAreNotRefinedAlone) {
  problem_.records[0].substeps_chosen = false;
  problem_.records.push_back(problem_.records[0]);
  problem_.records[1].role = IdentificationRecord::Role::kHoldout;
  problem_.records[1].substeps_chosen = true;
  StepCheck check;
  check.shift = 5.0;
  EXPECT_FALSE(RefineSteps(check, &problem_));
  EXPECT_EQ(problem_.records[1].substeps, 1);
  problem_.records[0].substeps_chosen = true;
  EXPECT_TRUE(RefineSteps(check, &problem_));
  EXPECT_EQ(problem_.records[0].substeps, 4);
  EXPECT_EQ(problem_.records[1].substeps, 4);
}

TEST_F(DryFriction, KeepsStepsThatAreGiven) {
  problem_.records[0].substeps_chosen = false;
  StepCheck check;
  check.shift = 5.0;
  EXPECT_FALSE(RefineSteps(check, &problem_));
  problem_.records[0].substeps_chosen = true;
  // Runge-Kutta steps make a fit dearer; a remark is not yet worth that.
  check.shift = 0.4;
  EXPECT_FALSE(RefineSteps(check, &problem_));
  check.shift = 5.0;
  EXPECT_TRUE(RefineSteps(check, &problem_));
  EXPECT_EQ(problem_.records[0].substeps, 4);
  check.shift = 1e12;
  EXPECT_TRUE(RefineSteps(check, &problem_));
  EXPECT_EQ(problem_.records[0].substeps, 32);
}

}  // namespace
}  // namespace pinode
