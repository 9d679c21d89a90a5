// What several ranks do together comes to what one process does alone. The
// ranks are threads here; tests/programs/ranks_test.sh has them as processes.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pinode/discover/ensemble.h"
#include "pinode/discover/lasso.h"
#include "pinode/discover/regression_problem.h"
#include "pinode/estimate/certainty/profile.h"
#include "pinode/estimate/shooting/multiple_shooting.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/identify_testing.h"
#include "tests/support/ranks_testing.h"

namespace pinode {
namespace {

// A chain of three whose groups are to be found from ground motions.
IdentificationProblem GroupedChainProblem(int num_records, int samples) {
  constexpr int kDofs = 3;
  auto dynamics = testing::MakeGroupedChain(kDofs, 40.0, 0.5);
  IdentificationProblem problem;
  for (int r = 0; r < num_records; ++r) {
    IdentificationRecord record =
        testing::MakeExcitedRecord(*dynamics, samples, 0.02);
    record.name = "record" + std::to_string(r + 1);
    for (int i = 0; i < kDofs; ++i) {
      record.channels.push_back(
          testing::MakeChannel("a" + std::to_string(i + 1),
                               Quantity::kAbsoluteAcceleration, kDofs, i));
    }
    testing::Simulate(*dynamics, Vector::Constant(kDofs, 0.05),
                      Vector::Zero(2 * kDofs), 0.01,
                      static_cast<uint64_t>(r + 1), &record);
    record.start = IdentificationRecord::Start::kFree;
    problem.records.push_back(record);
  }
  problem.dynamics = dynamics;
  problem.sensors.name = "sensors";
  return problem;
}

CondensedSystem LinearizeOn(const IdentificationProblem& problem, int segment,
                            Communicator* communicator) {
  const ParameterLayout layout(problem);
  MultipleShooting::Options options;
  options.communicator = communicator;
  MultipleShooting shooting(problem, layout, options);
  std::vector<Vector> sigmas, scales;
  std::vector<Matrix> trajectories;
  const int states = problem.dynamics->num_states();
  for (const IdentificationRecord& record : problem.records) {
    sigmas.push_back(Vector::Constant(
        static_cast<Eigen::Index>(record.channels.size()), 0.05));
    scales.push_back(Vector::Constant(states, 0.1));
    trajectories.push_back(
        Matrix::Constant(states, record.num_samples(), 0.01));
  }
  shooting.SetSigmas(sigmas);
  shooting.SetStateScales(scales);
  SetSegments(segment, trajectories, &shooting);
  const Vector free = layout.Free(layout.InitialValues()).array() + 0.02;
  CondensedSystem system;
  EXPECT_TRUE(shooting.Linearize(free, &system));
  EXPECT_TRUE(shooting.Linearize(1.001 * free, &system));
  return system;
}

void ExpectSame(const CondensedSystem& one, const CondensedSystem& other) {
  EXPECT_NEAR(other.cost, one.cost, 1e-10 * one.cost);
  EXPECT_LT((other.gradient - one.gradient).norm(),
            1e-10 * one.gradient.norm());
  EXPECT_LT((other.hessian - one.hessian).norm(), 1e-10 * one.hessian.norm());
}

// Records of a linear model, more and fewer than ranks; one so long that it has
// several pieces; and segments.
TEST(Ranks, LinearizeTogether) {
  const struct {
    int records;
    int samples;
    int segment;
  } cases[] = {{4, 200, 0}, {1, 20000, 0}, {2, 200, 25}};
  for (const auto& c : cases) {
    const IdentificationProblem problem =
        GroupedChainProblem(c.records, c.samples);
    const CondensedSystem alone = LinearizeOn(problem, c.segment, nullptr);
    for (const int size : {2, 3}) {
      std::vector<CondensedSystem> found(static_cast<size_t>(size));
      testing::ThreadRanks(size).Run([&](Communicator* ranks) {
        found[static_cast<size_t>(ranks->rank())] =
            LinearizeOn(problem, c.segment, ranks);
      });
      ExpectSame(alone, found[0]);
      for (const CondensedSystem& other : found) {
        EXPECT_EQ(other.cost, found[0].cost);
        EXPECT_EQ(other.gradient, found[0].gradient);
        EXPECT_EQ(other.hessian, found[0].hessian);
      }
    }
  }
}

struct Outcome {
  IdentificationSummary summary;
  IdentifiedModel model;
  std::vector<ParameterProfile> profiles;
};

Outcome FitOn(const IdentificationProblem& problem, int num_starts,
              Communicator* communicator) {
  IdentificationOptions options;
  options.communicator = communicator;
  options.num_starts = num_starts;
  Outcome outcome;
  testing::FitAndJudge(problem, options, nullptr, &outcome.summary,
                       &outcome.model);
  std::string error;
  EXPECT_TRUE(ProfileParameters(problem, outcome.summary, outcome.model,
                                options, ProfileOptions(), &outcome.profiles,
                                &error))
      << error;
  return outcome;
}

// A fit from several starts, and its profiles.
TEST(Ranks, FitTogether) {
  IdentificationProblem problem = GroupedChainProblem(2, 200);
  const Outcome alone = FitOn(problem, 3, nullptr);
  ASSERT_TRUE(alone.summary.usable()) << alone.summary.message;
  std::vector<Outcome> found(2);
  testing::ThreadRanks(2).Run([&](Communicator* ranks) {
    found[static_cast<size_t>(ranks->rank())] = FitOn(problem, 3, ranks);
  });
  for (const Outcome& one : found) {
    EXPECT_TRUE(one.summary.usable()) << one.summary.message;
    EXPECT_EQ(one.summary.num_starts, 3);
    EXPECT_EQ(one.summary.num_starts_at_best, alone.summary.num_starts_at_best);
    EXPECT_EQ(one.model.parameters, found[0].model.parameters);
    EXPECT_LT((one.model.parameters - alone.model.parameters).norm(), 1e-9);
    const RecordScore& score = one.summary.records[0];
    EXPECT_EQ(score.nrmse, found[0].summary.records[0].nrmse);
    EXPECT_NEAR(score.channels[0].band_coverage,
                alone.summary.records[0].channels[0].band_coverage, 1e-12);
    // Histories are those of the first rank.
    const bool first = &one == &found[0];
    EXPECT_EQ(score.prediction.cols(), first ? 200 : 0);
    EXPECT_EQ(score.deviations.cols(), first ? 200 : 0);
    ASSERT_EQ(one.profiles.size(), alone.profiles.size());
    for (size_t p = 0; p < one.profiles.size(); ++p) {
      EXPECT_EQ(one.profiles[p].name, alone.profiles[p].name);
      EXPECT_EQ(one.profiles[p].points.size(), alone.profiles[p].points.size());
      EXPECT_NEAR(one.profiles[p].upper95, alone.profiles[p].upper95, 1e-8);
    }
  }
}

// Bags of an ensemble, more and fewer than ranks.
TEST(Ranks, DrawBagsTogether) {
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
  for (const int bags : {11, 2}) {
    EnsembleOptions options;
    options.num_bags = bags;
    options.library_fraction = 0.8;
    std::string error;
    Ensemble alone;
    ASSERT_TRUE(
        RunEnsemble(problem, LassoLearner({}, {}), options, &alone, &error))
        << error;
    std::vector<Ensemble> found(3);
    testing::ThreadRanks(3).Run([&](Communicator* ranks) {
      EnsembleOptions own = options;
      own.communicator = ranks;
      std::string unused;
      EXPECT_TRUE(RunEnsemble(problem, LassoLearner({}, {}), own,
                              &found[static_cast<size_t>(ranks->rank())],
                              &unused));
    });
    for (const Ensemble& one : found) {
      EXPECT_EQ(one.num_offered, alone.num_offered);
      EXPECT_EQ(one.inclusion_probability, alone.inclusion_probability);
      EXPECT_EQ(one.median, alone.median);
      EXPECT_EQ(one.coefficients, alone.coefficients);
    }
  }
}

// All end where one was told to.
TEST(Ranks, StopTogether) {
  const IdentificationProblem problem = GroupedChainProblem(2, 200);
  std::vector<IdentificationSummary> summaries(3);
  testing::ThreadRanks(3).Run([&](Communicator* ranks) {
    IdentificationOptions options;
    options.communicator = ranks;
    options.callback = [ranks](const IdentificationProgress&) {
      return ranks->rank() != 1;
    };
    IdentifiedModel model;
    testing::FitAndJudge(problem, options, nullptr,
                         &summaries[static_cast<size_t>(ranks->rank())],
                         &model);
  });
  for (const IdentificationSummary& summary : summaries) {
    EXPECT_EQ(summary.termination, Termination::kInterrupted);
  }
}

}  // namespace
}  // namespace pinode
