// Everything that runs on several threads, or that several threads may call at
// once, in one small program: the preset `tsan` runs it under the thread
// sanitizer. Every preset runs it for its results, which threads must not
// change.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "pinode/base/parallel_for.h"
#include "pinode/discover/ensemble.h"
#include "pinode/discover/lasso.h"
#include "pinode/discover/regression_problem.h"
#include "pinode/dynamics/library_function.h"
#include "pinode/estimate/certainty/assessment.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace {

// Oscillators under ground motion with a group each, whose records are those of
// a structure 5 % stiffer.
IdentificationProblem ChainProblem() {
  constexpr int kDofs = 3;
  auto dynamics = testing::MakeGroupedChain(kDofs, 40.0, 0.5);
  IdentificationProblem problem;
  for (uint64_t seed : {1, 2}) {
    IdentificationRecord record =
        testing::MakeExcitedRecord(*dynamics, 200, 0.02);
    record.name = "record" + std::to_string(seed);
    for (int i = 0; i < kDofs; ++i) {
      record.channels.push_back(
          testing::MakeChannel("a" + std::to_string(i + 1),
                               Quantity::kAbsoluteAcceleration, kDofs, i));
    }
    testing::Simulate(*dynamics, Vector::Constant(kDofs, 0.05),
                      Vector::Zero(2 * kDofs), 0.01, seed, &record);
    problem.records.push_back(record);
  }
  problem.dynamics = dynamics;
  problem.sensors.name = "sensors";
  return problem;
}

TEST(Threads, EveryTaskOnceAndByTheSameThread) {
  constexpr int kTasks = 101;
  for (int threads : {1, 2, 3, 7}) {
    std::vector<int> thread_of(kTasks, -1);
    std::vector<int> count(kTasks, 0);
    ParallelFor(kTasks, threads, [&](int task, int thread) {
      thread_of[static_cast<size_t>(task)] = thread;
      ++count[static_cast<size_t>(task)];
    });
    for (int task = 0; task < kTasks; ++task) {
      EXPECT_EQ(count[static_cast<size_t>(task)], 1);
      EXPECT_EQ(thread_of[static_cast<size_t>(task)], task % threads);
    }
  }
}

TEST(Threads, SegmentsOfOneProblem) {
  const testing::SmallFit fit(IdentificationRecord::Start::kFree);
  const auto solve = [&fit](int threads) {
    MultipleShooting::Options options;
    options.num_threads = threads;
    auto shooting = fit.Shoot(4, options);
    CondensedSystem system;
    EXPECT_TRUE(shooting->Linearize(fit.free, &system));
    return system;
  };
  const CondensedSystem one = solve(1);
  const CondensedSystem three = solve(3);
  EXPECT_NEAR(three.cost, one.cost, 1e-12 * one.cost);
  EXPECT_LT((three.gradient - one.gradient).norm(),
            1e-12 * one.gradient.norm());
}

// A record that nothing but all threads together make quicker, with a law, and
// derivatives that come along with the first trial of its start or do not.
TEST(Threads, PiecesOfOneLongRecord) {
  constexpr int kSamples = 1600;
  auto dynamics = testing::MakeGroupedChain(3, 40.0, 0.5);
  std::string error;
  ASSERT_TRUE(dynamics->AddElement("hard", "cubic", 0, 1, {300.0}, &error))
      << error;
  IdentificationProblem problem;
  IdentificationRecord record =
      testing::MakeExcitedRecord(*dynamics, kSamples, 0.02);
  record.channels.push_back(
      testing::MakeChannel("a2", Quantity::kAbsoluteAcceleration, 3, 1));
  const Vector truth = dynamics->Parameters();
  testing::Simulate(*dynamics, truth, Vector::Zero(6), 0.01, 1, &record);
  record.start = IdentificationRecord::Start::kFree;
  problem.records.push_back(record);
  problem.dynamics = dynamics;
  const ParameterLayout layout(problem);
  const Vector free = layout.Free(layout.InitialValues()).array() + 0.02;
  const auto solve = [&](int threads, bool looks_ahead) {
    MultipleShooting::Options options;
    options.num_threads = threads;
    options.looks_ahead = looks_ahead;
    MultipleShooting shooting(problem, layout, options);
    shooting.SetSigmas({Vector::Constant(1, 0.05)});
    SetSegments(0, {Matrix::Constant(6, kSamples, 0.01)}, &shooting);
    CondensedSystem system;
    double cost = 0.0;
    EXPECT_TRUE(shooting.Evaluate(free, &cost));
    EXPECT_TRUE(shooting.Linearize(free, &system));
    EXPECT_EQ(cost, system.cost);
    // Near it one trial is enough.
    EXPECT_TRUE(shooting.Linearize(1.0001 * free, &system));
    return system;
  };
  const CondensedSystem one = solve(1, false);
  for (const int threads : {1, 3}) {
    const CondensedSystem other = solve(threads, true);
    EXPECT_NEAR(other.cost, one.cost, 1e-9 * one.cost);
    EXPECT_LT((other.gradient - one.gradient).norm(),
              1e-9 * one.gradient.norm());
    EXPECT_LT((other.hessian - one.hessian).norm(), 1e-9 * one.hessian.norm());
  }
}

