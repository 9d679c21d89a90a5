// Intervals by profile likelihood where linear ones fail: a stop that a mass
// hardly reaches, over many draws of the noise (ctest label `study`); the
// figures stand in data/README.md.

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "pinode/base/parallel_for.h"
#include "pinode/estimate/certainty/profile.h"
#include "tests/support/estimate_testing.h"
#include "tests/support/figure_testing.h"
#include "tests/support/identify_testing.h"

namespace pinode {
namespace testing {
namespace {

constexpr int kSeeds = 200;
constexpr double kStopStiffness = 40.0;
constexpr double kGap = 0.2;  // the mass comes to 0.24

// A mass on a spring under ground motion; the spring's stiffness, the stop's
// and its gap are unknown.
IdentificationProblem MakeStop(uint64_t seed) {
  auto dynamics = MakeGroupedChain(1, 30.0, 0.6);
  LawTerm stop = MakeElement("stop", "bilinear", 1, Feature::kGround, 0,
                             {kStopStiffness, kGap});
  stop.parameters.parameters[0].lower = 0.0;
  stop.parameters.parameters[1].lower = 0.0;
  std::string error;
  EXPECT_TRUE(dynamics->AddLaw(std::move(stop), &error)) << error;
  IdentificationRecord record = MakeExcitedRecord(*dynamics, 400, 0.02);
  const Matrix samples = 1.3 * record.excitation->samples();
  record.excitation.emplace(0.0, 0.02, samples, Interpolation::kLinear);
  record.channels = {MakeChannel("x1", Quantity::kDisplacement, 1, 0)};
  Simulate(*dynamics, dynamics->Parameters(), Vector::Zero(2), 0.02, seed,
           &record);
  record.start = IdentificationRecord::Start::kRest;
  IdentificationProblem problem;
  problem.records.push_back(record);
  problem.dynamics = dynamics;
  return problem;
}

struct Counts {
  int profiled = 0;
  int linear = 0;   // whose linear interval holds the truth
  int profile = 0;  // whose profile does
  int one_sided = 0;
};

TEST(ProfileStudy, AStopThatIsHardlyReached) {
  const std::vector<std::string> names = {"k1", "stop.k", "stop.gap"};
  const std::vector<double> truths = {0.0, kStopStiffness, kGap};
  std::vector<std::vector<ParameterProfile>> all(kSeeds);
  ParallelFor(kSeeds, DefaultThreads(), [&](int seed, int) {
    const IdentificationProblem problem =
        MakeStop(static_cast<uint64_t>(1000 + seed));
    IdentificationOptions options;
    IdentificationSummary summary;
    IdentifiedModel model;
    testing::FitAndJudge(problem, options, nullptr, &summary, &model);
    ProfileOptions profile_options;
    profile_options.parameters = names;
    std::string error;
    if (!ProfileParameters(problem, summary, model, options, profile_options,
                           &all[static_cast<size_t>(seed)], &error)) {
      ADD_FAILURE() << seed << ": " << error;
    }
  });
  int held = 0;
  int asked = 0;
  for (size_t p = 0; p < names.size(); ++p) {
    Counts counts;
    for (const std::vector<ParameterProfile>& profiles : all) {
      if (p >= profiles.size()) continue;
      const ParameterProfile& profile = profiles[p];
      const double truth = truths[p];
      ++counts.profiled;
      // Without a linear interval there is none that holds.
      const bool has_linear = std::isfinite(profile.linear_lower95) ||
                              std::isfinite(profile.linear_upper95);
      counts.linear += has_linear && profile.linear_lower95 <= truth &&
                       truth <= profile.linear_upper95;
      counts.profile += profile.lower95 <= truth && truth <= profile.upper95;
      counts.one_sided += profile.determination == Determination::kOneSided;
    }
    const std::string what = "a stop hardly reached, 200 seeds, " + names[p];
    const double share = 100.0 / counts.profiled;
    ReportFigure(what + ": profiled", AtLeast(kSeeds), counts.profiled);
    ReportFigure(what + ": linear intervals that hold the truth, %", Nothing(),
                 share * counts.linear);
    ReportFigure(what + ": profiles that do, %", Between(89.0, 99.0),
                 share * counts.profile);
    ReportFigure(what + ": one-sided ones, %", Nothing(),
                 share * counts.one_sided);
    EXPECT_EQ(counts.profiled, kSeeds);
    EXPECT_GE(share * counts.profile, 89.0) << names[p];
    EXPECT_LE(share * counts.profile, 99.0) << names[p];
    held += counts.profile;
    asked += counts.profiled;
  }
  const double overall = 100.0 * held / asked;
  ReportFigure("a stop hardly reached: profiles that hold the truth, %",
               Between(93.0, 97.0), overall);
  EXPECT_GE(overall, 93.0);
  EXPECT_LE(overall, 97.0);
}

}  // namespace
}  // namespace testing
}  // namespace pinode
