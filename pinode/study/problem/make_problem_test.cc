#include "pinode/study/problem/make_problem.h"

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/constants.h"
#include "pinode/dynamics/elements.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

constexpr int kFrameSamples = 60;
constexpr double kFrameStep = 0.02;

// Data of a program: matrices, a ground motion, and two accelerometers.
struct Arrays {
  StructuralModel model = MakeStructuralModel(
      Matrix::Identity(2, 2), 0.02 * Spring(40.0), Spring(40.0));
  std::vector<InputSpec> inputs = GroundMotion(model);
  StructureTerms terms = {{MakeFreeGroup("k1", MatrixGroup::Target::kStiffness,
                                         40.0 * SpringMatrix(2, -1, 0))},
                          {},
                          {},
                          {},
                          {},
                          {}};
  double step = kFrameStep;
  Matrix ground = Sine(3.0).transpose();
  std::vector<MeasuredChannel> channels = MakeChannels(
      "a", Quantity::kAbsoluteAcceleration,
      (Matrix(kFrameSamples, 2) << Sine(3.0), Sine(4.0)).finished());

  static Matrix Spring(double k) {
    return k * (SpringMatrix(2, -1, 0) + SpringMatrix(2, 0, 1));
  }
  static Vector Sine(double omega) {
    Vector values(kFrameSamples);
    for (int i = 0; i < kFrameSamples; ++i)
      values[i] = std::sin(omega * kFrameStep * i);
    return values;
  }
  bool Make(IdentificationProblem* problem, std::string* error) const {
    return MakeProblem(model, inputs, terms, problem, error) &&
           AddRecord("quake", step, ground, Interpolation::kLinear, channels,
                     problem, error) &&
           PrepareProblem(problem, error);
  }
};

TEST(MakeProblemTest, IsReadyToBeFitted) {
  IdentificationProblem problem;
  std::string error;
  ASSERT_TRUE(Arrays().Make(&problem, &error)) << error;
  EXPECT_TRUE(problem.IsValid(&error)) << error;
  const IdentificationRecord& record = problem.records[0];
  EXPECT_GE(record.substeps, 1);
  EXPECT_TRUE(record.substeps_chosen);
  EXPECT_TRUE(problem.IsDriven(record));
  EXPECT_EQ(problem.UnitOf(record.channels[1]), "m/s^2");
  EXPECT_EQ(problem.LocationOf(record.channels[1]), "u2");
  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(problem, {}, nullptr, &summary, &model);
  EXPECT_NE(summary.termination, Termination::kFailure) << summary.message;
}

TEST(MakeProblemTest, TakesNamedElements) {
  Arrays arrays;
  LawTerm spring;
  std::string error;
  ASSERT_TRUE(MakeElement("stop", "cubic", 2, -1, 1, {5.0}, &spring, &error))
      << error;
  arrays.terms.laws.push_back(spring);
  IdentificationProblem problem;
  ASSERT_TRUE(arrays.Make(&problem, &error)) << error;
  const LawTerm& term = problem.dynamics->laws()[0];
  EXPECT_EQ(term.parameters.parameters[0].name, "stop.k3");
  EXPECT_TRUE(term.parameters.parameters[0].free);
  EXPECT_EQ(term.outputs, Matrix(Vector::Unit(2, 1)));
}

// Every wrong size or number that a caller can pass comes back as a sentence,
// not as an abort, wherever it is noticed.
TEST(MakeProblemTest, SaysWhatIsWrong) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  struct Bad {
    std::string message;
    std::function<void(Arrays*)> spoil;
  };
  const std::vector<Bad> all = {
      {"mass", [](Arrays* a) { a->model.mass = Matrix::Identity(3, 3); }},
      {"mass", [](Arrays* a) { a->model.mass(0, 0) = -1.0; }},
      {"stiffness", [&](Arrays* a) { a->model.stiffness(0, 1) = nan; }},
      {"stiffness", [](Arrays* a) { a->model.stiffness(0, 1) += 1.0; }},
      {"no direction 1", [](Arrays* a) { a->inputs[0].index = 1; }},
      {"no DOF -1",
       [](Arrays* a) {
         a->inputs[0].kind = InputSpec::Kind::kForce;
         a->inputs[0].index = -1;
       }},
      {"group",
       [](Arrays* a) { a->terms.groups[0].group.matrix = Matrix(3, 3); }},
      {"group",
       [](Arrays* a) { a->terms.groups.push_back(a->terms.groups[0]); }},
      {"no parameter is free",
       [](Arrays* a) { a->terms.groups[0].alpha.free = false; }},
      {"bounds", [](Arrays* a) { a->terms.groups[0].alpha.lower = 1.0; }},
      {"not finite", [&](Arrays* a) { a->terms.groups[0].alpha.value = nan; }},
      {"inputs are 2 x 60",
       [](Arrays* a) { a->ground = Matrix::Zero(2, kFrameSamples); }},
      {"inputs are 1 x 1", [](Arrays* a) { a->ground = Matrix::Zero(1, 1); }},
      {"inputs are 0 x 0", [](Arrays* a) { a->ground = Matrix(); }},
      {"not finite", [&](Arrays* a) { a->ground(0, 7) = nan; }},
      {"step is not positive", [](Arrays* a) { a->step = 0.0; }},
      {"step is not positive", [&](Arrays* a) { a->step = nan; }},
      {"too coarse", [](Arrays* a) { a->step = 1e6; }},
      {"no measured channel", [](Arrays* a) { a->channels.clear(); }},
      {"channel 'a1': it has 1 weights, the model has 2 DOFs",
       [](Arrays* a) { a->channels[0].observation.weights = Vector::Ones(1); }},
      {"its length differs",
       [](Arrays* a) { a->channels[0].values.conservativeResize(59); }},
      {"it holds no value",
       [&](Arrays* a) { a->channels[0].values.setConstant(nan); }},
      {"infinite", [](Arrays* a) { a->channels[0].values[3] = kInfinity; }},
      {"negative", [](Arrays* a) { a->channels[0].sigma = -1.0; }},
      {"its gain is sensor parameter 0",
       [](Arrays* a) { a->channels[0].gain = 0; }},
      {"its offset is sensor parameter 3",
       [](Arrays* a) { a->channels[0].offset = 3; }},
      {"its delay is sensor parameter -2",
       [](Arrays* a) { a->channels[0].delay = -2; }},
      {"factor of its unit",
       [](Arrays* a) { a->channels[0].description.factor = 0.0; }},
  };
  for (const Bad& bad : all) {
    Arrays arrays;
    bad.spoil(&arrays);
    IdentificationProblem problem;
    std::string error;
    EXPECT_FALSE(arrays.Make(&problem, &error)) << bad.message;
    EXPECT_THAT(error, HasSubstr(bad.message));
  }
}

