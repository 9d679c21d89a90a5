// Networks: fitted, annealed, and gone on with.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "pinode/base/statistics.h"
#include "pinode/estimate/shooting/score.h"
#include "pinode/network/initialize_weights.h"
#include "tests/support/dynamics_testing.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

constexpr int kSamples = 160;
constexpr double kStep = 0.05;

std::shared_ptr<StructuralDynamics> MakeOscillator() {
  return std::make_shared<StructuralDynamics>(
      testing::MakeChain(1, 10.0, 0.3),
      std::vector<InputSpec>{{InputSpec::Kind::kGroundAcceleration, 0, "ag"}});
}

// One mass on a hardening spring; the model has the linear part and a network
// of displacement and velocity for the rest.
struct HardeningOscillator {
  HardeningOscillator() {
    std::string error;
    const auto truth = MakeOscillator();
    EXPECT_TRUE(truth->AddLaw(
        testing::MakeElement("spring", "cubic", 1, Feature::kGround, 0, {6.0}),
        &error))
        << error;
    const auto dynamics = MakeOscillator();
    NetworkArchitecture architecture;
    architecture.num_inputs = 2;
    architecture.num_outputs = 1;
    architecture.hidden_widths = {6};
    NetworkTerm term;
    term.name = "net";
    term.network = std::make_shared<Network>(architecture);
    term.features = {Feature::Displacement(0), Feature::Velocity(0)};
    term.outputs = Matrix::Identity(1, 1);
    term.weights.name = "net";
    term.weights.named = false;
    term.weights.decays = architecture.NonlinearWeights();
    const Vector weights = InitializeWeights(architecture, 3, true);
    for (int i = 0; i < weights.size(); ++i) {
      Parameter weight;
      weight.name = "net[" + std::to_string(i) + "]";
      weight.value = weights[i];
      term.weights.parameters.push_back(weight);
    }
    EXPECT_TRUE(dynamics->AddNetwork(std::move(term), &error)) << error;

    IdentificationRecord record =
        testing::MakeExcitedRecord(*truth, kSamples, kStep);
    record.channels = {testing::MakeChannel("x", Quantity::kDisplacement, 1, 0),
                       testing::MakeChannel("v", Quantity::kVelocity, 1, 0)};
    testing::Simulate(*truth, truth->Parameters(), Vector::Zero(2), 0.0, 1,
                      &record);
    problem.dynamics = dynamics;
    problem.records.push_back(record);
    problem.sensors.name = "sensors";
  }

  // Record of one iteration by the callback.
  struct Step {
    int stage = 0;
    int num_stages = 0;
    double free_run_error = 0.0;
    IdentifiedModel model;
  };

  // Runs a fit that stops after `limit` iterations of the last stage.
  void Run(const IdentifiedModel* initial, int limit = 1000000) {
    steps.clear();
    IdentificationOptions options;
    int last = 0;
    options.callback = [&](const IdentificationProgress& progress) {
      steps.push_back({progress.stage, progress.num_stages,
                       progress.free_run_error, *progress.model});
      if (progress.stage == progress.num_stages) ++last;
      return last <= limit;
    };
    testing::FitAndJudge(problem, options, initial, &summary, &model);
  }

  // The nrmse of a free run from rest.
  double FreeRunError(const Vector& parameters) const {
    RecordScore score;
    ScoreRecord(problem, 0, parameters, Vector::Zero(2), 0, &score);
    return score.nrmse;
  }

  IdentificationProblem problem;
  IdentificationSummary summary;
  IdentifiedModel model;
  std::vector<Step> steps;
};

// Weights of the first hidden layer come first in the block.
Vector FirstLayer(const IdentifiedModel& model) {
  return model.parameters.head(12);
}

TEST(NetworkTraining, LeavesOutTheInputThatIsNotNeeded) {
  HardeningOscillator fit;
  fit.Run(nullptr);
  EXPECT_TRUE(fit.summary.usable()) << fit.summary.message;
  EXPECT_LT(fit.summary.records[0].nrmse, 0.003);
  // Decay groups: inputs x and v, the output, the biases.
  ASSERT_EQ(fit.model.decays.size(), 4);
  EXPECT_GT(fit.model.decays[1], 100.0 * fit.model.decays[0]);
  EXPECT_EQ(fit.model.resume_stage, 0)
      << "a result is not a fit that was cut off";
}

