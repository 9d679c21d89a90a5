// Fits of elements with a memory to simulated records of one storey.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/dynamics/feature.h"
#include "pinode/dynamics/memory_network.h"
#include "pinode/problem/verdict.h"
#include "pinode/study/identify/identify.h"
#include "tests/support/study_testing.h"

namespace pinode {
namespace {

// Returns one storey with an element to the ground.
std::shared_ptr<StructuralDynamics> StoreyWith(
    const std::string& type, const std::vector<double>& values) {
  auto dynamics = testing::MakeGroupedChain(1, 100.0, 0.5);
  std::string error;
  EXPECT_TRUE(dynamics->AddLaw(
      testing::MakeElement("device", type, 1, Feature::kGround, 0, values),
      &error))
      << error;
  return dynamics;
}

// Returns a fit of a storey with one element to the acceleration of a storey
// with another one, with 2 % noise.
TestFit FitOfStorey(const std::shared_ptr<StructuralDynamics>& model,
                    const StructuralDynamics& truth,
                    const IdentificationOptions& options = {}) {
  IdentificationProblem problem;
  problem.dynamics = model;
  IdentificationRecord record = testing::MakeExcitedRecord(*model, 300, 0.02);
  record.start = IdentificationRecord::Start::kRest;
  record.channels = {
      testing::MakeChannel("a", Quantity::kAbsoluteAcceleration, 1, 0)};
  record.substeps = 8;
  testing::Simulate(truth, truth.Parameters(), Vector::Zero(truth.num_states()),
                    0.02, 3, &record);
  record.substeps = 0;
  problem.records = {record};
  ChooseStepsOrFail(&problem);
  TestFit fit;
  fit.problem = problem;
  Identification found = Identify(fit.problem, options, {}, nullptr);
  fit.summary = std::move(found.summary);
  return fit;
}

const ParameterEstimate* DeviceEstimate(const TestFit& fit,
                                        const std::string& name) {
  for (const ParameterEstimate& estimate : fit.summary.parameters) {
    if (estimate.name == name) return &estimate;
  }
  return nullptr;
}

TEST(MemoryFit, IntervalsHoldTheMaxwellElement) {
  const TestFit fit = FitOfStorey(StoreyWith("maxwell", {25.0, 6.0}),
                                  *StoreyWith("maxwell", {40.0, 3.0}));
  EXPECT_TRUE(fit.summary.usable()) << fit.summary.message;
  for (const auto& [name, truth] :
       {std::pair<std::string, double>{"device.k", 40.0}, {"device.c", 3.0}}) {
    const ParameterEstimate* estimate = DeviceEstimate(fit, name);
    ASSERT_NE(estimate, nullptr) << name;
    EXPECT_LE(estimate->lower95, truth) << name;
    EXPECT_GE(estimate->upper95, truth) << name;
    EXPECT_LT(estimate->upper95 - estimate->lower95, 0.2 * truth) << name;
  }
}

// Friction is no viscoelasticity: the fit ends, but must not be called good.
TEST(MemoryFit, WrongLawIsNotGood) {
  const TestFit fit =
      FitOfStorey(StoreyWith("maxwell", {25.0, 6.0}),
                  *StoreyWith("baber_noori", {60.0, 0.15, 0.5, 1.0}));
  EXPECT_TRUE(fit.summary.termination == Termination::kConverged ||
              fit.summary.termination == Termination::kNoConvergence)
      << fit.summary.message;
  EXPECT_NE(fit.summary.verdict.grade(), Grade::kGood) << fit.summary.message;
  std::vector<std::string> checks;
  for (const Finding& finding : fit.summary.verdict.findings()) {
    checks.push_back(finding.check);
  }
  EXPECT_THAT(checks, ::testing::Contains(kUnexplainedMotion));
}

// The limit for unexplained motion is that of other networks.
TEST(MemoryFit, NetworkWithMemoryLearnsAForce) {
  auto model = testing::MakeGroupedChain(1, 100.0, 0.5);
  MemoryNetworkShape shape;
  shape.width = 2;
  shape.deformation = 0.02;
  shape.rate = 0.2;
  shape.force = 1.0;
  std::string error;
  ASSERT_TRUE(model->AddLaw(
      MakeMemoryNetwork("device", shape,
                        {Feature::Displacement(0), Feature::Velocity(0)}, 1,
                        MemoryNetwork(shape).DrawWeights(1), 3.0),
      &error))
      << error;
  // The whole fit would take many seconds.
  IdentificationOptions options;
  options.max_num_iterations = 3;
  options.num_starts = 1;
  const TestFit fit = FitOfStorey(
      model, *StoreyWith("baber_noori", {60.0, 0.15, 0.5, 1.0}), options);
  EXPECT_TRUE(fit.summary.learns_force);
  ASSERT_FALSE(fit.summary.records.empty());
  EXPECT_LT(fit.summary.records[0].nrmse, 0.4) << fit.summary.message;
}

}  // namespace
}  // namespace pinode
