// The cases of data/ against the figures that data/README.md promises. Each
// test prints what it measured: run it with --gtest_filter to see one line of
// the table again.

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "gtest/gtest.h"
#include "pinode/estimate/identify.h"
#include "tests/cases/measure.h"

namespace pinode {
namespace testing {
namespace {

class FourDofFree : public ::testing::TestWithParam<const char*> {};

TEST_P(FourDofFree, PredictsLateTimesAndAnUnseenStart) {
  const CaseRun run = RunCase(ReadCaseOrFail(
      std::string("data/four_dof_free/") + GetParam() + ".toml"));
  const double train =
      0.5 * (run.MeanSquaredError("h1") + run.MeanSquaredError("h2"));
  const double late =
      0.5 * (run.MeanSquaredError("h1_late") + run.MeanSquaredError("h2_late"));
  const double unseen = run.MeanSquaredError("h3");
  std::printf("%s: training %.1e, late %.1e, h3 %.1e, %d iterations\n",
              GetParam(), train, late, unseen, run.summary.num_iterations);
  EXPECT_TRUE(run.summary.usable) << run.summary.message;
  EXPECT_LT(train, 1e-6);
  EXPECT_LT(late, 1e-3);
  EXPECT_LT(unseen, 1e-2);
}

INSTANTIATE_TEST_SUITE_P(Schemes, FourDofFree,
                         ::testing::Values("scheme1", "scheme2", "scheme3"));

TEST(FourDofFreeGroups, FindsStiffnessAndDampingBesideTheNetwork) {
  const CaseRun run =
      RunCase(ReadCaseOrFail("data/four_dof_free/scheme2_groups.toml"));
  EXPECT_TRUE(run.summary.usable) << run.summary.message;
  for (const char* name : {"k1", "k2", "k3", "k4", "c1", "c2", "c3", "c4"}) {
    const double truth = Truth("data/four_dof_free/truth.json",
                               std::string("/groups/scheme2_groups/") + name);
    // 0.7 of the truth is in the matrices.
    const double error =
        std::abs((0.7 + run.Parameter(name).value) / (0.7 + truth) - 1.0);
    const bool beside_network = name[1] == '1';
    std::printf("%s: %.4f %% off\n", name, 100.0 * error);
    EXPECT_LT(error, beside_network ? 1e-2 : 1e-3) << name;
  }
  std::printf("h3 %.1e\n", run.MeanSquaredError("h3"));
  EXPECT_LT(run.MeanSquaredError("h3"), 1e-5);
}

void ExpectForcedPrediction(const CaseRun& run, const std::string& record,
                            double limit) {
  for (const char* channel : {"x1", "v1", "a1"}) {
    const double nrmse = run.Nrmse(record, channel);
    std::printf("%s %s: nrmse %.2f %%\n", record.c_str(), channel,
                100.0 * nrmse);
    EXPECT_LT(nrmse, limit) << record << " " << channel;
  }
}

TEST(FourDofForced, PredictsOtherForces) {
  const CaseRun run =
      RunCase(ReadCaseOrFail("data/four_dof_forced/four_dof_forced.toml"));
  EXPECT_TRUE(run.summary.usable) << run.summary.message;
  ExpectForcedPrediction(run, "wn_holdout", 0.005);
  ExpectForcedPrediction(run, "quake_holdout", 0.007);
}

class Duffing : public ::testing::TestWithParam<const char*> {};

TEST_P(Duffing, IsRecoveredExactly) {
  const CaseRun run = RunCase(
      ReadCaseOrFail(std::string("data/duffing/") + GetParam() + ".toml"));
  EXPECT_TRUE(run.summary.usable) << run.summary.message;
  const std::string truth = "data/duffing/truth.json";
  double worst = std::abs(run.Parameter("spring.k3").value /
                              Truth(truth, "/elements/spring/k3") -
                          1.0);
  for (const char* name : {"M", "c", "k"}) {
    worst = std::max(
        worst,
        std::abs((1.0 + run.Parameter(name).value) /
                     (1.0 + Truth(truth, std::string("/groups/") + name)) -
                 1.0));
  }
  std::printf("duffing %s: worst relative error %.1e\n", GetParam(), worst);
  EXPECT_LT(worst, 1e-8);
}

INSTANTIATE_TEST_SUITE_P(Shooting, Duffing,
                         ::testing::Values("single", "multiple"));

class ThreeStorey : public ::testing::TestWithParam<const char*> {};

TEST_P(ThreeStorey, FindsStoreysAndSpring) {
  const bool noisy = std::string(GetParam()) == "noisy_ground";
  const CaseRun run = RunCase(
      ReadCaseOrFail(std::string("data/three_storey/") + GetParam() + ".toml"));
  EXPECT_TRUE(run.summary.usable) << run.summary.message;
  EXPECT_EQ(run.summary.covariance_method, noisy ? "input noise" : "plain");
  const std::string truth = "data/three_storey/truth.json";
  for (const char* name : {"k1", "k2", "k3"}) {
    const double error =
        std::abs((1.0 + run.Parameter(name).value) /
                     (1.0 + Truth(truth, std::string("/groups/") + name)) -
                 1.0);
    std::printf("%s %s: %.3f %% off\n", GetParam(), name, 100.0 * error);
    EXPECT_LT(error, noisy ? 0.003 : 0.0015) << name;
  }
  const double cubic = std::abs(run.Parameter("spring1.k3").value /
                                    Truth(truth, "/elements/spring1/k3") -
                                1.0);
  std::printf("%s cubic: %.3f %% off\n", GetParam(), 100.0 * cubic);
  EXPECT_LT(cubic, noisy ? 0.02 : 0.006);
  const std::string floor =
      noisy ? "/noise_floor_nrmse_noisy_ground/" : "/noise_floor_nrmse/";
  for (int c = 0; c < 3; ++c) {
    const double limit =
        Truth(truth, "/records/holdout" + floor + std::to_string(c));
    const ChannelScore& channel =
        run.Record("holdout").channels[static_cast<size_t>(c)];
    std::printf("%s holdout %s: nrmse %.3f of the noise floor\n", GetParam(),
                channel.name.c_str(), channel.nrmse / limit);
    EXPECT_LT(channel.nrmse, 1.2 * limit) << channel.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Grounds, ThreeStorey,
                         ::testing::Values("three_storey", "noisy_ground"));

TEST(ThreeStoreyJets, SameResultFromJetsAndTangents) {
  Case c = ReadCaseOrFail("data/three_storey/three_storey.toml");
  Case jets = ReadCaseOrFail("data/three_storey/three_storey.toml");
  jets.options.derivatives = DerivativeMethod::kJets;
  c.options.max_num_iterations = jets.options.max_num_iterations = 5;
  const CaseRun a = RunCase(std::move(c));
  const CaseRun b = RunCase(std::move(jets));
  EXPECT_LT((a.model.parameters - b.model.parameters).norm(),
            1e-9 * a.model.parameters.norm());
}

}  // namespace
}  // namespace testing
}  // namespace pinode
