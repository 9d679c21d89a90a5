// Chains under unmeasured loads, for tests.

#ifndef TESTS_SUPPORT_AMBIENT_TESTING_H_
#define TESTS_SUPPORT_AMBIENT_TESTING_H_

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gtest/gtest.h"
#include "pinode/estimate/ambient/ambient_cost.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/record/resample.h"
#include "tests/support/identify_testing.h"
#include "tests/support/modal_testing.h"

namespace pinode {

// Returns the record of a chain under wind, as from a logger with an
// anti-aliasing filter: simulated in steps of a fifth of the sampling step. A
// record with measured forces on the first `measured` masses keeps the steps of
// the simulation.
inline AmbientRecord RecordOfChain(const TestChain& chain, double seconds,
                                   unsigned seed, double memory,
                                   const std::vector<int>& derivatives = {2},
                                   bool base = false, double noise = 0.02,
                                   int measured = 0) {
  TestExcitation excitation;
  excitation.memory = memory;
  excitation.base = base;
  excitation.sensor_noise = noise;
  excitation.measured = measured;
  // Measured forces are independent of the others.
  if (measured > 0) excitation.common = 0.0;
  constexpr double kFineStep = 0.004;
  const ResponseRecord fine =
      SimulateChain(chain, kFineStep, std::lround(seconds / kFineStep), seed,
                    derivatives, excitation);
  AmbientRecord record;
  record.name = "wind";
  // Measured forces are held over a step, so they are known exactly.
  record.sampling_step = measured > 0 ? kFineStep : 5.0 * kFineStep;
  const Eigen::Index n = chain.masses();
  for (Eigen::Index c = 0; c < n; ++c) {
    const Vector values =
        measured > 0
            ? Vector(fine.samples.row(c))
            : Resample(fine.samples.row(c), kFineStep, record.sampling_step);
    if (c == 0) record.samples.resize(n, values.size());
    record.samples.row(c) = values.transpose();
    Observation channel;
    channel.name = fine.channels[static_cast<size_t>(c)].name;
    const int d = fine.channels[static_cast<size_t>(c)].derivative;
    channel.quantity = d == 2   ? Quantity::kAbsoluteAcceleration
                       : d == 1 ? Quantity::kVelocity
                                : Quantity::kDisplacement;
    channel.weights = Vector::Unit(n, c);
    record.channels.push_back(channel);
  }
  if (measured > 0) {
    record.inputs.emplace(0.0, kFineStep, fine.inputs, Interpolation::kHeld);
  }
  return record;
}

// Returns the chain with its storeys as groups that start at `off` from their
// stiffness. Its damping has two parts, each about as large as the true one.
inline IdentificationProblem ProblemOfChain(const TestChain& chain,
                                            double spring, double off,
                                            AmbientRecord record) {
  const Eigen::Index n = chain.masses();
  StructuralModel model = MakeStructuralModel(
      Matrix::Identity(n, n), Matrix::Zero(n, n), chain.stiffness);
  std::vector<InputSpec> inputs;
  if (record.inputs.has_value()) {
    for (int i = 0; i < record.inputs->num_inputs(); ++i) {
      inputs.push_back(
          {InputSpec::Kind::kForce, i, "force_u" + std::to_string(i + 1)});
    }
  }
  auto dynamics =
      std::make_shared<StructuralDynamics>(model, std::move(inputs));
  for (Eigen::Index storey = 0; storey < n; ++storey) {
    GroupTerm term;
    term.group.name = "k" + std::to_string(storey + 1);
    term.group.matrix = Matrix::Zero(n, n);
    term.group.matrix(storey, storey) = spring;
    if (storey > 0) {
      term.group.matrix(storey - 1, storey - 1) = spring;
      term.group.matrix(storey, storey - 1) = -spring;
      term.group.matrix(storey - 1, storey) = -spring;
    }
    term.alpha.name = term.group.name;
    term.alpha.value = off * (storey % 2 == 0 ? 1.0 : -1.0);
    term.alpha.free = true;
    std::string error;
    EXPECT_TRUE(dynamics->AddGroup(term, &error)) << error;
  }
  // 2 zeta w at the ends of the band from both parts.
  const double low = 6.283185307179586 * chain.frequency_hz[0];
  const double high = 6.283185307179586 * chain.frequency_hz[n - 1];
  const double by_mass = 2.0 * 0.01 * low * high / (low + high);
  const double by_stiffness = 2.0 * 0.01 / (low + high);
  for (const bool mass : {true, false}) {
    GroupTerm term;
    term.group.name = mass ? "cm" : "ck";
    term.group.target = MatrixGroup::Target::kDamping;
    term.group.matrix = mass ? Matrix(by_mass * Matrix::Identity(n, n))
                             : Matrix(by_stiffness * chain.stiffness);
    term.alpha.name = term.group.name;
    term.alpha.value = 0.8;
    term.alpha.free = true;
    std::string error;
    EXPECT_TRUE(dynamics->AddGroup(term, &error)) << error;
  }
  IdentificationProblem problem;
  problem.dynamics = dynamics;
  problem.ambient.push_back(std::move(record));
  return problem;
}

inline constexpr double kChainSpring = 900.0;

// Returns the chain whose first and last mode have the damping of those two
// groups at 1. The modes between have a little more.
inline TestChain RayleighChain(int masses) {
  return TestChain(masses, kChainSpring);
}

// Returns the summary of a fit with default options, except for the method of
// the intervals.
inline IdentificationSummary SummaryOfFit(
    const IdentificationProblem& problem,
    IdentificationOptions::Covariance covariance =
        IdentificationOptions::Covariance::kAuto) {
  IdentificationOptions options;
  options.covariance = covariance;
  options.num_threads = 2;
  IdentificationSummary summary;
  IdentifiedModel model;
  testing::FitAndJudge(problem, options, nullptr, &summary, &model);
  return summary;
}

inline void ExpectGradientOfCost(const IdentificationProblem& problem) {
  const ParameterLayout layout(problem);
  AmbientCost cost(problem.ambient[0], *problem.dynamics, layout, 2);
  const Vector free = layout.Free(layout.InitialValues());
  CondensedSystem system;
  // Loads and noise are only found approximately at first.
  double cost_beside = 0.0;
  ASSERT_TRUE(cost.Evaluate(1.001 * free, &cost_beside)) << cost.Failure();
  ASSERT_TRUE(cost.Linearize(free, &system)) << cost.Failure();
  EXPECT_GT(system.cost, 0.0);
  for (Eigen::Index i = 0; i < free.size(); ++i) {
    const double step = 0.05 / std::sqrt(system.hessian(i, i));
    double forth = 0.0;
    double back = 0.0;
    Vector moved = free;
    moved[i] += step;
    ASSERT_TRUE(cost.Evaluate(moved, &forth));
    moved[i] -= 2.0 * step;
    ASSERT_TRUE(cost.Evaluate(moved, &back));
    const double slope = (forth - back) / (2.0 * step);
    // Tolerance in standard deviations of the scores. Loads and noise cause a
    // few hundredths of them.
    EXPECT_NEAR(slope, system.gradient[i],
                0.03 * std::abs(slope) + 0.05 * std::sqrt(system.hessian(i, i)))
        << "parameter " << i;
  }
}

}  // namespace pinode

#endif  // TESTS_SUPPORT_AMBIENT_TESTING_H_
