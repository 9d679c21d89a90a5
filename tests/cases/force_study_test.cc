// Unknown forces over many draws of the noise (ctest label `study`); the
// figures stand in data/README.md.

#include <algorithm>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "pinode/base/parallel_for.h"
#include "tests/cases/force_measure.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace testing {
namespace {

struct Study {
  const char* name;
  double nrmse;    // at most
  double impulse;  // at most
};

class ForceSeeds : public ::testing::TestWithParam<Study> {};

TEST_P(ForceSeeds, TwentySeeds) {
  const std::string name = GetParam().name;
  constexpr int kSeeds = 20;
  std::vector<ForceScore> scores(kSeeds);
  std::vector<char> usable(kSeeds);
  ParallelFor(kSeeds, DefaultThreads(), [&](int seed, int) {
    Case c = ForceCase(name);
    c.options.num_threads = 1;
    DrawNoiseAnew(static_cast<uint64_t>(500 + seed), &c);
    const CaseRun run = RunCase(std::move(c));
    usable[static_cast<size_t>(seed)] = run.summary.usable();
    scores[static_cast<size_t>(seed)] = ScoreForce(run);
  });
  const std::string what = name + ", 20 seeds: ";
  const int num_usable =
      static_cast<int>(std::count(usable.begin(), usable.end(), 1));
  ReportFigure(what + "usable", AtLeast(kSeeds), num_usable);
  EXPECT_EQ(num_usable, kSeeds);
  const auto expect = [&](const std::string& quantity, double limit,
                          double ForceScore::*member) {
    std::vector<double> values;
    for (const ForceScore& score : scores) values.push_back(score.*member);
    std::sort(values.begin(), values.end());
    ReportFigure(what + quantity + ", median", Nothing(),
                 values[values.size() / 2]);
    ReportFigure(what + quantity + ", largest", AtMost(limit), values.back());
    EXPECT_LE(values.back(), limit) << quantity;
  };
  expect("force, nrmse", GetParam().nrmse, &ForceScore::nrmse);
  if (name.find("impact") == 0) {
    expect("impulse, relative error", GetParam().impulse,
           &ForceScore::impulse_error);
    expect("peak time, s", 0.01, &ForceScore::peak_error);
  }
  if (name == "impact_pulse") {
    expect("start, s", kHeldPulseStart, &ForceScore::start_error);
    expect("duration, relative error", kHeldPulseDuration,
           &ForceScore::duration_error);
    expect("amplitude, relative error", kHeldPulseAmplitude,
           &ForceScore::amplitude_error);
  }
  double coverage = 0.0, acting = 0.0;
  for (const ForceScore& score : scores) {
    coverage += score.coverage / kSeeds;
    acting += score.coverage_acting / kSeeds;
  }
  ReportFigure(what + "share within the 95 % band", AtLeast(0.9), coverage);
  EXPECT_GE(coverage, 0.9);
  ReportFigure(what + "the same, while it acts", Nothing(), acting);
}

INSTANTIATE_TEST_SUITE_P(
    Cases, ForceSeeds,
    ::testing::ValuesIn(std::vector<Study>{
        Study{"impact", 1.0, 0.05}, Study{"impact_pulse", 1.0, 0.005},
        Study{"sweep", 0.06, 0.0}, Study{"sweep_high", 0.06, 0.0},
        Study{"sweep_displacement", 0.05, 0.0}, Study{"gust", 0.05, 0.0}}),
    [](const auto& study) { return std::string(study.param.name); });

}  // namespace
}  // namespace testing
}  // namespace pinode
