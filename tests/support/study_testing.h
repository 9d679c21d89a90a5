// Problems in memory for the tests of this layer.

#ifndef TESTS_SUPPORT_STUDY_TESTING_H_
#define TESTS_SUPPORT_STUDY_TESTING_H_

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gtest/gtest.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/study/problem/substeps.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {

struct TestFit {
  IdentificationProblem problem;
  IdentificationSummary summary;
  IdentifiedModel model;
};

// Chooses the steps. The test fails if they cannot be chosen.
inline void ChooseStepsOrFail(IdentificationProblem* problem) {
  std::vector<SubstepChoice> choices;
  int failed = 0;
  std::string error;
  EXPECT_TRUE(SetSubsteps(problem, &choices, &failed, &error)) << error;
}

// Returns a chain of `n` floors under ground motion, with one stiffness group
// per storey and accelerometers on all floors. The records come from `truth`,
// which may have the terms of another structure, with 0.1 % noise.
inline IdentificationProblem MeasuredChain(int n,
                                           const StructuralDynamics& truth,
                                           uint64_t seed) {
  IdentificationProblem problem;
  problem.dynamics = testing::MakeGroupedChain(n, 100.0, 0.5);
  IdentificationRecord record =
      testing::MakeExcitedRecord(*problem.dynamics, 400, 0.05);
  record.start = IdentificationRecord::Start::kRest;
  for (int i = 0; i < n; ++i) {
    record.channels.push_back(testing::MakeChannel(
        "a" + std::to_string(i + 1), Quantity::kAbsoluteAcceleration, n, i));
  }
  record.substeps = 8;
  testing::Simulate(truth, truth.Parameters(), Vector::Zero(truth.num_states()),
                    0.001, seed, &record);
  record.substeps = 0;
  problem.records.push_back(std::move(record));
  ChooseStepsOrFail(&problem);
  return problem;
}

// Returns the chain with other values of its groups.
inline std::shared_ptr<StructuralDynamics> ChainAt(const Vector& alpha) {
  auto dynamics =
      testing::MakeGroupedChain(static_cast<int>(alpha.size()), 100.0, 0.5);
  dynamics->SetParameters(alpha);
  return dynamics;
}

inline TestFit FitOf(IdentificationProblem problem) {
  TestFit fit;
  fit.problem = std::move(problem);
  testing::FitAndJudge(fit.problem, IdentificationOptions(), nullptr,
                       &fit.summary, &fit.model);
  EXPECT_TRUE(fit.summary.usable()) << fit.summary.message;
  return fit;
}

}  // namespace pinode

#endif  // TESTS_SUPPORT_STUDY_TESTING_H_
