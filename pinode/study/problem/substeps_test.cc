#include "pinode/study/problem/substeps.h"

#include <cmath>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/dynamics/elements.h"
#include "pinode/integrate/free_run.h"
#include "pinode/integrate/integration_grid.h"
#include "pinode/structure/model/structural_model.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;

constexpr double kOmega = 10.0;

StructuralDynamics Oscillator(double omega = kOmega, double damping = 0.2) {
  return StructuralDynamics(
      MakeStructuralModel(Matrix::Ones(1, 1), Matrix::Constant(1, 1, damping),
                          Matrix::Constant(1, 1, omega * omega)),
      {});
}

// Free vibration from x = 1, measured as it is.
IdentificationRecord FreeVibration(double step, int samples) {
  IdentificationRecord record;
  record.name = "r";
  record.excitation.emplace(0.0, step, Matrix(0, samples),
                            Interpolation::kLinear);
  record.start = IdentificationRecord::Start::kKnown;
  record.known_start = Vector::Unit(2, 0);
  MeasuredChannel channel;
  channel.observation = {"x", Quantity::kDisplacement, Vector::Ones(1)};
  channel.values.resize(samples);
  for (int i = 0; i < samples; ++i) {
    channel.values[i] = std::cos(kOmega * step * i) * std::exp(-0.1 * step * i);
  }
  record.channels = {channel};
  return record;
}

// RMS difference between m steps and a run that is exact beside it.
double TrueError(const StructuralDynamics& dynamics,
                 const IdentificationRecord& record, int substeps) {
  StructuralDynamics::Prepared prepared;
  std::string error;
  EXPECT_TRUE(dynamics.Prepare(dynamics.Parameters(), &prepared, &error));
  const ObservationMap map(dynamics, {record.channels[0].observation});
  Trajectory coarse;
  Trajectory fine;
  EXPECT_TRUE(FreeRun(
      dynamics, prepared, map, IntegrationGrid(*record.excitation, substeps),
      record.known_start, 0, record.num_samples() - 1, &coarse));
  EXPECT_TRUE(FreeRun(dynamics, prepared, map,
                      IntegrationGrid(*record.excitation, 64 * substeps),
                      record.known_start, 0, record.num_samples() - 1, &fine));
  return std::sqrt((coarse.channels - fine.channels).squaredNorm() /
                   static_cast<double>(record.num_samples()));
}

TEST(SubstepsTest, ErrorIsBelowATenthOfSigmaAndNoFinerThanNeeded) {
  const StructuralDynamics dynamics = Oscillator();
  IdentificationRecord record = FreeVibration(0.05, 400);
  for (const double sigma : {1e-2, 1e-4, 1e-6}) {
    record.channels[0].sigma = sigma;
    SubstepChoice choice;
    std::string error;
    ASSERT_TRUE(ChooseSubsteps(dynamics, record, &choice, &error)) << error;
    EXPECT_LE(TrueError(dynamics, record, choice.substeps), 0.11 * sigma);
    if (choice.substeps > 1) {
      EXPECT_GT(TrueError(dynamics, record, choice.substeps / 2), 0.1 * sigma);
    }
    EXPECT_LE(choice.error, choice.error_limit);
    EXPECT_DOUBLE_EQ(choice.error_limit, 0.1 * sigma);
    EXPECT_EQ(choice.channel, "x");
    EXPECT_TRUE(choice.stability.stable);
  }
}

TEST(SubstepsTest, UnknownSigmaTakesTheRms) {
  const IdentificationRecord record = FreeVibration(0.05, 400);
  SubstepChoice choice;
  std::string error;
  ASSERT_TRUE(ChooseSubsteps(Oscillator(), record, &choice, &error)) << error;
  const double rms = std::sqrt(record.channels[0].values.squaredNorm() / 400);
  EXPECT_DOUBLE_EQ(choice.error_limit, 1e-4 * rms);
  EXPECT_LE(choice.error, choice.error_limit);
}

