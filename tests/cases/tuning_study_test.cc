// What halving and doubling each constant of the fit does to case 1, scheme 2
// (ctest label `study`), as a table.
//
//   PINODE_TUNING_SEEDS=20         seeds, 5 unless given
//   PINODE_TUNING_CONSTANTS=a,b    names of TuningFields, all unless given

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "pinode/base/parallel_for.h"
#include "pinode/problem/tuning.h"
#include "tests/cases/measure.h"

namespace pinode {
namespace testing {
namespace {

constexpr char kSchemeTwo[] = "data/four_dof_free/scheme2.toml";

// A constant times a factor; an empty name: all as they are.
struct TuningTrial {
  std::string name;
  double factor = 1.0;
  double value = 0.0;
};

struct SeedOutcome {
  bool usable = false;
  double training = 0.0;
  double late = 0.0;
  double unseen = 0.0;
  double iterations = 0.0;
  double seconds = 0.0;
};

int NumTuningSeeds() {
  const char* text = std::getenv("PINODE_TUNING_SEEDS");
  return text == nullptr ? 5 : std::max(1, std::atoi(text));
}

std::vector<std::string> ChosenConstants() {
  Tuning tuning;
  std::vector<std::string> known;
  for (const TuningField& field : TuningFields(&tuning)) {
    known.push_back(field.name);
  }
  const char* text = std::getenv("PINODE_TUNING_CONSTANTS");
  if (text == nullptr) return known;
  std::vector<std::string> chosen;
  std::istringstream names(text);
  for (std::string name; std::getline(names, name, ',');) {
    EXPECT_NE(std::find(known.begin(), known.end(), name), known.end())
        << "no constant '" << name << "'";
    chosen.push_back(name);
  }
  return chosen;
}

// What cannot change, an integer that rounds to itself, is left out.
std::vector<TuningTrial> TuningTrials() {
  std::vector<TuningTrial> trials = {TuningTrial()};
  for (const std::string& name : ChosenConstants()) {
    for (const double factor : {0.5, 2.0}) {
      Tuning tuning;
      for (const TuningField& field : TuningFields(&tuning)) {
        if (field.name != name) continue;
        const double before = field.Get();
        field.Set(factor * before);
        if (field.Get() != before) {
          trials.push_back({name, factor, field.Get()});
        }
      }
    }
  }
  return trials;
}

SeedOutcome RunSeed(const TuningTrial& trial, int seed) {
  Case c = ReadCaseOrFail(kSchemeTwo);
  c.options.num_threads = 1;
  for (const TuningField& field : TuningFields(&c.options.tuning)) {
    if (field.name == trial.name) field.Set(trial.value);
  }
  SeedNetworks(static_cast<uint64_t>(seed), &c);
  const CaseRun run = RunCase(std::move(c));
  SeedOutcome outcome;
  outcome.usable = run.summary.usable();
  if (run.summary.records.empty()) {
    outcome.training = outcome.late = outcome.unseen =
        std::numeric_limits<double>::infinity();
    return outcome;
  }
  outcome.training =
      0.5 * (run.MeanSquaredError("h1") + run.MeanSquaredError("h2"));
  outcome.late =
      0.5 * (run.MeanSquaredError("h1_late") + run.MeanSquaredError("h2_late"));
  outcome.unseen = run.MeanSquaredError("h3");
  outcome.iterations = run.summary.num_iterations;
  outcome.seconds = run.summary.seconds;
  return outcome;
}

// The largest, and the one in the middle.
struct WorstAndMedian {
  double worst = 0.0;
  double median = 0.0;
};

WorstAndMedian Of(const std::vector<SeedOutcome>& outcomes,
                  double SeedOutcome::*error) {
  std::vector<double> values;
  for (const SeedOutcome& outcome : outcomes) {
    const double value = outcome.*error;
    values.push_back(std::isnan(value) ? std::numeric_limits<double>::infinity()
                                       : value);
  }
  std::sort(values.begin(), values.end());
  return {values.back(), values[values.size() / 2]};
}

void PrintRow(const TuningTrial& trial,
              const std::vector<SeedOutcome>& outcomes) {
  int usable = 0;
  double iterations = 0.0, seconds = 0.0;
  for (const SeedOutcome& outcome : outcomes) {
    usable += outcome.usable ? 1 : 0;
    iterations += outcome.iterations / static_cast<double>(outcomes.size());
    seconds += outcome.seconds / static_cast<double>(outcomes.size());
  }
  const WorstAndMedian training = Of(outcomes, &SeedOutcome::training);
  const WorstAndMedian late = Of(outcomes, &SeedOutcome::late);
  const WorstAndMedian unseen = Of(outcomes, &SeedOutcome::unseen);
  std::printf(
      "| %s | %g | %g | %d/%zu | %.1e | %.1e | %.1e | %.1e | %.1e | %.1e | "
      "%.0f | %.1f |\n",
      trial.name.empty() ? "as it is" : trial.name.c_str(), trial.factor,
      trial.value, usable, outcomes.size(), training.worst, training.median,
      late.worst, late.median, unseen.worst, unseen.median, iterations,
      seconds);
  std::fflush(stdout);
}

// One fit a thread; a row is printed as soon as all of its seeds are done.
TEST(TuningStudy, HalvesAndDoublesEachConstant) {
  const int seeds = NumTuningSeeds();
  const std::vector<TuningTrial> trials = TuningTrials();
  std::vector<std::vector<SeedOutcome>> outcomes(
      trials.size(), std::vector<SeedOutcome>(static_cast<size_t>(seeds)));
  std::printf(
      "| constant | factor | value | usable | training, worst | median | late, "
      "worst | median | h3, worst | median | iterations | seconds |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  constexpr int kTrialsAtOnce = 8;
  for (size_t first = 0; first < trials.size(); first += kTrialsAtOnce) {
    const size_t count = std::min<size_t>(kTrialsAtOnce, trials.size() - first);
    ParallelFor(
        static_cast<int>(count) * seeds, DefaultThreads(), [&](int task, int) {
          const size_t t = first + static_cast<size_t>(task / seeds);
          const int seed = task % seeds;
          outcomes[t][static_cast<size_t>(seed)] = RunSeed(trials[t], seed + 1);
        });
    for (size_t t = first; t < first + count; ++t) {
      PrintRow(trials[t], outcomes[t]);
    }
  }
  for (const SeedOutcome& outcome : outcomes[0]) EXPECT_TRUE(outcome.usable);
}

}  // namespace
}  // namespace testing
}  // namespace pinode
