// Ambient records beside others: what all say together.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "pinode/integrate/free_run.h"
#include "tests/support/ambient_testing.h"

namespace pinode {
namespace {

constexpr double kDrivenStep = 0.02;

// A chain of two, of which nobody measured the loads, that can be driven at its
// first mass.
IdentificationProblem ChainThatCanBeDriven() {
  const TestChain chain = RayleighChain(2);
  AmbientRecord record = RecordOfChain(chain, 200.0, 5, 0.5);
  record.inputs.emplace(0.0, record.sampling_step,
                        Matrix::Zero(1, record.samples.cols()),
                        Interpolation::kLinear);
  return ProblemOfChain(chain, kChainSpring, 0.05, std::move(record));
}

// Groups at zero, damping as it is: what the chain is.
Vector TruthOfDriven(const StructuralDynamics& dynamics) {
  Vector truth = Vector::Zero(dynamics.num_parameters());
  truth.tail(2).setOnes();
  return truth;
}

// The second mass under a random force at the first, from rest.
IdentificationRecord DrivenRecord(const StructuralDynamics& dynamics,
                                  double sigma) {
  constexpr int kDrivenSamples = 1500;
  std::mt19937 generator(7);
  std::normal_distribution<double> normal;
  Matrix force(1, kDrivenSamples);
  for (double& value : force.reshaped()) value = 10.0 * normal(generator);
  IdentificationRecord record;
  record.name = "shaker";
  record.excitation.emplace(0.0, kDrivenStep, force, Interpolation::kLinear);
  record.start = IdentificationRecord::Start::kRest;
  record.integrator = Integrator::kExact;
  record.substeps = 1;
  MeasuredChannel channel;
  channel.observation.name = "a2";
  channel.observation.quantity = Quantity::kAbsoluteAcceleration;
  channel.observation.weights = Vector::Unit(2, 1);
  channel.sigma = sigma;
  StructuralDynamics::Prepared prepared;
  std::string error;
  EXPECT_TRUE(dynamics.Prepare(TruthOfDriven(dynamics), &prepared, &error))
      << error;
  const ObservationMap observation(dynamics, {channel.observation});
  Trajectory run;
  EXPECT_TRUE(FreeRun(dynamics, prepared, observation,
                      IntegrationGrid::Exact(*record.excitation),
                      Vector::Zero(4), 0, kDrivenSamples - 1, &run));
  channel.values = run.channels.row(0).transpose();
  for (double& value : channel.values) value += sigma * normal(generator);
  record.channels.push_back(std::move(channel));
  return record;
}

// Variances of independent sources add up by their inverses.
TEST(AmbientMixedTest, BesideAForcedRecordAndModesAllAreWeighed) {
  const IdentificationProblem ambient = ChainThatCanBeDriven();
  IdentificationProblem forced = ambient;
  forced.ambient.clear();
  forced.records.push_back(DrivenRecord(*ambient.dynamics, 30.0));
  IdentificationProblem both = ambient;
  both.records = forced.records;
  IdentificationProblem all = both;
  const double hz = RayleighChain(2).frequency_hz[0];
  MeasuredMode mode;
  mode.name = "1";
  mode.frequency = hz;
  mode.frequency_sigma = 0.001 * hz;
  all.modal.modes.push_back(mode);

  const IdentificationSummary by_wind = SummaryOfFit(ambient);
  const IdentificationSummary by_force = SummaryOfFit(forced);
  const IdentificationSummary by_both = SummaryOfFit(both);
  const IdentificationSummary by_all = SummaryOfFit(all);
  for (const auto* fit : {&by_wind, &by_force, &by_both, &by_all}) {
    ASSERT_EQ(fit->termination, Termination::kConverged) << fit->message;
  }
  for (size_t i = 0; i < 2; ++i) {
    const double wind = by_wind.parameters[i].sigma;
    const double force = by_force.parameters[i].sigma;
    const double together = by_both.parameters[i].sigma;
    EXPECT_NEAR(by_both.parameters[i].value, 0.0, 3.5 * together);
    EXPECT_NEAR(by_all.parameters[i].value, 0.0,
                3.5 * by_all.parameters[i].sigma);
    // Without either of them 1.3 and more of this; less than one because what
    // each leaves open lies along other combinations; were one of them counted
    // twice, below 0.7.
    const double independent = 1.0 / std::hypot(1.0 / wind, 1.0 / force);
    EXPECT_LT(together, independent);
    EXPECT_GT(together, 0.75 * independent);
    EXPECT_LT(by_all.parameters[i].sigma, together);
  }
  // The first mode says most of the first storey.
  EXPECT_LT(by_all.parameters[0].sigma, 0.95 * by_both.parameters[0].sigma);
}

// Beside a forced record that says next to nothing the scores of the ambient
// record's lines make the same intervals as without it.
TEST(AmbientMixedTest, ScoresOfLinesCountBesideAForcedRecord) {
  using Covariance = IdentificationOptions::Covariance;
  const IdentificationProblem ambient = ChainThatCanBeDriven();
  IdentificationProblem both = ambient;
  both.records.push_back(DrivenRecord(*ambient.dynamics, 1e6));
  const Matrix plain = SummaryOfFit(both, Covariance::kPlain).covariance;
  const IdentificationSummary alone =
      SummaryOfFit(ambient, Covariance::kSandwich);
  const IdentificationSummary beside =
      SummaryOfFit(both, Covariance::kSandwich);
  EXPECT_EQ(alone.covariance_method, "sandwich");
  EXPECT_EQ(beside.covariance_method, "sandwich");
  EXPECT_LT((beside.covariance - alone.covariance).norm(),
            0.03 * alone.covariance.norm());
  EXPECT_GT((plain - alone.covariance).norm(), 0.05 * alone.covariance.norm());
  // The spectra are those of the model, so that it is not asked for.
  EXPECT_EQ(SummaryOfFit(both).covariance_method, "plain");
}

}  // namespace
}  // namespace pinode
