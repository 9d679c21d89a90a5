// The ASCE benchmark structure with braces removed.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "pinode/damage/verdict.h"
#include "pinode/estimate/certainty/assessment.h"
#include "tests/cases/measure.h"
#include "tests/support/figure_testing.h"

namespace pinode {
namespace testing {
namespace {

CaseRun RunAsce(const std::string& name) {
  return RunCase(ReadCaseOrFail("data/asce_benchmark/" + name + ".toml"));
}

TEST(AsceBenchmark, FindsTheStoreysAndDirectionsThatLostTheirBraces) {
  const CaseRun healthy = RunAsce("healthy");
  const std::vector<std::pair<std::string, std::vector<std::string>>> patterns =
      {{"pattern1", {"brace_x1", "brace_y1"}},
       {"pattern2", {"brace_x1", "brace_y1", "brace_x3", "brace_y3"}}};
  for (const auto& [pattern, removed] : patterns) {
    const ChangeRun verdict = CompareRuns(healthy, RunAsce(pattern));
    const bool damage = verdict.judgement.verdict == DamageVerdict::kDamage;
    ReportFigure("ASCE " + pattern + ": verdict of damage", AtLeast(1), damage);
    EXPECT_TRUE(damage) << pattern;
    int num_wrong = 0;
    double largest_error = 0.0;
    for (size_t j = 0; j < verdict.subjects.size(); ++j) {
      const std::string& name = verdict.subjects[j].name;
      const bool gone =
          std::find(removed.begin(), removed.end(), name) != removed.end();
      const bool called =
          verdict.judgement.reasons[j] == Reason::kBeyondThreshold;
      num_wrong += called != gone;
      EXPECT_EQ(called, gone) << pattern << " " << name;
      if (gone) {
        largest_error =
            std::max(largest_error,
                     100.0 * std::abs(1.0 + verdict.estimate.groups[j].change));
      }
    }
    ReportFigure("ASCE " + pattern + ": groups missed or called wrongly",
                 AtMost(0), num_wrong);
    ExpectFigure("ASCE " + pattern + ": worst error of a loss, points", 0.3,
                 largest_error);
  }
}

// With loads in y alone nothing moves in x, and nothing turns.
TEST(AsceBenchmark, SaysWhatTheLoadsDoNotShow) {
  const Case c = ReadCaseOrFail("data/asce_benchmark/y_only.toml");
  ProblemAssessment assessment;
  std::string error;
  ASSERT_TRUE(AssessProblem(c.problem, c.options, &assessment, &error))
      << error;
  ASSERT_EQ(assessment.expected.size(), 8u);
  for (const auto& expected : assessment.expected) {
    EXPECT_EQ(std::isfinite(expected.sigma), expected.name[6] == 'y')
        << expected.name << " " << expected.sigma;
  }
  EXPECT_EQ(assessment.undetermined.size(), 4u);
}

}  // namespace
}  // namespace testing
}  // namespace pinode