// With measured displacement and velocity the first sample is a start.
TEST(SubstepsTest, FreeStart) {
  IdentificationRecord record = FreeVibration(0.05, 400);
  record.start = IdentificationRecord::Start::kFree;
  record.known_start.resize(0);
  SubstepChoice choice;
  std::string error;
  ASSERT_TRUE(ChooseSubsteps(Oscillator(), record, &choice, &error)) << error;
  EXPECT_TRUE(std::isnan(choice.error));
  // step * |lambda| = 0.5 / substeps <= 0.35.
  EXPECT_EQ(choice.substeps, 2);

  MeasuredChannel velocity = record.channels[0];
  velocity.observation = {"v", Quantity::kVelocity, Vector::Ones(1)};
  velocity.values.setZero();
  velocity.fit = false;
  record.channels.push_back(velocity);
  SubstepChoice from_state;
  ASSERT_TRUE(ChooseSubsteps(Oscillator(), record, &from_state, &error));
  SubstepChoice known;
  ASSERT_TRUE(
      ChooseSubsteps(Oscillator(), FreeVibration(0.05, 400), &known, &error));
  EXPECT_EQ(from_state.substeps, known.substeps);
  EXPECT_NEAR(from_state.error, known.error, 1e-12);
}

// A free start that nothing determines: at rest, where there is an excitation.
TEST(SubstepsTest, FreeStartUnderAnExcitation) {
  const StructuralModel model =
      MakeStructuralModel(Matrix::Ones(1, 1), Matrix::Constant(1, 1, 0.2),
                          Matrix::Constant(1, 1, kOmega * kOmega));
  const StructuralDynamics dynamics(model,
                                    {{InputSpec::Kind::kForce, 0, "force_u1"}});
  IdentificationRecord record = FreeVibration(0.05, 400);
  Matrix force(1, 400);
  for (int i = 0; i < 400; ++i) force(0, i) = std::sin(0.3 * i);
  record.excitation.emplace(0.0, 0.05, force, Interpolation::kLinear);
  SubstepChoice choices[2];
  std::string error;
  record.start = IdentificationRecord::Start::kFree;
  ASSERT_TRUE(ChooseSubsteps(dynamics, record, &choices[0], &error)) << error;
  record.start = IdentificationRecord::Start::kRest;
  ASSERT_TRUE(ChooseSubsteps(dynamics, record, &choices[1], &error)) << error;
  EXPECT_EQ(choices[0].substeps, choices[1].substeps);
  EXPECT_GT(choices[0].error, 0.0);
  EXPECT_EQ(choices[0].error, choices[1].error);
}

TEST(SubstepsTest, StiffElementCounts) {
  StructuralDynamics dynamics = Oscillator();
  std::string error;
  LawTerm term;
  term.name = "damper";
  term.type = "linear";
  term.law = CreateElement("linear", &error);
  term.features = {Feature::Deformation(Feature::kGround, 0),
                   Feature::DeformationRate(Feature::kGround, 0)};
  term.outputs = Matrix::Ones(1, 1);
  term.parameters.name = "damper";
  Parameter k;
  k.name = "damper.k";
  Parameter c;
  c.name = "damper.c";
  c.value = 1000.0;
  term.parameters.parameters = {k, c};
  ASSERT_TRUE(dynamics.AddLaw(term, &error)) << error;
  const IdentificationRecord record = FreeVibration(0.05, 100);
  EXPECT_NEAR(StateMatrixAtRest(dynamics, record)(1, 1), -1000.2, 1e-9);
  SubstepChoice choice;
  ASSERT_TRUE(ChooseSubsteps(dynamics, record, &choice, &error)) << error;
  EXPECT_GE(choice.substeps, 20);
  EXPECT_TRUE(choice.stability.stable);
}

TEST(SubstepsTest, TooCoarse) {
  const IdentificationRecord record = FreeVibration(0.05, 100);
  SubstepChoice choice;
  std::string error;
  EXPECT_FALSE(ChooseSubsteps(Oscillator(1e6), record, &choice, &error));
  EXPECT_THAT(error, HasSubstr("too coarse"));
  EXPECT_FALSE(CheckSubsteps(Oscillator(100.0), record, 1, &choice, &error));
  EXPECT_THAT(error, HasSubstr("with substeps = 1, expected at least 2"));
  EXPECT_TRUE(CheckSubsteps(Oscillator(100.0), record, 2, &choice, &error));
}

// A model that diverges whatever the step still gets one.
TEST(SubstepsTest, DivergentPrior) {
  StructuralDynamics dynamics(
      MakeStructuralModel(Matrix::Ones(1, 1), Matrix::Zero(1, 1),
                          Matrix::Constant(1, 1, -400.0)),
      {});
  SubstepChoice choice;
  std::string error;
  ASSERT_TRUE(
      ChooseSubsteps(dynamics, FreeVibration(0.05, 1000), &choice, &error))
      << error;
  EXPECT_EQ(choice.substeps, 3);  // 20 * 0.05 / 0.35, rounded up
  EXPECT_TRUE(std::isnan(choice.error));
}

}  // namespace
}  // namespace pinode