// The dynamics, its laws, networks and expressions are shared by all.
TEST(Threads, FitsOfOneProblemSideBySide) {
  const IdentificationProblem problem = ChainProblem();
  IdentificationOptions options;
  options.num_threads = 2;
  constexpr int kFits = 3;
  std::vector<IdentificationSummary> summaries(kFits);
  std::vector<IdentifiedModel> models(kFits);
  std::vector<std::thread> threads;
  for (size_t i = 0; i < kFits; ++i) {
    threads.emplace_back([&, i]() {
      testing::FitAndJudge(problem, options, nullptr, &summaries[i],
                           &models[i]);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (size_t i = 0; i < kFits; ++i) {
    EXPECT_TRUE(summaries[i].usable()) << summaries[i].message;
    EXPECT_EQ(models[i].parameters, models[0].parameters);
    for (double value : models[i].parameters) EXPECT_NEAR(value, 0.05, 0.01);
  }
}

TEST(Threads, EveryKindOfTermSideBySide) {
  const testing::SmallFit fit(IdentificationRecord::Start::kFree);
  IdentificationOptions options;
  options.num_threads = 2;
  std::vector<ProblemAssessment> found(2);
  std::vector<char> ok(2, 0);
  ParallelFor(2, 2, [&](int i, int) {
    const size_t index = static_cast<size_t>(i);
    std::string error;
    ok[index] = AssessProblem(fit.problem, options, &found[index], &error);
  });
  ASSERT_TRUE(ok[0] && ok[1]);
  ASSERT_EQ(found[0].expected.size(), found[1].expected.size());
  ASSERT_FALSE(found[0].expected.empty());
  for (size_t j = 0; j < found[0].expected.size(); ++j) {
    EXPECT_EQ(found[0].expected[j].sigma, found[1].expected[j].sigma);
  }
}

TEST(Threads, OneExpression) {
  LibraryFunction function;
  std::string error;
  ASSERT_TRUE(LibraryFunction::Parse("sin(x[u1])*x[u1]^3 + exp(v[u1])",
                                     {"x[u1]", "v[u1]"}, &function, &error))
      << error;
  std::vector<int> wrong(3, 0);
  ParallelFor(3, 3, [&](int i, int) {
    for (int k = 0; k < 2000; ++k) {
      const double x = (i - 1) * 1e-3 * k;
      const double q[] = {x, -x};
      const double expected = std::sin(x) * x * x * x + std::exp(-x);
      if (std::abs(function.Evaluate(q) - expected) > 1e-13) {
        ++wrong[static_cast<size_t>(i)];
      }
    }
  });
  EXPECT_EQ(wrong, std::vector<int>(3, 0));
}

TEST(Threads, BagsOfAnEnsemble) {
  testing::Gaussian random(4);
  RegressionOutput output;
  output.name = "y";
  output.theta.resize(300, 8);
  for (int j = 0; j < 8; ++j) {
    output.candidates.push_back("c" + std::to_string(j));
    output.theta.col(j) = random.Draw(300);
  }
  output.y =
      2.0 * output.theta.col(1) - output.theta.col(6) + 0.1 * random.Draw(300);
  RegressionProblem problem;
  problem.outputs = {output};
  EnsembleOptions options;
  options.num_bags = 20;
  const auto run = [&](int threads) {
    options.num_threads = threads;
    Ensemble ensemble;
    std::string error;
    EXPECT_TRUE(
        RunEnsemble(problem, LassoLearner({}, {}), options, &ensemble, &error))
        << error;
    return ensemble;
  };
  const Ensemble one = run(1);
  const Ensemble three = run(3);
  EXPECT_EQ(one.inclusion_probability, three.inclusion_probability);
  EXPECT_EQ(one.median, three.median);
}

}  // namespace
}  // namespace pinode
