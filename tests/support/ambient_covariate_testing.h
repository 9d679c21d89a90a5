// Chains that depend on the temperature, under unmeasured loads.

#ifndef TESTS_SUPPORT_AMBIENT_COVARIATE_TESTING_H_
#define TESTS_SUPPORT_AMBIENT_COVARIATE_TESTING_H_

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gtest/gtest.h"
#include "pinode/dynamics/group_curve.h"
#include "tests/support/ambient_testing.h"

namespace pinode {

inline constexpr double kSlope = -0.004;    // 1 / degree
inline constexpr double kReference = 20.0;  // degrees

// Returns the stiffness of the storeys' springs at a temperature.
inline double SpringAt(double temperature) {
  return kChainSpring * (1.0 + kSlope * (temperature - kReference));
}

inline void SetTemperature(const Vector& temperature, AmbientRecord* record) {
  record->inputs.emplace(0.0, record->sampling_step,
                         Matrix(temperature.transpose()),
                         Interpolation::kLinear);
}

// Returns a record of the chain at a temperature. `loss` is the loss of its
// first spring, relative to its stiffness at the reference.
inline AmbientRecord RecordAt(double temperature, unsigned seed, double seconds,
                              double loss = 0.0) {
  Matrix stiffness = TestChain(2, SpringAt(temperature)).stiffness;
  stiffness(0, 0) -= loss * kChainSpring;
  AmbientRecord record =
      RecordOfChain(TestChain(stiffness, 0.01), seconds, seed, 0.5);
  record.name = "wind " + std::to_string(seed);
  SetTemperature(Vector::Constant(record.samples.cols(), temperature), &record);
  return record;
}

// Returns the chain of ProblemOfChain at the reference, with one slope of its
// total stiffness. With knots, a table replaces the slope.
inline IdentificationProblem ProblemOfRecords(
    double off, std::vector<AmbientRecord> records,
    const std::vector<double>& knots = {}) {
  const TestChain chain(2, kChainSpring);
  AmbientRecord plain = records[0];
  plain.inputs.reset();
  const IdentificationProblem without =
      ProblemOfChain(chain, kChainSpring, off, std::move(plain));
  auto dynamics = std::make_shared<StructuralDynamics>(
      without.dynamics->model(),
      std::vector<InputSpec>{{InputSpec::Kind::kCovariate, 0, "temperature"}});
  std::string error;
  for (const GroupTerm& term : without.dynamics->groups()) {
    EXPECT_TRUE(dynamics->AddGroup(term, &error)) << error;
  }
  GroupTerm all;
  all.group.name = "all";
  all.group.matrix = chain.stiffness;
  if (knots.empty()) {
    all.follows = GroupTerm::Follows::kCovariate;
    all.input = 0;
    all.reference = kReference;
  } else {
    all.alpha.free = false;
  }
  EXPECT_TRUE(dynamics->AddGroup(all, &error)) << error;
  if (!knots.empty()) {
    GroupCurve curve;
    curve.name = "all";
    curve.group = all.group;
    curve.input = 0;
    curve.knots = knots;
    curve.parameters.name = "all.temperature";
    for (size_t k = 0; k < knots.size(); ++k) {
      if (knots[k] == kReference) {
        curve.reference = static_cast<int>(k);
        continue;
      }
      Parameter parameter;
      parameter.name = KnotName("all", "temperature", knots[k]);
      curve.parameters.parameters.push_back(parameter);
    }
    EXPECT_TRUE(dynamics->AddGroupCurve(curve, &error)) << error;
  }
  IdentificationProblem problem;
  problem.dynamics = dynamics;
  problem.ambient = std::move(records);
  return problem;
}

}  // namespace pinode

#endif  // TESTS_SUPPORT_AMBIENT_COVARIATE_TESTING_H_