TEST(NetworkTraining, TheLastStageBeginsNearlyLinear) {
  HardeningOscillator fit;
  fit.Run(nullptr, 0);
  ASSERT_GE(fit.steps.size(), 2u);
  const auto& annealed = fit.steps.back();
  ASSERT_EQ(annealed.stage, annealed.num_stages);
  // Hidden weights a tenth of what was drawn; the skip path is what it was.
  const StructuralDynamics& dynamics = *fit.problem.dynamics;
  const ParameterBlock& drawn = dynamics.networks()[0].weights;
  Vector expected = fit.steps[fit.steps.size() - 2].model.parameters;
  const int offset = dynamics.block_offset(0);
  for (int i = 0; i < drawn.size(); ++i) {
    if (!drawn.decays[static_cast<size_t>(i)]) continue;
    expected[offset + i] = 0.1 * drawn.parameters[static_cast<size_t>(i)].value;
  }
  EXPECT_NEAR(annealed.free_run_error, fit.FreeRunError(expected), 1e-9);
  EXPECT_GT(annealed.free_run_error, 0.01);
}

// Annealing comes down to the noise and no further.
TEST(NetworkTraining, NoiseIsLeftToTheRecords) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    HardeningOscillator fit;
    std::vector<Vector> truth;
    std::vector<double> noise;
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    for (MeasuredChannel& channel : fit.problem.records[0].channels) {
      truth.push_back(channel.values);
      noise.push_back(0.05 *
                      std::sqrt((channel.values.array() - channel.values.mean())
                                    .square()
                                    .mean()));
      for (double& value : channel.values)
        value += noise.back() * normal(random);
    }
    fit.Run(nullptr);
    EXPECT_TRUE(fit.summary.usable()) << fit.summary.message;
    for (int c = 0; c < 2; ++c) {
      const size_t k = static_cast<size_t>(c);
      // From 160 samples the estimate has a relative standard deviation of 6 %.
      EXPECT_NEAR(fit.model.sigmas[0][c], noise[k], 0.25 * noise[k]) << seed;
      const Vector error =
          fit.summary.records[0].prediction.row(c).transpose() - truth[k];
      // 320 values for the few parameters that there are: a spring and a
      // damper, and what there is of the network.
      EXPECT_LT(error.norm() / std::sqrt(kSamples), 0.35 * noise[k]) << seed;
    }
    EXPECT_LT(fit.summary.effective_parameters, 12.0) << seed;
  }
}

TEST(NetworkTraining, WhatIsSavedIsNeverWorseThanTheFirstFit) {
  HardeningOscillator fit;
  fit.Run(nullptr);
  double first = 0.0;
  int annealed = 0;
  int caught_up = 0;
  for (const auto& step : fit.steps) {
    const double error = fit.FreeRunError(step.model.parameters);
    if (step.stage < step.num_stages) {
      first = error;
      continue;
    }
    // 0.002: the misfit that networks are allowed.
    EXPECT_LE(error, std::max(1.03 * first, 0.0021)) << annealed;
    ++annealed;
    caught_up += std::abs(error - step.free_run_error) < 1e-6 ? 1 : 0;
  }
  // Both kinds have been seen: kept from before, and the annealed network's.
  EXPECT_GT(caught_up, 0);
  EXPECT_LT(caught_up, annealed);
}

TEST(NetworkTraining, WhatWasLearnedBeforeIsNotDrawnAnew) {
  HardeningOscillator first;
  first.Run(nullptr);
  HardeningOscillator second;
  second.Run(&first.model, 0);
  const auto& begin = second.steps.front();
  EXPECT_EQ(begin.stage, 1);
  const auto& end = second.steps.back();
  ASSERT_EQ(end.stage, end.num_stages);
  const Vector drawn = second.problem.dynamics->Parameters().head(12);
  EXPECT_FALSE(FirstLayer(end.model).isApprox(0.1 * drawn, 0.5));
  const double spread =
      StandardDeviationOfPresent(second.problem.records[0].channels[0].values);
  EXPECT_LT(end.model.sigmas[0][0], 0.05 * spread);
}

TEST(NetworkTraining, AFitThatWasCutOffGoesOnFromWhatItLearned) {
  HardeningOscillator whole;
  whole.Run(nullptr);
  HardeningOscillator cut;
  cut.Run(nullptr, 25);
  EXPECT_EQ(cut.summary.termination, Termination::kInterrupted);
  const auto& at = cut.steps.back();
  EXPECT_EQ(cut.model.resume_stage, at.num_stages);
  // As a checkpoint of the running fit has it, without starts.
  HardeningOscillator resumed;
  resumed.Run(&at.model);
  EXPECT_EQ(resumed.steps.front().stage, 1);
  EXPECT_EQ(FirstLayer(resumed.steps.front().model), FirstLayer(at.model));
  EXPECT_TRUE(resumed.summary.usable()) << resumed.summary.message;
  // As good as the misfit that a network is allowed.
  EXPECT_LT(whole.summary.records[0].nrmse, 0.002);
  EXPECT_LT(resumed.summary.records[0].nrmse, 0.002);
}

}  // namespace
}  // namespace pinode