// Errors that are only possible if the struct is filled by hand.
TEST(PrepareProblemTest, SaysWhatIsWrongAndChangesNothing) {
  struct Bad {
    std::string message;
    std::function<void(IdentificationProblem*)> spoil;
  };
  const std::vector<Bad> all = {
      {"no model", [](IdentificationProblem* p) { p->dynamics = nullptr; }},
      {"no training record",
       [](IdentificationProblem* p) { p->records.clear(); }},
      {"fewer than two samples",
       [](IdentificationProblem* p) { p->records[0].excitation.reset(); }},
      {"2 standard deviations of inputs",
       [](IdentificationProblem* p) {
         p->records[0].input_sigma = Vector::Ones(2);
       }},
      {"the standard deviation of an input is negative",
       [](IdentificationProblem* p) {
         p->records[0].input_sigma = -Vector::Ones(1);
       }},
      {"Runge-Kutta",
       [](IdentificationProblem* p) { p->records[0].substeps = -1; }},
      {"start needs 4",
       [](IdentificationProblem* p) {
         p->records[0].start = IdentificationRecord::Start::kKnown;
       }},
      {"unit of time",
       [](IdentificationProblem* p) {
         p->records[0].description.time_factor = 0.0;
       }},
      {"'furlong'",
       [](IdentificationProblem* p) {
         p->description.units.length = "furlong";
       }},
      {"truth of force 'blow'",
       [](IdentificationProblem* p) {
         p->description.force_truths = {{"blow", Vector(3), Vector(2)}};
       }},
      {"curve 'data sheet'",
       [](IdentificationProblem* p) {
         p->description.reference_curves = {
             {"k1", "data sheet", Vector::Ones(3), Vector::Ones(2)}};
       }},
  };
  for (const Bad& bad : all) {
    const Arrays arrays;
    IdentificationProblem problem;
    std::string error;
    ASSERT_TRUE(MakeProblem(arrays.model, arrays.inputs, arrays.terms, &problem,
                            &error));
    ASSERT_TRUE(AddRecord("quake", kFrameStep, arrays.ground,
                          Interpolation::kLinear, arrays.channels, &problem,
                          &error));
    bad.spoil(&problem);
    const int before =
        problem.records.empty() ? 0 : problem.records[0].substeps;
    EXPECT_FALSE(PrepareProblem(&problem, &error)) << bad.message;
    EXPECT_THAT(error, HasSubstr(bad.message));
    if (problem.records.empty()) continue;
    EXPECT_EQ(problem.records[0].substeps, before);
    EXPECT_FALSE(problem.records[0].substeps_chosen);
  }
}

TEST(PrepareProblemTest, KeepsStepsThatWereGiven) {
  const Arrays arrays;
  IdentificationProblem problem;
  std::string error;
  ASSERT_TRUE(arrays.Make(&problem, &error)) << error;
  const int chosen = problem.records[0].substeps;
  // Once more changes nothing.
  ASSERT_TRUE(PrepareProblem(&problem, &error)) << error;
  EXPECT_EQ(problem.records[0].substeps, chosen);
  EXPECT_TRUE(problem.records[0].substeps_chosen);
  problem.records[0].substeps = 7;
  problem.records[0].substeps_chosen = false;
  ASSERT_TRUE(PrepareProblem(&problem, &error)) << error;
  EXPECT_EQ(problem.records[0].substeps, 7);
  EXPECT_FALSE(problem.records[0].substeps_chosen);
}

}  // namespace
}  // namespace pinode
